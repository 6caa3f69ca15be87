#ifndef DEPTHFARM_COMMON_MEDIA_DECODED_SIZE_H_
#define DEPTHFARM_COMMON_MEDIA_DECODED_SIZE_H_

#include <cstddef>

namespace depthfarm {

// Decoded bytes that an image file of so many bytes may say it holds: headers are believed before a pixel is read. A
// PNG of one colour and one bit a pixel has the most, 8,256 for each of its bytes; small pictures may be of any format.
[[nodiscard]] constexpr std::size_t MostDecodedBytes(std::size_t file_bytes) {
  constexpr std::size_t kOfSmall = std::size_t{64} << 20;
  constexpr std::size_t kExpansion = 9000;
  return kOfSmall + kExpansion * file_bytes;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_DECODED_SIZE_H_
