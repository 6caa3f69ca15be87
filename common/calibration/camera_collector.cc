#include "common/calibration/camera_collector.h"

#include <cmath>
#include <utility>

#include "common/calibration/token_reader.h"
#include "common/sequence/camera_fields.h"
#include "common/sequence/json_fields.h"
#include "common/sequence/read_sequence.h"
#include "common/text/clean_line.h"

namespace depthfarm {

Status CameraCollector::Add(CalibratedCamera camera, const std::string& position) {
  const std::string where = file_ + ": " + position;
  const std::string& name = camera.camera.name;
  DEPTHFARM_RETURN_IF_ERROR(CheckCameraName(name, where));
  if (CleanLine(name, kMaxNameLength) != name) {
    return InvalidArgument(where + ": the name of camera " + Quoted(name) + " is no UTF-8: rename it");
  }
  const auto [known, is_new] = positions_.emplace(name, position);
  if (!is_new) {
    return InvalidArgument(where + ": camera '" + name + "' is there already, at " + known->second +
                           ": names are distinct, and cameras that move are not supported, so keep one of them");
  }
  if (cameras_.size() >= static_cast<std::size_t>(kMaxCameras)) {
    return InvalidArgument(where + ": more than " + std::to_string(kMaxCameras) +
                           " cameras, which is the most of a sequence: keep those you need");
  }
  DEPTHFARM_RETURN_IF_ERROR(ValidateCamera(camera.camera).WithContext(where));
  if (camera.z_near && !(*camera.z_near > 0 && *camera.z_near < *camera.z_far && std::isfinite(*camera.z_far))) {
    return InvalidArgument(where + ": camera '" + name + "': its depth range is " + Shortened(Json(*camera.z_near)) +
                           " to " + Shortened(Json(*camera.z_far)) + ", expected 0 < near < far");
  }
  cameras_.push_back(std::move(camera));
  return {};
}

Result<std::vector<CalibratedCamera>> CameraCollector::Take() {
  if (cameras_.empty()) return InvalidArgument(file_ + ": holds no camera");
  return std::move(cameras_);
}

}  // namespace depthfarm
