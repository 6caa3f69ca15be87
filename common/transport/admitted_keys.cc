#include "common/transport/admitted_keys.h"

namespace depthfarm {

void AdmittedKeys::Replace(AllowedKeys allowed) {
  const std::lock_guard lock(mutex_);
  allowed_.swap(allowed);
}

std::optional<std::string> AdmittedKeys::UserOf(const std::string& key) const {
  const std::lock_guard lock(mutex_);
  const auto user = allowed_.find(key);
  return user == allowed_.end() ? std::nullopt : std::optional(user->second);
}

}  // namespace depthfarm
