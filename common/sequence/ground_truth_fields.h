#ifndef DEPTHFARM_COMMON_SEQUENCE_GROUND_TRUTH_FIELDS_H_
#define DEPTHFARM_COMMON_SEQUENCE_GROUND_TRUTH_FIELDS_H_

#include <functional>
#include <optional>
#include <string>

#include "common/sequence/json_fields.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// Turns a path as written in the file, called `what` in messages, into an absolute one or says why not.
using PathResolver = std::function<Result<std::string>(const std::string& path, const std::string& what)>;

// What the parsing of ground truth needs of the rest of the file.
struct GroundTruthContext {
  std::string where;  // begins messages, e.g. "cameras.json: groundTruth"
  PathResolver resolve;
  std::optional<double> disparity_offset;  // the sequence's x-disparityOffset, pixels
  std::size_t num_frames = 0;              // 0 = no camera has pictures
};

// Reads the value of `groundTruth` into sequence.ground_truth, or into sequence.warnings when its wording is unknown.
// Two forms:
//   a) measured sets, one frame, in words: {"view": "L", "file": "gt.png", "encoding": "8-bit, disparity = value/4, 0 =
//      unknown", "depth": "z = 450.0/disparity", "masks": "nonocc.png, ..."}; encoding may also be "PFM float32, pixels
//      per grid step[, bottom row first as PFM prescribes]" or "z-pfm" (then without "depth"), and depth
//      "z = S/(disparity + N)" or "... + disparityOffset)".
//   b) rendered scenes, in lists: {"encoding": "z-pfm", "zones": {name: value}, "views": [{"view", "depth": [...],
//      "zones": [...]}]}
// Errors  kInvalidArgument: wrong types, unknown keys, a view that is no camera, a path that leaves the folder, lists
// that
//         do not have one entry per frame.
[[nodiscard]] Status ReadGroundTruthFields(const Json& value, const GroundTruthContext& context, Sequence* sequence);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_GROUND_TRUTH_FIELDS_H_
