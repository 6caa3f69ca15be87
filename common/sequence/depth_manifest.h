#ifndef DEPTHFARM_COMMON_SEQUENCE_DEPTH_MANIFEST_H_
#define DEPTHFARM_COMMON_SEQUENCE_DEPTH_MANIFEST_H_

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"

namespace depthfarm {

// A file of an output folder and what its bytes must hash to.
struct DepthManifestFile {
  std::string path;    // relative to the folder of depth.json, e.g. "depth/cam0/0000.png"
  std::string sha256;  // of the file, 64 lower-case hexadecimal digits
  bool operator==(const DepthManifestFile&) const = default;
};

// The depth of one camera. Position i of every list is frame first_frame + i.
struct DepthManifestCamera {
  Camera camera;      // of the depth maps: downscaled already
  double z_near = 0;  // the camera's own range, that of the 16-bit codes; the sequence's unit of length
  double z_far = 0;
  std::vector<DepthManifestFile> files;
  std::vector<DepthManifestFile> confidence;  // empty, or as many as `files`: 16-bit PNG, probability times 65535
  std::vector<std::string> input_sha256;      // of the picture files the depth was estimated from; as many as `files`
};

using ManifestNumberOrText = std::variant<std::int64_t, double, std::string>;

// `depth.json`: what an output folder holds and from what it was made, enough to reproduce the run and nothing that
// differs between two equal runs (no times, hosts or absolute paths).
struct DepthManifest {
  std::string sequence;  // its name
  std::uint32_t algorithm_version = 0;
  int first_frame = 0;  // position in the sequence
  std::map<std::string, ManifestNumberOrText> parameters;
  std::vector<DepthManifestCamera> cameras;
};

// "depth/<camera>/<frame, 4 digits or more>.<extension>".
[[nodiscard]] std::string DepthFileName(const std::string& camera, int frame, const std::string& extension = "png");

// "confidence/<camera>/<frame>.png": beside each depth file when asked for.
[[nodiscard]] std::string ConfidenceFileName(const std::string& camera, int frame);

// The text of depth.json: equal manifests give equal bytes. kInvalidArgument: a number that JSON cannot hold (NaN,
// infinity), or lists whose lengths differ.
[[nodiscard]] Result<std::string> FormatDepthManifest(const DepthManifest& manifest);

// Writes `directory`/depth.json atomically; the folder must exist.
[[nodiscard]] Status WriteDepthManifest(const std::string& directory, const DepthManifest& manifest);

// Reads `directory`/depth.json strictly. Errors  kInvalidArgument naming file, camera and key: missing file, unknown or
// duplicate keys, wrong types or shapes, a path that leaves the folder, a digest that is none, cameras with different
// numbers of files, an unknown version of the format.
[[nodiscard]] Result<DepthManifest> ReadDepthManifest(const std::string& directory);

// The same of the text of such a file; `file` is not opened.
[[nodiscard]] Result<DepthManifest> ParseDepthManifest(std::string_view text, const std::string& file);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_DEPTH_MANIFEST_H_
