#include "common/wire/digest_wire.h"

#include <algorithm>

namespace depthfarm {

std::string DigestBytes(const std::array<std::uint8_t, 32>& digest) { return {digest.begin(), digest.end()}; }

Result<std::array<std::uint8_t, 32>> DigestFromBytes(std::string_view field, std::string_view bytes) {
  std::array<std::uint8_t, 32> digest{};
  if (bytes.size() != digest.size()) {
    return InvalidArgument(std::string(field) + " has " + std::to_string(bytes.size()) + " bytes, expected 32");
  }
  std::transform(bytes.begin(), bytes.end(), digest.begin(), [](char c) { return static_cast<std::uint8_t>(c); });
  return digest;
}

}  // namespace depthfarm
