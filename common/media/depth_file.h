#ifndef DEPTHFARM_COMMON_MEDIA_DEPTH_FILE_H_
#define DEPTHFARM_COMMON_MEDIA_DEPTH_FILE_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/image/depth_code.h"
#include "common/sequence/depth_format.h"
#include "common/sequence/depth_manifest.h"
#include "common/sequence/picture_format.h"

namespace depthfarm {

// What raw files of depth codes are (DepthFormat::kYuv420p16); the codes are their luma.
inline constexpr PictureFormat kRawCodes{.kind = PictureFormat::Kind::kYuv420, .bits = 16};

// 16-bit PNG of depth codes (0 = no depth). Byte-deterministic for one version of libdeflate: see EncodePng.
[[nodiscard]] Result<std::string> EncodeDepthPng(const Grid<std::uint16_t>& codes);
// The same from inverse depths (1/z, anything not > 0 = no depth) or depths (z, 0 = no depth).
[[nodiscard]] Result<std::string> EncodeInverseDepthPng(const Grid<float>& inverse_depth, const DepthCode& code);
[[nodiscard]] Result<std::string> EncodeDepthPng(const DepthMap& depth, const DepthCode& code);

// The file of a depth map as `format` says, from its codes: metric formats hold DecodeDepth of them. Errors: an empty
// map.
[[nodiscard]] Result<std::string> EncodeDepthFile(const Grid<std::uint16_t>& codes, const DepthCode& code,
                                                  DepthFormat format);

// Codes of a depth PNG. Errors (kInvalidArgument, without the path): not decodable, not 16-bit grey.
[[nodiscard]] Result<Grid<std::uint16_t>> DecodeDepthPng(std::string_view bytes);

// A depth map of `width` x `height` from a file of the format that its name ends with (DepthFormat). Errors: those
// above and another size, an unknown ending, beginning with the path.
[[nodiscard]] Result<DepthMap> ReadDepthFile(const std::string& path, int width, int height, const DepthCode& code);

// Codes of a 16-bit PNG of `width` x `height`, depth or confidence. Errors: as ReadDepthFile.
[[nodiscard]] Result<Grid<std::uint16_t>> ReadCodesFile(const std::string& path, int width, int height);

// Codes of a depth map of any format. Errors: as ReadDepthFile.
[[nodiscard]] Result<Grid<std::uint16_t>> ReadDepthCodes(const std::string& path, int width, int height,
                                                         const DepthCode& code);

// The depth map at `position` (0 = the manifest's first frame) of a camera of `directory`/depth.json. Digests are not
// checked here. kInvalidArgument also for a position beyond the camera's files.
[[nodiscard]] Result<DepthMap> ReadDepthOf(const std::string& directory, const DepthManifestCamera& camera,
                                           std::size_t position);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_MEDIA_DEPTH_FILE_H_
