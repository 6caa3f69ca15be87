#ifndef DEPTHFARM_WORKER_RENDERING_SEQUENCE_WITH_DEPTH_H_
#define DEPTHFARM_WORKER_RENDERING_SEQUENCE_WITH_DEPTH_H_

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/depth_levels.h"
#include "common/image/picture.h"
#include "common/media/ground_truth.h"
#include "common/sequence/depth_manifest.h"
#include "common/sequence/sequence.h"
#include "common/video_input/video_readers.h"

namespace depthfarm {

// A sequence and depth of some of its cameras, at the size of the depth.
struct SequenceWithDepth {
  // One camera of the sequence.
  struct View {
    Camera camera;                                // as downscaled
    const SequenceCamera* in_sequence = nullptr;  // never null
    const DepthManifestCamera* depth = nullptr;   // null = no depth
    const GroundTruthView* truth = nullptr;       // null = no exact depth
  };

  std::string depth_dir;
  Sequence sequence;
  DepthManifest manifest;
  int downscale = 1;
  int first_frame = 0;  // frames with depth, positions in the sequence
  int end_frame = 0;
  std::vector<View> views;                                                  // as in the sequence
  std::optional<DepthLevels> levels;                                        // always set
  std::unique_ptr<VideoReaders> videos = std::make_unique<VideoReaders>();  // of its cameras, that stay open
  std::vector<int> nearest;  // per view: the nearest other view, where errors in px are seen; -1 = none

  SequenceWithDepth() = default;
  SequenceWithDepth(const SequenceWithDepth&) = delete;  // `views` point into it
  SequenceWithDepth& operator=(const SequenceWithDepth&) = delete;
};

// Fills `input` from the files. kInvalidArgument: what can't be read, cameras of depth.json that the sequence doesn't
// have or has with another calibration, sizes that no downscaling by 1, 2 or 4 gives, no depth range.
[[nodiscard]] Status ReadSequenceWithDepth(const std::string& sequence_file, const std::string& depth_dir,
                                           SequenceWithDepth& input);

// Index into `views`; kInvalidArgument names the cameras there are.
[[nodiscard]] Result<int> FindView(const SequenceWithDepth& input, const std::string& name);

// The two views with depth that `target` lies between (baselines more than 90 degrees apart), nearest first; else
// empty.
[[nodiscard]] std::vector<int> SidesOf(const SequenceWithDepth& input, int target);

// The views with depth that a target camera is best synthesised from, at most `count`: on either side of it where there
// are any, nearest first; the one that stands where the target does first of all. `except` (-1: none) is not
// considered. Empty if none sees what the target sees.
[[nodiscard]] std::vector<int> SourcesFor(const SequenceWithDepth& input, const Camera& target, int count, int except);

// A view's picture in a frame of the sequence, and its depth. kInvalidArgument: there is none, or it cannot be read.
[[nodiscard]] Result<YcbcrImage> ReadPictureOf(const SequenceWithDepth& input, int view, int frame);
[[nodiscard]] Result<DepthMap> ReadDepthOf(const SequenceWithDepth& input, int view, int frame);
// The confidence of that depth, probability times 65535; nullopt where the folder has none.
[[nodiscard]] Result<std::optional<Grid<std::uint16_t>>> ReadConfidenceOf(const SequenceWithDepth& input, int view,
                                                                          int frame);

// Pictures and depth of one frame, each read when first asked for. Pointers stay valid as long as this lives.
class FrameWithDepth {
 public:
  FrameWithDepth(const SequenceWithDepth& input, int frame) : input_(input), frame_(frame) {}

  [[nodiscard]] int frame() const { return frame_; }
  [[nodiscard]] Result<const YcbcrImage*> Picture(int view);
  [[nodiscard]] Result<const DepthMap*> Depth(int view);
  // Null where the sequence has no exact depth of this view and frame. At the downscaled size.
  [[nodiscard]] Result<const GroundTruthFrame*> Truth(int view);

 private:
  const SequenceWithDepth& input_;
  int frame_;
  std::map<int, YcbcrImage> pictures_;
  std::map<int, DepthMap> depths_;
  std::map<int, GroundTruthFrame> truths_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_RENDERING_SEQUENCE_WITH_DEPTH_H_
