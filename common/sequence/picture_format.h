#ifndef DEPTHFARM_COMMON_SEQUENCE_PICTURE_FORMAT_H_
#define DEPTHFARM_COMMON_SEQUENCE_PICTURE_FORMAT_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// The names of raw formats as sequence files and options have them, which are FFmpeg's: "yuv420p8", "yuv420p9le" to
// "yuv420p16le", "gray8", "gray9le" to "gray16le".
inline constexpr const char* kRawFormatNames = "yuv420p8, yuv420p9le to yuv420p16le, gray8, gray9le to gray16le";

// Kind and bits of a raw format; range and matrix are the defaults. False: `name` is none, `format` is as before.
[[nodiscard]] bool ParseRawFormat(std::string_view name, PictureFormat* format);

// The inverse, of raw kinds.
[[nodiscard]] std::string RawFormatName(const PictureFormat& format);

// Bytes of one raw picture: planes of width x height and, for 4:2:0, two of half the size rounded up.
[[nodiscard]] std::uint64_t RawPictureBytes(const PictureFormat& format, int width, int height);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_PICTURE_FORMAT_H_
