#ifndef DEPTHFARM_COMMON_TRANSPORT_ADMITTED_KEYS_H_
#define DEPTHFARM_COMMON_TRANSPORT_ADMITTED_KEYS_H_

#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "common/transport/farm_keys.h"

namespace depthfarm {

// Internal to transport. Who may come, as of now: asked at each handshake and for each message, replaced meanwhile.
// Thread-safe.
class AdmittedKeys {
 public:
  explicit AdmittedKeys(AllowedKeys allowed) : allowed_(std::move(allowed)) {}

  void Replace(AllowedKeys allowed);
  // "role:name" of a public key (Z85); nothing for a key that is not listed.
  [[nodiscard]] std::optional<std::string> UserOf(const std::string& key) const;

 private:
  mutable std::mutex mutex_;
  AllowedKeys allowed_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_ADMITTED_KEYS_H_
