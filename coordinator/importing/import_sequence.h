#ifndef DEPTHFARM_COORDINATOR_IMPORTING_IMPORT_SEQUENCE_H_
#define DEPTHFARM_COORDINATOR_IMPORTING_IMPORT_SEQUENCE_H_

#include "common/base/status.h"
#include "common/sequence/sequence.h"
#include "coordinator/importing/import_checks.h"
#include "coordinator/importing/import_options.h"

namespace depthfarm {

struct ImportedSequence {
  Sequence sequence;    // as it was written
  Camera reference;     // its reference
  DepthRange range;     // of the reference
  ArrayOverview array;  // of the cameras with pictures, or where none has any, of all
};

// Reads a calibration of another program and writes options.output, a sequence file that ReadSequence takes, under a
// temporary name first.
//
// The depth range is that of the options; else what the format tells: each camera's own (miv, llff), or that of the
// points which the reference sees (colmap, see RobustRange). The reference is that of the options; else the centre
// camera of those with pictures.
// Errors  kInvalidArgument: whatever is wrong with calibration, pictures or options, naming file, camera and option;
//         kUnavailable: the file cannot be written. What was at options.output is then as before.
[[nodiscard]] Result<ImportedSequence> ImportSequence(const ImportOptions& options);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_IMPORTING_IMPORT_SEQUENCE_H_
