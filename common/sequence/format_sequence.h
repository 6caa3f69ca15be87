#ifndef DEPTHFARM_COMMON_SEQUENCE_FORMAT_SEQUENCE_H_
#define DEPTHFARM_COMMON_SEQUENCE_FORMAT_SEQUENCE_H_

#include <string>

#include "common/base/status.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// The text of a sequence file at `sequence.file` (absolute), which ParseSequence reads back as the same cameras,
// pictures, masks, depth, range, reference, frame rate and name; pictures that lie outside the file's folder only with
// allow_outside. Paths become relative to that folder. Ground truth, priors and warnings are no part of it.
// Errors  kInvalidArgument: a number that JSON cannot hold (NaN, infinity), a text that is not UTF-8.
[[nodiscard]] Result<std::string> FormatSequence(const Sequence& sequence);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_FORMAT_SEQUENCE_H_
