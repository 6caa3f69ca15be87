#ifndef DEPTHFARM_WORKER_ARTIFACTS_KEY_LOCKS_H_
#define DEPTHFARM_WORKER_ARTIFACTS_KEY_LOCKS_H_

#include <condition_variable>
#include <mutex>
#include <set>
#include <stop_token>
#include <utility>

#include "common/base/status.h"
#include "common/job/task.h"

namespace depthfarm {

// One lock for each artifact: who has it is fetching that artifact. Thread-safe.
class KeyLocks {
 public:
  // Gives the lock back when it dies; must not outlive the locks.
  class Lock {
   public:
    Lock(KeyLocks& locks, const ArtifactKey& key) : locks_(&locks), key_(key) {}
    Lock(Lock&& other) noexcept : locks_(std::exchange(other.locks_, nullptr)), key_(other.key_) {}
    Lock& operator=(Lock&&) = delete;
    ~Lock() {
      if (locks_ != nullptr) locks_->GiveBack(key_);
    }

   private:
    KeyLocks* locks_;  // null after a move
    const ArtifactKey key_;
  };
  // Waits until nobody has the lock of the key. Errors: kCancelled at once when `stop` is requested while it waits.
  [[nodiscard]] Result<Lock> Take(const ArtifactKey& key, const std::stop_token& stop);

 private:
  void GiveBack(const ArtifactKey& key);

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::set<ArtifactKey> taken_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ARTIFACTS_KEY_LOCKS_H_
