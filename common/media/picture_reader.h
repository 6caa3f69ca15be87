#ifndef DEPTHFARM_COMMON_MEDIA_PICTURE_READER_H_
#define DEPTHFARM_COMMON_MEDIA_PICTURE_READER_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/digest/sha256.h"
#include "common/image/picture.h"
#include "common/sequence/picture_format.h"
#include "common/sequence/sequence.h"
#include "common/video_input/video_readers.h"

namespace depthfarm {

// Where a picture of a camera is, and of width x height pixels before downscaling.
struct PictureFile {
  std::string path;
  PictureFormat format;
  int width = 0;
  int height = 0;
  int position = 0;  // in a file of all frames (PictureFormat::of_all_frames): that of the frame in the sequence
  int frames = 0;    // VideoFile::frames
};

// The bytes of a picture, for DecodePicture and for a digest of exactly what was decoded: those of its file, or its
// part of one of all frames; of a video the planes that its codec gives. `videos`: those that stay open; null: none do.
// Errors, beginning with the path: those of ReadFileBytes, ReadFileRange and VideoReader; a raw picture has its exact
// size, an image file at most 1 GiB.
[[nodiscard]] Result<PictureBytes> ReadPictureBytes(const PictureFile& file, VideoReaders* videos = nullptr);

// SHA-256 of the bytes and, of a video, of what they hold: that is not said elsewhere.
[[nodiscard]] Sha256Digest DigestOf(const PictureFile& file, const PictureBytes& picture);

// Decodes one picture of a camera of width x height pixels (before downscaling), an image file or raw planes, to
// full-range BT.601 Y'CbCr in 8-bit units.
//
//   Image files: 8 or 16 bits (v / 257), grey (Cb = Cr = 128) or colour; alpha is ignored, EXIF rotation too
//   (calibration speaks of the raster as stored). Raw planes: see DecodeRawPicture. downscale 1, 2 or 4: box average
//   over downscale x downscale pixels, floor of the size, remaining columns and rows cut off; averaged at full
//   precision, so that there is one rounding (nearest, halves up).
// Deterministic: exact integer sums, then + - * / in double in a stated order (OpenCV's cvtColor and resize differ
// between CPUs). Decoded JPEG samples are those of the JPEG library in use. Errors  kInvalidArgument, without the path:
// damaged or cut short, not of width x height (both sizes are said), downscale
//         not 1, 2, 4 or larger than a side.
[[nodiscard]] Result<YcbcrImage> DecodePicture(std::string_view bytes, const PictureFormat& format, int width,
                                               int height, int downscale);

// Both; messages begin with the path.
[[nodiscard]] Result<YcbcrImage> ReadPicture(const PictureFile& file, int downscale, VideoReaders* videos = nullptr);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_PICTURE_READER_H_
