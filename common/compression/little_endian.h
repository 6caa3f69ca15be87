#ifndef DEPTHFARM_COMMON_COMPRESSION_LITTLE_ENDIAN_H_
#define DEPTHFARM_COMMON_COMPRESSION_LITTLE_ENDIAN_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace depthfarm {

// 32-bit numbers of artifact headers, little-endian on every machine.
inline void AppendU32(std::uint32_t value, std::string& bytes) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(value >> shift & 0xFFU));
}

// Requires offset + 4 <= bytes.size().
[[nodiscard]] inline std::uint32_t ReadU32(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{static_cast<std::uint8_t>(bytes[offset + i])} << (8 * i);
  return value;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_COMPRESSION_LITTLE_ENDIAN_H_
