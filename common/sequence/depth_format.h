#ifndef DEPTHFARM_COMMON_SEQUENCE_DEPTH_FORMAT_H_
#define DEPTHFARM_COMMON_SEQUENCE_DEPTH_FORMAT_H_

#include <optional>
#include <string>
#include <string_view>

namespace depthfarm {

// How depth maps are written, one file for each camera and frame: the same depth in each, that of the 16-bit codes
// (DepthCode), a step of which is less than a hundredth of a pixel of motion.
enum class DepthFormat {
  kPng16,      // codes as 16-bit grey PNG
  kPfm,        // z in the sequence's unit as 32-bit floats, 0 where there is no depth
  kExr,        // the same as channel Z of an OpenEXR file, compressed
  kYuv420p16,  // codes as luma of one raw picture, two bytes each, low byte first; grey chroma
};

// "png16", "pfm", "exr", "yuv420p16": as options and depth.json have it.
[[nodiscard]] std::string_view NameOf(DepthFormat format);
[[nodiscard]] std::optional<DepthFormat> DepthFormatOfName(std::string_view name);
// Names of all, for errors: "png16, pfm, exr or yuv420p16".
[[nodiscard]] std::string_view DepthFormatNames();

// Of its files: "png", "pfm", "exr", "yuv".
[[nodiscard]] std::string ExtensionOf(DepthFormat format);
// What a file that this program wrote holds, by how its name ends.
[[nodiscard]] std::optional<DepthFormat> DepthFormatOfFile(std::string_view path);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_DEPTH_FORMAT_H_
