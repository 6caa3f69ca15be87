#ifndef DEPTHFARM_COMMON_SEQUENCE_GUIDES_H_
#define DEPTHFARM_COMMON_SEQUENCE_GUIDES_H_

#include <string>

#include "common/base/status.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// What guides the estimation besides the pictures, taken from folders. A camera or frame without a file has no guide;
// only a folder that has none for any camera of the sequence is an error.

// Prior depth (SequenceCamera::prior): `directory` holds depth.json, so is an output folder of this program, or
// prior.json:
//
//   {"holds": "depth" | "inverse-depth" | "relative-depth",   see PriorFormat
//    "unit": 0.001,     optional, of depth and inverse depth: length of 1 in the sequence's unit; default 1
//    "still": true,     optional: the files of frame 0 are those of every frame, e.g. a background plate
//    "notes": "..."}
//
// with depth/<camera>/<frame, 4 digits or more>.pfm, .exr or .png (grey; 0 = unknown) and, where there is any,
// confidence/<camera>/<frame>.png. Maps of another resolution than the pictures are sampled.
// Errors (kInvalidArgument, naming file, key or camera): neither file is there, or it is wrong; no file for any camera.
[[nodiscard]] Status AddPriors(const std::string& directory, Sequence& sequence);

// Foreground masks (SequenceCamera::masks) in place of those that the sequence names: <camera>/<frame>.png in
// `directory`, grey, 0 = background, full white = foreground. Errors: kInvalidArgument: no file for any camera.
[[nodiscard]] Status AddMasks(const std::string& directory, Sequence& sequence);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_GUIDES_H_
