#include "worker/artifacts/key_locks.h"

namespace depthfarm {

Result<KeyLocks::Lock> KeyLocks::Take(const ArtifactKey& key, const std::stop_token& stop) {
  {
    std::unique_lock lock(mutex_);
    if (!changed_.wait(lock, stop, [&] { return !taken_.contains(key); })) return Cancelled();
    taken_.insert(key);
  }
  return Lock(*this, key);
}

void KeyLocks::GiveBack(const ArtifactKey& key) {
  {
    const std::scoped_lock lock(mutex_);
    taken_.erase(key);
  }
  changed_.notify_all();
}

}  // namespace depthfarm
