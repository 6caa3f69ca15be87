#ifndef DEPTHFARM_WORKER_ARTIFACTS_SHARED_FOLDER_H_
#define DEPTHFARM_WORKER_ARTIFACTS_SHARED_FOLDER_H_

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "common/base/status.h"
#include "common/files/open_file.h"
#include "common/job/task.h"

namespace depthfarm {

// A folder of artifact files which the workers of a host may share: who may change it when, how many bytes it holds,
// what must stay, and what goes first.
//
//   FOLDER/a/<key in hex>       the artifacts, a its first digit; what is used is touched, so that the file that was
//                               modified longest ago was used longest ago; two bits of its mode are its rank. Few
//                               folders: to make and remove one costs more than a file
//   FOLDER/lock                 locked while files are added, removed or marked; holds the sum of their bytes and when
//                               one was released last
//   FOLDER/pins/N               of each SharedFolder that is open: keys that must stay; locked as long as it is open
//   FOLDER/turns/abc            locked by who fetches an artifact whose key begins so
//
// All locks are flock's, which the kernel releases when a process ends, however it does. A sum that was not written
// back is counted anew. A rank is of the file: whoever gave it, it holds for all, until another one is given, the file
// is replaced, or the folder is opened when nobody else has it open. The folder must be on a file system of the host.
// Not thread-safe: one owner at a time.
class SharedFolder {
 public:
  enum class Rank : std::uint8_t { kReleased, kUsed, kKept };  // the order of eviction
  // Ordered as they are evicted.
  struct StoredFile {
    Rank rank = Rank::kUsed;
    std::int64_t used = 0;  // when last, nanoseconds since 1970
    ArtifactKey key{};
    std::uint64_t bytes = 0;  // of the file
    // NOLINTNEXTLINE(modernize-use-nullptr): the 0 is the compiler's
    auto operator<=>(const StoredFile&) const = default;
  };

  // Makes the folder if it is missing, and counts. Errors: kUnavailable: it cannot be made, read or locked.
  [[nodiscard]] static Result<std::unique_ptr<SharedFolder>> Open(std::filesystem::path folder);
  ~SharedFolder();
  SharedFolder(const SharedFolder&) = delete;
  SharedFolder& operator=(const SharedFolder&) = delete;

  [[nodiscard]] std::filesystem::path PathOf(const ArtifactKey& key) const;
  // Where its file is written before it is added: another one each time, whoever else writes the same. Any thread.
  [[nodiscard]] std::string TemporaryFor(const ArtifactKey& key);
  // All artifact files, in the order of eviction.
  [[nodiscard]] Result<std::vector<StoredFile>> List() const;

  // While it lives nobody else adds or removes files. At most one at a time.
  class Change {
   public:
    Change(Change&& other) noexcept : folder_(std::exchange(other.folder_, nullptr)) {}
    Change& operator=(Change&&) = delete;
    ~Change();

    // Of all files.
    [[nodiscard]] std::uint64_t bytes() const { return folder_->bytes_; }
    // Moves a file that was written beside its place to it, in place of an older one.
    [[nodiscard]] Status Add(const ArtifactKey& key, const std::string& written_as);
    // Nothing if there is no such file.
    void Remove(const ArtifactKey& key);
    // Gives a file its rank, which counts as a use if it had another one. Nothing if there is no such file.
    void SetRank(const ArtifactKey& key, Rank rank);
    // Removes what is first in the order and nobody pins until `needed` more bytes are within `max_bytes`, and tells
    // what. kUnavailable: there is not so much that may go; what could go is gone.
    [[nodiscard]] Status MakeRoom(std::uint64_t needed, std::uint64_t max_bytes, std::vector<ArtifactKey>& removed);

   private:
    friend class SharedFolder;
    explicit Change(SharedFolder* folder) : folder_(folder) {}
    SharedFolder* folder_;
  };
  // Waits for others that change it. kUnavailable: the lock cannot be had.
  [[nodiscard]] Result<Change> Begin();

  // Replaces what this one pins.
  void SetPins(const std::set<ArtifactKey>& keys);
  // It was used now.
  void Touch(const ArtifactKey& key);

 private:
  SharedFolder(std::filesystem::path folder, int lock) : folder_(std::move(folder)), lock_(lock) {}
  [[nodiscard]] Status OpenPins();
  // The functions below require the lock.
  [[nodiscard]] Status ReadSum();
  [[nodiscard]] Status Count();
  // Removes what killed processes were writing, and forgets all ranks.
  void TidyUp() const;
  // Now, in nanoseconds since 1970, and later than the last one.
  [[nodiscard]] std::int64_t NextTime();
  // What others pin; forgets those that have ended.
  [[nodiscard]] std::set<ArtifactKey> PinsOfOthers();
  [[nodiscard]] std::optional<StoredFile> Stat(const ArtifactKey& key) const;
  [[nodiscard]] bool RemoveUnlessChanged(const StoredFile& victim);

  const std::filesystem::path folder_;
  OpenFile lock_;
  std::uint64_t bytes_ = 0;          // of all files, while the lock is held
  bool counted_ = false;             // whether that is so
  std::filesystem::path pins_path_;  // of this one
  std::unique_ptr<OpenFile> pins_file_;
  std::set<ArtifactKey> pins_;
  // As they were counted last, and what this one released since. Of the files that are still as they are here none
  // goes after one that is not here, but for kept ones, and if others have released none since.
  std::set<StoredFile> victims_;
  std::int64_t last_release_ = 0;          // by anyone, nanoseconds since 1970, while the lock is held
  std::int64_t last_release_counted_ = 0;  // that victims_ knows of
  std::int64_t last_time_ = 0;
  std::atomic<std::uint64_t> last_temporary_ = 0;
};

// The right to fetch an artifact, which one of all who share a folder has. Waits until it is free, `stop` is requested,
// or, since that only saves work, something goes wrong. Artifacts are few that share a right.
class FetchTurn {
 public:
  FetchTurn(const std::filesystem::path& folder, const ArtifactKey& key, const std::stop_token& stop);

 private:
  OpenFile file_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_SHARED_FOLDER_H_
