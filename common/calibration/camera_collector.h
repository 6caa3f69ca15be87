#ifndef DEPTHFARM_COMMON_CALIBRATION_CAMERA_COLLECTOR_H_
#define DEPTHFARM_COMMON_CALIBRATION_CAMERA_COLLECTOR_H_

#include <map>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/calibration/calibration.h"

namespace depthfarm {

// The cameras of one file, each checked as it is added: every format promises the same (CalibratedCamera).
class CameraCollector {
 public:
  // `file` begins messages.
  explicit CameraCollector(std::string file) : file_(std::move(file)) {}

  // `position`: where in the file the camera is, e.g. "line 12". Errors (kInvalidArgument, naming file, position and
  // camera): a name that cannot name files or is there already, more cameras than a sequence may have, K or R that are
  // none, a range that is not 0 < near < far.
  [[nodiscard]] Status Add(CalibratedCamera camera, const std::string& position);

  // All of them in the order of adding. kInvalidArgument: there is none.
  [[nodiscard]] Result<std::vector<CalibratedCamera>> Take();

 private:
  std::string file_;
  std::map<std::string, std::string> positions_;  // by name
  std::vector<CalibratedCamera> cameras_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_CAMERA_COLLECTOR_H_
