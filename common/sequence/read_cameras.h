#ifndef DEPTHFARM_COMMON_SEQUENCE_READ_CAMERAS_H_
#define DEPTHFARM_COMMON_SEQUENCE_READ_CAMERAS_H_

#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"

namespace depthfarm {

// Virtual cameras: a JSON file with one camera (name, width, height, K, R, t as in a sequence file) or with a list of
// them under "cameras". As strict as ReadSequence; names may repeat.
// Errors  kInvalidArgument naming file, camera or key, the value found and what was expected.
[[nodiscard]] Result<std::vector<Camera>> ReadCameras(const std::string& file);

// The same of the text of such a file; `file` is not opened.
[[nodiscard]] Result<std::vector<Camera>> ParseCameras(std::string_view text, const std::string& file);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_READ_CAMERAS_H_
