#ifndef DEPTHFARM_WORKER_MEDIA_CLI_SCENE_FILES_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_SCENE_FILES_H_

#include <filesystem>
#include <span>
#include <vector>

#include "common/base/status.h"
#include "common/image/picture.h"
#include "common/scene/render.h"

namespace depthfarm {

using Bytes = std::vector<unsigned char>;

// PNG of 8-bit RGB or grey. kInternal if the image library refuses.
[[nodiscard]] Result<Bytes> EncodePng(const RgbImage& rgb);
[[nodiscard]] Result<Bytes> EncodePng(const ZoneMap& zones);

// Grey PFM: "Pf", size, scale -1 (little-endian), then float32 rows, the bottom one first.
[[nodiscard]] Bytes EncodePfm(const DepthMap& depth);

// Planar Y, Cb, Cr without a header, full-range BT.601, `bits` 8 or 10 (two bytes little-endian); chroma is the mean of
// each 2 x 2 pixels, its planes half as wide and high, rounded up.
[[nodiscard]] Bytes EncodeYuv420(const RgbImage& rgb, int bits);

// Writes to a temporary name beside `file` and renames. kUnavailable names the file.
[[nodiscard]] Status WriteWhole(const std::filesystem::path& file, std::span<const unsigned char> bytes);

// Makes the folder and those above it. kUnavailable names it.
[[nodiscard]] Status MakeFolder(const std::filesystem::path& folder);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_SCENE_FILES_H_
