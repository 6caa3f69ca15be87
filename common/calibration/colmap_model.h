#ifndef DEPTHFARM_COMMON_CALIBRATION_COLMAP_MODEL_H_
#define DEPTHFARM_COMMON_CALIBRATION_COLMAP_MODEL_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/calibration/calibration.h"

namespace depthfarm {

struct ColmapFile {
  std::string name;          // for messages
  std::string_view content;  // must outlive the call
};

// A sparse model of COLMAP: cameras, images and points3D, all as text or all binary.
struct ColmapFiles {
  bool binary = false;
  ColmapFile cameras;
  ColmapFile images;
  std::optional<ColmapFile> points;
};

// Each image of a model is a camera, in the order of their names.
struct ColmapModel {
  Calibration calibration;
  std::vector<std::vector<float>>
      depths;  // of each camera: along its axis, of the points that it sees; see RobustRange
};

// A camera is called as its image: the ending goes, unless another image has the same name without it, and '/' becomes
// '_'. Its picture is the name as it is. Rotations are brought to length 1.
// Errors  kInvalidArgument naming file, line or byte, and image: a file that is damaged or claims more than it holds, a
//         lens with distortion, an image whose camera is missing, names that are none or are there twice.
[[nodiscard]] Result<ColmapModel> ParseColmapModel(const ColmapFiles& files);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_COLMAP_MODEL_H_
