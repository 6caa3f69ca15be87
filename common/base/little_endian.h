#ifndef DEPTHFARM_COMMON_BASE_LITTLE_ENDIAN_H_
#define DEPTHFARM_COMMON_BASE_LITTLE_ENDIAN_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace depthfarm {

// Numbers in files, little-endian on every machine.
inline void AppendU32(std::uint32_t value, std::string& bytes) {
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(value >> shift & 0xFFU));
}
inline void AppendU64(std::uint64_t value, std::string& bytes) {
  AppendU32(static_cast<std::uint32_t>(value), bytes);
  AppendU32(static_cast<std::uint32_t>(value >> 32), bytes);
}

// Requires offset + 4 <= bytes.size().
[[nodiscard]] inline std::uint32_t ReadU32(std::string_view bytes, std::size_t offset) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value |= std::uint32_t{static_cast<std::uint8_t>(bytes[offset + i])} << (8 * i);
  return value;
}
// Requires offset + 8 <= bytes.size().
[[nodiscard]] inline std::uint64_t ReadU64(std::string_view bytes, std::size_t offset) {
  return ReadU32(bytes, offset) | std::uint64_t{ReadU32(bytes, offset + 4)} << 32;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_LITTLE_ENDIAN_H_
