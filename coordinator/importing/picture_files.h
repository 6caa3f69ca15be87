#ifndef DEPTHFARM_COORDINATOR_IMPORTING_PICTURE_FILES_H_
#define DEPTHFARM_COORDINATOR_IMPORTING_PICTURE_FILES_H_

#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/calibration/calibration.h"
#include "common/sequence/sequence.h"
#include "coordinator/importing/calibration_files.h"
#include "coordinator/importing/import_options.h"

namespace depthfarm {

// The cameras of a sequence file at `output` (absolute) with the pictures that the options name, as absolute paths;
// without --images and --videos they have none. Looks at every file and opens none.
// Of coded videos the number of frames is believed.
// Errors (kInvalidArgument, naming camera, file and option): a pattern, frames or pixel format that are none, a picture
// that is missing, empty, no file or, of a raw format, not of the size of one picture, one of two cameras, or outside
// the folder of `output`. With allow_missing a camera none of whose pictures is there has none.
[[nodiscard]] Result<std::vector<SequenceCamera>> CamerasWithPictures(const std::vector<CalibratedCamera>& cameras,
                                                                      const CalibrationFormat& format,
                                                                      const ImportOptions& options,
                                                                      const std::string& output);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_IMPORTING_PICTURE_FILES_H_
