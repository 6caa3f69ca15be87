#ifndef DEPTHFARM_WORKER_ARTIFACTS_STORE_H_
#define DEPTHFARM_WORKER_ARTIFACTS_STORE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "worker/artifacts/chunk_source.h"
#include "worker/artifacts/key_locks.h"

namespace depthfarm {

class ArtifactStore;

// Keeps artifacts from being evicted while it lives (those of a running task). Pins of one key add up; a key may be
// pinned before it is stored. Must not outlive its store.
class ArtifactPins {
 public:
  ArtifactPins() = default;
  ArtifactPins(ArtifactPins&& other) noexcept;
  ArtifactPins& operator=(ArtifactPins&& other) noexcept;
  ~ArtifactPins();

 private:
  friend class ArtifactStore;
  ArtifactPins(ArtifactStore* store, std::vector<ArtifactKey> keys) : store_(store), keys_(std::move(keys)) {}
  void Unpin();

  ArtifactStore* store_ = nullptr;
  std::vector<ArtifactKey> keys_;
};

// The artifacts of one worker: immutable byte strings in a folder, found by key, bounded in bytes. Survives restarts.
//
// Layout   FOLDER/ab/cd/<key in hex>, ab and cd its first bytes. A file is a header (store_file.h) and the artifact.
//          It is written under another name and renamed, so a file of a killed worker is whole or absent; nothing is
//          synced to disk, since what a power cut leaves fails its digest and is made again.
// Trust    The content digest is checked when a file is first used after a restart and at every Get; what fails it is
//          dropped.
// Bound    Sum of the files. The least recently used goes first, released ones before all others, kept ones after all
//          others, pinned ones never.
// Threads  Every function may be called from any thread; files are read and written outside the lock.
class ArtifactStore : public ChunkSource {
 public:
  // Opens the folder (made if missing), removes what an earlier run left half-written or damaged and evicts down to
  // `max_bytes`. Errors: kUnavailable when the folder cannot be made, read or is in use by another worker.
  [[nodiscard]] static Result<std::unique_ptr<ArtifactStore>> Open(std::filesystem::path folder,
                                                                   std::uint64_t max_bytes);
  ~ArtifactStore() override;
  ArtifactStore(const ArtifactStore&) = delete;
  ArtifactStore& operator=(const ArtifactStore&) = delete;

  // Stores an artifact, in place of an older one of that key. Errors: kUnavailable when it does not fit (message says
  // which bound) or the disk refuses it.
  [[nodiscard]] Result<ArtifactInfo> Put(const ArtifactKey& key, std::string_view artifact);
  // The same of one whose size and digest the caller has just seen to be those of `info`.
  [[nodiscard]] Status PutVerified(const ArtifactInfo& info, std::string_view artifact);

  // The whole artifact. Errors: kUnavailable when there is none; kCorrupt when its file fails its digest (then
  // dropped).
  [[nodiscard]] Result<std::string> Get(const ArtifactKey& key);

  // Bytes [offset, offset + max_bytes) or as many as there are. Errors as Get; kInvalidArgument for an offset past the
  // end.
  [[nodiscard]] Result<ArtifactChunk> ReadChunk(const ArtifactKey& key, std::uint64_t offset,
                                                std::uint64_t max_bytes) override;

  [[nodiscard]] std::optional<ArtifactInfo> Find(const ArtifactKey& key) const;
  // All artifacts by key.
  [[nodiscard]] std::vector<ArtifactInfo> List() const;
  // Bytes of all files, headers included: at most the bound.
  [[nodiscard]] std::uint64_t total_bytes() const;

  // Who is about to fetch an artifact from elsewhere into this store holds its lock, so that it is fetched once
  // (FetchOnce).
  [[nodiscard]] KeyLocks& fetching() { return fetching_; }

  [[nodiscard]] ArtifactPins Pin(std::vector<ArtifactKey> keys);
  // Removes an artifact that turned out to be useless, and reports it as dropped.
  void Drop(const ArtifactKey& key);
  // No task will ask for these any more: they are evicted before all others.
  void Release(const std::vector<ArtifactKey>& keys);
  // Somebody will fetch these: they are evicted after all others, until they are released.
  void Keep(const std::vector<ArtifactKey>& keys);
  // Nobody is known to fetch any.
  void KeepNone();

  // What was evicted or found corrupt since the last call, for the coordinator to forget. Not what Open dropped: nobody
  // was told of that.
  [[nodiscard]] std::vector<ArtifactKey> TakeDropped();

 private:
  friend class ArtifactPins;
  enum class Rank : std::uint8_t { kReleased, kUsed, kKept };  // the order of eviction
  struct Entry {
    ArtifactInfo info;
    bool verified = false;  // digest seen to be right since Open
    Rank rank = Rank::kUsed;
    std::list<ArtifactKey>::iterator use;  // position in the use list
  };

  ArtifactStore(std::filesystem::path folder, std::uint64_t max_bytes, int lock_file);
  Status Scan();
  [[nodiscard]] std::filesystem::path PathOf(const ArtifactKey& key) const;
  // The artifact's size after its file was found to be right; marks it as used.
  [[nodiscard]] Result<ArtifactInfo> Verified(const ArtifactKey& key);
  [[nodiscard]] Result<std::string> ReadAndVerify(const ArtifactInfo& info);
  void Unpin(const std::vector<ArtifactKey>& keys);
  // The functions below require the mutex.
  void Insert(const ArtifactInfo& info, bool verified);
  void Touch(Entry& entry);
  void SetRank(const std::vector<ArtifactKey>& keys, Rank rank);
  [[nodiscard]] std::list<ArtifactKey>& OrderOf(Rank rank) { return orders_[static_cast<std::size_t>(rank)]; }
  void Erase(const ArtifactKey& key);
  void Evict(const ArtifactKey& key);
  // Evicts until `needed` more bytes fit.
  [[nodiscard]] Status MakeRoom(std::uint64_t needed);
  [[nodiscard]] std::optional<ArtifactKey> NextVictim() const;

  const std::filesystem::path folder_;
  const std::uint64_t max_bytes_;
  const int lock_file_;  // held for the store's life: one worker per folder

  KeyLocks fetching_;

  mutable std::mutex mutex_;
  std::map<ArtifactKey, Entry> entries_;
  std::array<std::list<ArtifactKey>, 3> orders_;  // of each rank, least recently used first
  std::map<ArtifactKey, int> pins_;
  std::uint64_t total_bytes_ = 0;
  std::uint64_t next_temporary_ = 0;
  std::vector<ArtifactKey> dropped_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_STORE_H_
