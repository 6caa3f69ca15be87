#ifndef DEPTHFARM_WORKER_SERVICE_KEY_LOCKS_H_
#define DEPTHFARM_WORKER_SERVICE_KEY_LOCKS_H_

#include <condition_variable>
#include <mutex>
#include <set>

#include "common/job/task.h"

namespace depthfarm {

// One lock for each artifact: who has it is fetching that artifact. Thread-safe.
class KeyLocks {
 public:
  // Gives the lock back when it dies; must not outlive the locks.
  class Lock {
   public:
    Lock(KeyLocks& locks, const ArtifactKey& key) : locks_(locks), key_(key) {}
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;
    ~Lock() { locks_.GiveBack(key_); }

   private:
    KeyLocks& locks_;
    const ArtifactKey key_;
  };
  // Waits until nobody has the lock of the key.
  [[nodiscard]] Lock Take(const ArtifactKey& key);

 private:
  void GiveBack(const ArtifactKey& key);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<ArtifactKey> taken_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SERVICE_KEY_LOCKS_H_
