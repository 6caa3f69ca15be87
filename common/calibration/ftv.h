#ifndef DEPTHFARM_COMMON_CALIBRATION_FTV_H_
#define DEPTHFARM_COMMON_CALIBRATION_FTV_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/calibration/calibration.h"

namespace depthfarm {

// How a file of MPEG FTV camera parameters is meant. The file does not say, and its users differ.
struct FtvConvention {
  // What [R | T] is.
  enum class Pose {
    kCentre,         // x_cam = R (X - T): T is the camera's centre. DERS, and VSRS as it is used with it
    kCameraToWorld,  // X = R x_cam + T: the general mode of some versions of VSRS
    kWorldToCamera,  // x_cam = R X + T
  };
  Pose pose = Pose::kCentre;
  // The scene has negative depth, as where VSRS is given a negative nearest depth: pixel = K x_cam / z with z < 0. The
  // world of the result is mirrored at its origin, X' = -X, which makes the same pixels with z > 0 and leaves R a
  // rotation.
  bool scene_behind = false;
};

// The camera parameter text of VSRS and DERS: of each camera its name, three rows of K, two numbers of lens distortion
// and three rows of [R | T]. Lines that begin with '#' between cameras are comments. Pixel (0, 0) is the centre of the
// top-left pixel. `size` is that of all pictures; `file` is for messages.
// Errors  kInvalidArgument naming file, line and camera: a word where a number is expected or the other way round, an
//         end amid a camera, distortion that is not 0, a camera that is there twice (in files of moving cameras), K or
//         R that are none.
[[nodiscard]] Result<Calibration> ParseFtvCameras(std::string_view text, const std::string& file,
                                                  const PictureSize& size, const FtvConvention& convention);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_FTV_H_
