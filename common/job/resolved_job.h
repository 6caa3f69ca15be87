#ifndef DEPTHFARM_COMMON_JOB_RESOLVED_JOB_H_
#define DEPTHFARM_COMMON_JOB_RESOLVED_JOB_H_

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"
#include "common/geometry/depth_levels.h"
#include "common/job/estimation_params.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// One view for which a job estimates depth.
struct JobView {
  Camera camera;         // of the depth map: downscaled as the job asks
  int source_width = 0;  // of the picture files, pixels
  int source_height = 0;
  PictureFormat format;
  PriorFormat prior;            // of its files of prior depth
  bool masked = false;          // it has foreground masks
  int segments = 0;             // requested; the seed grid comes as near as it can
  DepthRange own_range;         // zNear, zFar of its depth files, along its own axis
  std::vector<int> neighbours;  // indices into ResolvedJob::views, nearest first; D of eq. (1)
  std::vector<int> compared;    // the at most params.compared views that refinement compares it with, nearest first
};

// What the frames before have refined is where a P frame starts: it does the last rounds alone. With one round, views
// lose 0.1 dB.
inline constexpr int kRefineRoundsOfPFrames = 2;

// Of levels that nobody asks for: so few can as well be finer than refinement needs them; and never more.
inline constexpr int kFewAutoLevels = 25;
inline constexpr int kMostAutoLevels = 250;

// The sparse search is cheapest in one part, and is split for its memory alone: bytes of beliefs and matches of a part.
inline constexpr std::int64_t kMostBytesOfPart = 350'000'000;

// A job with nothing left open: every "auto" is a number, so that all tasks of the job, wherever they run, do the same.
// A function of the sequence and the parameters alone, never of the farm.
struct ResolvedJob {
  EstimationParams params;  // levels, z_near, z_far, level_blocks (of I frames) filled in
  Camera reference;         // the centre camera whose image plane the levels are parallel to
  std::vector<JobView> views;
  int num_frames = 0;      // frames of the job, 0 .. num_frames - 1; sequence frame = params.first_frame + frame
  int level_blocks_i = 1;  // n of IV-A for I frames
  int level_blocks_p = 1;  // n for P frames: few nodes are left, so fewer tasks pay

  [[nodiscard]] int num_views() const { return static_cast<int>(views.size()); }
  [[nodiscard]] int num_gops() const { return (num_frames + params.gop - 1) / params.gop; }
  [[nodiscard]] int GopOf(int frame) const { return frame / params.gop; }
  // The I frame that a frame refers to, or is.
  [[nodiscard]] int IFrameOf(int frame) const {
    return params.anchor == Anchor::kShared ? 0 : GopOf(frame) * params.gop;
  }
  [[nodiscard]] bool IsIFrame(int frame) const { return frame == IFrameOf(frame); }
  [[nodiscard]] bool HasPFrames() const { return num_frames > 1 && !IsIFrame(1); }
  // The other frame that a P frame refers to: the one before, of the first in a GOP the I frame.
  [[nodiscard]] int PreviousOf(int frame) const { return frame % params.gop == 0 ? IFrameOf(frame) : frame - 1; }
  [[nodiscard]] int NumBlocks(int frame) const { return IsIFrame(frame) ? level_blocks_i : level_blocks_p; }
  // Rounds of refinement, after round 0: this one to params.refine_rounds, of which there must be one.
  [[nodiscard]] int FirstRefineRound(int frame) const {
    return IsIFrame(frame) ? 1 : std::max(1, params.refine_rounds - kRefineRoundsOfPFrames + 1);
  }
  // The level planes (not of a rendering job); valid because ResolveJob checked the range.
  [[nodiscard]] DepthLevels Levels() const;
};

// The sparse search of a part of `num_blocks` tries each k-th of the part's levels first, then those around what it
// found: k as large as the levels that refinement needs (ResolveJob) are apart, in levels of the part, rounded down for
// n = 1, then up; 1 with the full search, without refinement or without any neighbours.
[[nodiscard]] int SearchStep(const ResolvedJob& job, int num_blocks);

// Of a rendering job: `num_parts` frames that need nothing but to be written.
[[nodiscard]] ResolvedJob PartsOnly(int num_parts);

// Chooses what the parameters leave open:
//   reference  the sequence's, else the centre camera of the views;
//   z range    the parameters', else the reference camera's own, else the sequence's;
//   segments   one per segment_pixels, 20, of a view (paper III-B: "segments of size of 20 samples or less"); with
//              refinement, of views larger than 1024x768 only as the root of the size: 63,850 at 1920x1080;
//   levels     at most 250, such that one is about a pixel at the median nearest neighbour and at most two at the
//              widest baseline used; without refinement, or with fewer than 25 levels, down to a quarter of that;
//   n          as many parts as keep the sparse search's memory near 350 MB each (I frames), and half as many for P
//              frames; with the full search 1 for small problems, else up to 8 (I frames; side by side) or 2 (P
//              frames).
// Errors (kInvalidArgument, naming camera and option): fewer than two views, unknown or picture-less view, a view that
// cannot see the levels, has no neighbour or is too small for refinement, no depth range, frames outside the sequence,
// more blocks than levels.
[[nodiscard]] Result<ResolvedJob> ResolveJob(const Sequence& sequence, const EstimationParams& params);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_JOB_RESOLVED_JOB_H_
