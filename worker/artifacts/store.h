#ifndef DEPTHFARM_WORKER_ARTIFACTS_STORE_H_
#define DEPTHFARM_WORKER_ARTIFACTS_STORE_H_

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "worker/artifacts/chunk_memory.h"
#include "worker/artifacts/chunk_source.h"
#include "worker/artifacts/key_locks.h"
#include "worker/artifacts/shared_folder.h"
#include "worker/artifacts/store_file.h"

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
// Workers of one host may share the folder (SharedFolder): what one makes or fetches all find; the bound, the order of
// eviction and the pins are of all of them.
//
// Layout   FOLDER/a/<key in hex>, a its first digit. A file is a header (store_file.h) and the artifact.
//          It is written under another name and renamed, so a file of a killed worker is whole or absent; nothing is
//          synced to disk, since what a power cut leaves fails its digest and is made again.
// Trust    The content digest is checked when a file is first used after a restart, or was made by another worker, and
//          at every Get; what fails it is dropped.
// Bound    Sum of the files. The least recently used goes first, released ones before all others, kept ones after all
//          others, pinned ones never. Released and kept is the file, for all workers.
//          What another worker evicted is found missing when it is asked for next, and reported as dropped.
// Threads  Every function may be called from any thread; files are read and written outside the lock.
class ArtifactStore : public ChunkSource {
 public:
  // Opens the folder (made if missing), removes what an earlier run left half-written or damaged and evicts down to
  // `max_bytes`. Errors: kUnavailable when the folder cannot be made, read or locked.
  [[nodiscard]] static Result<std::unique_ptr<ArtifactStore>> Open(std::filesystem::path folder,
                                                                   std::uint64_t max_bytes);
  ~ArtifactStore() override = default;
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

  // Of another worker too.
  [[nodiscard]] std::optional<ArtifactInfo> Find(const ArtifactKey& key);
  // By key, all that were there at Open or were put or found since, and still are.
  [[nodiscard]] std::vector<ArtifactInfo> List();
  // Bytes of all files, headers included: at most the bound.
  [[nodiscard]] std::uint64_t total_bytes();

  // Who is about to fetch an artifact from elsewhere into this store holds its lock, so that it is fetched once
  // (FetchOnce).
  [[nodiscard]] KeyLocks& fetching() { return fetching_; }
  // And then this, for the same among the workers that share the folder. The wait ends soon after `stop`.
  [[nodiscard]] FetchTurn TakeFetchTurn(const ArtifactKey& key, const std::stop_token& stop) const {
    return {folder_path_, key, stop};
  }

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
  struct Entry {
    ArtifactInfo info;
    FileId file;            // that it was seen in
    bool verified = false;  // digest seen to be right
  };
  using Entries = std::map<ArtifactKey, Entry>;

  ArtifactStore(std::filesystem::path path, std::uint64_t max_bytes, std::unique_ptr<SharedFolder> folder)
      : folder_path_(std::move(path)), max_bytes_(max_bytes), folder_(std::move(folder)) {}
  Status Scan();
  // The artifact's size after its file was found to be right; marks it as used.
  [[nodiscard]] Result<ArtifactInfo> Verified(const ArtifactKey& key);
  [[nodiscard]] Result<std::string> ReadAndVerify(const ArtifactInfo& info);
  // The same for who does not need the bytes, which are never in memory at once.
  [[nodiscard]] Status Verify(const ArtifactInfo& info);
  // The file that such an artifact was seen in. Errors: kUnavailable: it is another one now, or gone.
  [[nodiscard]] Result<FileId> FileOf(const ArtifactInfo& info);
  // What the digest of the bytes in `file` says, or the error of reading them: the artifact is right, or was no longer
  // of interest, or is dropped. Errors as Get.
  [[nodiscard]] Status Judge(const ArtifactInfo& info, const FileId& file, const Result<ContentDigest>& digest);
  // Moves a written file to its place, makes room for it.
  [[nodiscard]] Status Accept(const ArtifactInfo& info, const std::string& written_as);
  void Unpin(const std::vector<ArtifactKey>& keys);
  void SetRank(const std::vector<ArtifactKey>& keys, SharedFolder::Rank rank);
  // The functions below require the mutex.
  // Compares what is known with what is there: others add, replace and remove files.
  [[nodiscard]] Entries::iterator Look(const ArtifactKey& key);
  void Insert(const ArtifactInfo& info, const FileId& file, bool verified);
  void Forget(const ArtifactKey& key);  // and report it as dropped
  void Evict(const ArtifactKey& key);
  void TellPins();

  const std::filesystem::path folder_path_;
  const std::uint64_t max_bytes_;

  KeyLocks fetching_;
  ChunkMemory chunk_memory_;

  mutable std::mutex mutex_;
  const std::unique_ptr<SharedFolder> folder_;
  Entries entries_;
  std::set<ArtifactKey> kept_;  // that this store was told to keep
  std::map<ArtifactKey, int> pins_;
  std::vector<ArtifactKey> dropped_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_STORE_H_
