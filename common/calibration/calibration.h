#ifndef DEPTHFARM_COMMON_CALIBRATION_CALIBRATION_H_
#define DEPTHFARM_COMMON_CALIBRATION_CALIBRATION_H_

#include <optional>
#include <string>
#include <vector>

#include "common/geometry/camera.h"

namespace depthfarm {

// A camera that another program calibrated, in the conventions of Camera. Valid (ValidateCamera), with a name that is
// fit to name files.
struct CalibratedCamera {
  Camera camera;
  std::string picture;  // its only picture, relative to a folder that the user knows; "": the format names none
  std::optional<double> z_near;  // own depth range, where the format has it; both or none
  std::optional<double> z_far;
  bool operator==(const CalibratedCamera&) const = default;
};

// What a calibration holds. Names are distinct; there is at least one camera.
struct Calibration {
  std::vector<CalibratedCamera> cameras;
  double frame_rate = 0;  // 0 = unknown
};

// Width and height of pictures in pixels, each 1 to 32768: of formats that do not tell.
struct PictureSize {
  int width = 0;
  int height = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_CALIBRATION_H_
