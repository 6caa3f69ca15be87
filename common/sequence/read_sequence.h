#ifndef DEPTHFARM_COMMON_SEQUENCE_READ_SEQUENCE_H_
#define DEPTHFARM_COMMON_SEQUENCE_READ_SEQUENCE_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// Bounds of what a sequence file may ask for.
inline constexpr int kMaxCameras = 1024;
inline constexpr int kMaxFrames = 1'000'000;
inline constexpr int kMaxSequenceFileMib = 256;

// The only `convention` of a sequence file.
inline constexpr const char* kSequenceConvention =
    "x_cam = R*X_world + t, +z forward, +y down, pixels (0,0)=centre of top-left pixel";

struct ReadSequenceOptions {
  // Accept absolute paths and paths that leave the folder of the sequence file. Off by default: a sequence from
  // elsewhere could otherwise name any file of the machines that read it. Symbolic links are followed (and judged) by
  // the reader of the pictures, not here: the two may run on different machines.
  bool allow_outside = false;
};

// Reads a sequence file (design section 2) strictly: what is not understood is an error, never skipped in silence,
// except keys that begin with "x-". No picture is opened. Paths of the result are absolute and lexically normal.
//
// A `groundTruth` whose wording is not understood only adds to `warnings`: it matters to evaluation, not to estimation.
// An absent `name` becomes the name of the file's folder.
// Errors  kInvalidArgument naming file, camera, key or frame, the value found and what was expected; also for a file
// that
//         is missing or unreadable, since the user named it.
[[nodiscard]] Result<Sequence> ReadSequence(const std::string& file, const ReadSequenceOptions& options = {});

// The same of the text of such a file; `file`, its absolute path, is not opened.
[[nodiscard]] Result<Sequence> ParseSequence(std::string_view text, const std::string& file,
                                             const ReadSequenceOptions& options = {});

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_READ_SEQUENCE_H_
