#ifndef DEPTHFARM_COMMON_SEQUENCE_PICTURE_FORMAT_H_
#define DEPTHFARM_COMMON_SEQUENCE_PICTURE_FORMAT_H_

#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// The names of raw formats as sequence files and options have them, which are FFmpeg's with the bits always told:
// "yuv420p8", "yuv420p9le" to "yuv420p16le", and so on.
inline constexpr const char* kRawFormatNames =
    "yuv420p8, yuv420p9le to yuv420p16le, the same of yuv422p and yuv444p, gray8, gray9le to gray16le";

// Kind and bits of a raw format; all else stays as it is. False: `name` is none, `format` is as before.
[[nodiscard]] bool ParseRawFormat(std::string_view name, PictureFormat* format);

// The inverse, of raw kinds.
[[nodiscard]] std::string RawFormatName(const PictureFormat& format);

// Columns and rows of pixels that share a sample of chroma, as powers of two: 1 and 1 of 4:2:0. Of coloured raw kinds.
struct ChromaShift {
  int x = 0;
  int y = 0;
};
[[nodiscard]] ChromaShift ChromaShiftOf(PictureFormat::Kind kind);

// The bytes of one picture and how they hold it.
struct PictureBytes {
  std::string bytes;
  PictureFormat format;  // no kVideo, not of all frames
};

// Bytes of one raw picture: a plane of width x height and, where it is coloured, two of chroma, sizes rounded up.
[[nodiscard]] std::uint64_t RawPictureBytes(const PictureFormat& format, int width, int height);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_PICTURE_FORMAT_H_
