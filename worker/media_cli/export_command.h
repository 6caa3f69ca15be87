#ifndef DEPTHFARM_WORKER_MEDIA_CLI_EXPORT_COMMAND_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_EXPORT_COMMAND_H_

#include <functional>
#include <iosfwd>
#include <string>

#include "common/base/status.h"

namespace depthfarm {

struct ExportCommandOptions {
  std::string format = {};                 // "pfm", "exr", "yuv", "ply"
  std::string depth_dir = {};              // holds depth.json
  std::string output = {};                 // folder, made if missing
  std::string sequence = {};               // ply: the sequence file that the depth was estimated from
  int first_frame = -1;                    // of the sequence; -1: the first with depth
  int end_frame = -1;                      // -1: the last and one
  int step = 1;                            // ply: every so many columns and rows
  double min_confidence = 0;               // ply: 0 to 1
  std::function<bool()> interrupted = {};  // asked between files
};

// Writes depth for other programs:
//   pfm  OUT/<camera>/<frame>.pfm, z along the camera's axis in the sequence's unit of length, 0: no depth
//   exr  the same as channel Z of OUT/<camera>/<frame>.exr
//   yuv  OUT/<camera>.yuv, all frames: planar 4:2:0, 16 bits, luma as in the PNG files, chroma 32768; and
//        OUT/cameras.json, each camera with its zNear and zFar
//   ply  OUT/<frame>.ply, the points of all cameras in the world with their colours, see PointCloud
// `out` is told what was written. Each file has its name when it is whole.
// Errors: those of ReadDepthManifest, ReadDepthOf, ReadSequenceWithDepth and of writing; kInvalidArgument: an unknown
// format, frames without depth, options that the format does not have, no confidence in the folder; kCancelled.
[[nodiscard]] Status RunExport(const ExportCommandOptions& options, std::ostream& out);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_EXPORT_COMMAND_H_
