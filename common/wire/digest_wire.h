#ifndef DEPTHFARM_COMMON_WIRE_DIGEST_WIRE_H_
#define DEPTHFARM_COMMON_WIRE_DIGEST_WIRE_H_

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// 32 bytes: ArtifactKey, ContentDigest.
[[nodiscard]] std::string DigestBytes(const std::array<std::uint8_t, 32>& digest);
[[nodiscard]] Result<std::array<std::uint8_t, 32>> DigestFromBytes(std::string_view field, std::string_view bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_WIRE_DIGEST_WIRE_H_
