#ifndef DEPTHFARM_COMMON_COMPRESSION_ZSTD_FRAME_H_
#define DEPTHFARM_COMMON_COMPRESSION_ZSTD_FRAME_H_

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// Appends `content` as one zstd frame (level 1) with its size and a checksum of it. At each of `cuts`, offsets into
// `content` that do not fall, a block begins: codes are chosen for each block, so parts of different statistics
// compress better apart. Same content and cuts, same bytes with the same version of libzstd.
void AppendZstdFrame(std::string_view content, std::string& bytes, std::span<const std::size_t> cuts = {});

// The first `size` bytes of a frame's content, without unpacking the rest. Errors (kCorrupt): no frame, fewer bytes.
[[nodiscard]] Result<std::string> ReadZstdFrameStart(std::string_view frame, std::size_t size);

// The content of a frame made by AppendZstdFrame. Takes memory only once the frame says a size within
// [min_size, max_size] that its bytes could hold.
// Errors (kCorrupt): anything but exactly one whole frame with size and checksum, a size out of bounds, damage.
[[nodiscard]] Result<std::string> ReadZstdFrame(std::string_view frame, std::size_t min_size, std::size_t max_size);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_COMPRESSION_ZSTD_FRAME_H_
