#ifndef DEPTHFARM_COORDINATOR_IMPORTING_CALIBRATION_FILES_H_
#define DEPTHFARM_COORDINATOR_IMPORTING_CALIBRATION_FILES_H_

#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/calibration/calibration.h"
#include "coordinator/importing/import_options.h"

namespace depthfarm {

// Formats of calibrations and what they tell.
struct CalibrationFormat {
  const char* name;
  bool tells_size;      // of the pictures; else --size is needed
  bool tells_range;     // of depth; else --z-near and --z-far are needed
  bool names_pictures;  // so that --images may be a folder
};
// kInvalidArgument: there is no format of that name.
[[nodiscard]] Result<CalibrationFormat> FormatOf(const std::string& name);

struct ImportedCalibration {
  Calibration calibration;
  std::vector<std::vector<float>> depths;  // colmap: as ColmapModel has them; else empty
};

// Reads options.calibration. Where the format does not tell the size it is `size`; where it does and `size` is not
// 0x0, cameras are brought to it. llff names its cameras by the picture files of options.images, where that is a
// folder. Errors  kInvalidArgument: those of the format, a file that is missing or cannot be read, an option that is of
// another
//         format.
[[nodiscard]] Result<ImportedCalibration> ReadCalibration(const ImportOptions& options, const PictureSize& size);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_IMPORTING_CALIBRATION_FILES_H_
