#ifndef DEPTHFARM_WORKER_MEDIA_CLI_COLOUR_COMMAND_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_COLOUR_COMMAND_H_

#include <iosfwd>
#include <string>

#include "common/base/status.h"

namespace depthfarm {

struct ColourCommandOptions {
  std::string depth_dir;  // holds depth.json
  std::string output;     // made if missing
};

// Writes each depth map of `depth_dir` in colours to `output`/<camera>/<frame>.png, near red, far blue, no depth black,
// and `output`/contact.png, the first frame of every camera side by side. All maps share one range of depth, from the
// nearest zNear to the farthest zFar of the cameras, so that equal colours are equal depths. Says on `out` what was
// written. Errors  those of ReadDepthManifest, ReadDepthOf and of writing.
[[nodiscard]] Status RunColour(const ColourCommandOptions& options, std::ostream& out);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_COLOUR_COMMAND_H_
