#include "worker/service/key_locks.h"

namespace depthfarm {

KeyLocks::Lock KeyLocks::Take(const ArtifactKey& key) {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !taken_.contains(key); });
    taken_.insert(key);
  }
  return {*this, key};
}

void KeyLocks::GiveBack(const ArtifactKey& key) {
  {
    const std::scoped_lock lock(mutex_);
    taken_.erase(key);
  }
  changed_.notify_all();
}

}  // namespace depthfarm
