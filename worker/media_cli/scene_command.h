#ifndef DEPTHFARM_WORKER_MEDIA_CLI_SCENE_COMMAND_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_SCENE_COMMAND_H_

#include <cstdint>
#include <string>

#include "common/base/status.h"

namespace depthfarm {

// What `depthfarm scene` renders and where it puts it.
struct SceneCommandOptions {
  std::string kind = "arc";    // arc, line, grid, irregular or mixed (irregular, pictures of different sizes)
  std::string output;          // folder, made if missing
  int cameras = 8;             // 2..256
  int width = 640;             // pixels, 16..8192; mixed: of the largest pictures
  int height = 480;            // pixels, 16..8192
  int frames = 1;              // 1..100000
  std::uint64_t seed = 1;      // of layout, textures, noise and gains
  double noise = 1.5;          // standard deviation of the sensor noise, 8-bit units, 0..50
  double gain = 0.01;          // standard deviation of the cameras' gains, 0..0.2
  std::string format = "png";  // png, or one raw file per frame: yuv420p8, yuv420p10le (full range, BT.601)
};

// kInvalidArgument names the first option out of its bounds and the bounds.
[[nodiscard]] Status ValidateSceneOptions(const SceneCommandOptions& options);

// Renders a synthetic sequence with its true depth:
//   DIR/<camera>/<frame>.png or .yuv       pictures; frame in 4 digits or more, from 0000
//   DIR/truth/<camera>/<frame>.pfm         float32 z along the view's own axis
//   DIR/truth/<camera>/<frame>_zones.png   8-bit Zone values
//   DIR/sequence.json                      written last: a folder that has it is complete
// Each file is written under another name and renamed, so that none is ever seen half-written; an old sequence.json is
// removed first. Equal options give equal bytes.
// Errors: kInvalidArgument (options), kUnavailable (a file or folder that cannot be written, named).
[[nodiscard]] Status RunScene(const SceneCommandOptions& options);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_SCENE_COMMAND_H_
