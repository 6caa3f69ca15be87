#ifndef DEPTHFARM_WORKER_MEDIA_CLI_SYNTHESIZE_COMMAND_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_SYNTHESIZE_COMMAND_H_

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// What `depthfarm synthesize` renders. Exactly one of view, camera_file and path is given.
struct SynthesizeCommandOptions {
  std::string sequence;     // sequence file the depth was estimated from
  std::string depth_dir;    // folder with depth.json
  std::string output;       // FILE.mp4, FILE.yuv, or a folder for PNG pictures
  std::string view;         // a camera of the sequence, made from others
  std::string camera_file;  // virtual cameras (ReadCameras)
  std::vector<std::string>
      path;       // cameras of the sequence, at least two: the virtual camera moves from one to the next
  int steps = 0;  // pictures of the path; 0: one per frame, 60 of a single frame
  std::vector<std::string> from;  // cameras to synthesise from; empty: chosen for each picture
  int sources = 2;                // how many are chosen, 1 .. 8
  int first_frame = -1;           // positions in the sequence; -1: of the first that has depth
  int end_frame = -1;             // one past the last; -1: to the end
  int frames_per_second = 25;     // of FILE.mp4
  int threads = 0;                // pictures made at once; 0: one per core
  std::function<bool()> interrupted = [] { return false; };  // asked between pictures
  std::ostream* progress = nullptr;                          // a terminal that shows how far it is
};

// Renders virtual views (SynthesizeView) of the frames that have depth:
//   view         that camera's picture in each frame, never from itself;
//   camera file  one camera: its picture in each frame; several: as a path;
//   path         picture i shows frame i (of those asked for; the last one stays) from the path's i-th camera.
// Real cameras that stand where a virtual one does serve as its source. Pictures have the size of the depth (view,
// path) or of the virtual camera.
//   folder      DIR/0000.png, 0001.png, ...: the position of the picture in what is rendered; view: the frame
//   FILE.yuv    planar 4:2:0, 8 bits, BT.601, 16-235, one picture after the other (all of one size)
//   FILE.mp4    the same as H.264, visually lossless (Mp4File)
// Every file is written under another name and renamed. Equal options give equal bytes whatever `threads` is.
// Errors  kInvalidArgument: options, files that do not fit together, a camera that no view with depth sees the scene
// of;
//         kUnavailable: pictures cannot be written; kCancelled: interrupted (complete PNG pictures stay).
[[nodiscard]] Status RunSynthesize(const SynthesizeCommandOptions& options, std::ostream& out);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_SYNTHESIZE_COMMAND_H_
