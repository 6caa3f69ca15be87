#ifndef DEPTHFARM_COMMON_JOB_ESTIMATION_PARAMS_H_
#define DEPTHFARM_COMMON_JOB_ESTIMATION_PARAMS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/sequence/depth_format.h"

namespace depthfarm {

// Any change that can change a depth map raises this number: jobs pin it, artifacts are named by it.
inline constexpr std::uint32_t kAlgorithmVersion = 12;

// How depth levels are spread over the n tasks of a frame (paper IV-A, Fig. 2).
enum class Partition {
  kContiguous,   // Fig. 2a: blocks of neighbouring levels
  kInterleaved,  // Fig. 2b: level l belongs to block l mod n
};

// Who may move to a level when levels are expanded (paper IV-B).
enum class Search {
  kFull,    // every segment to every level, as the paper
  kSparse,  // from a good start, every segment to some levels, then each to those near its own and its neighbours'
};

// What P frames refer to beside the frame before (paper III-E: the I frame of their GOP).
enum class Anchor {
  kGop,     // each GOP begins with an I frame of its own
  kShared,  // the job's first frame is the I frame of every GOP; other GOPs begin with a P frame that refers to it
            // alone
};

inline constexpr int kMostCompared = 4;  // two left, two right on an arc

// What a user may set for a job; the defaults are the paper's numbers where the paper gives one. 0 = choose ("auto").
struct EstimationParams {
  int segments = 0;         // per view; 0: one per segment_pixels, less of large refined views (ResolveJob)
  int segment_pixels = 20;  // where segments is 0: pixels of one; 1..10000
  int levels = 0;           // L; 0: at most 250, see ResolveJob
  double z_near = 0;        // of the reference camera, the sequence's unit; 0: from the sequence
  double z_far = 0;
  double smoothing = 1.0;       // beta_0 of eq. (3) per 1/249 of the depth range, L1 in grey levels; 0..100
  int matching_window = 3;      // side of W in eq. (4), pixels, odd, 1..15
  double matching_offset = 30;  // K of eq. (5), grey levels summed over Y, Cb, Cr; > 0, <= 765
  int uniqueness = 75;  // a match counts by how much it beats this share of its epipolar line, %; 0: in full (5); 0..99
  double snic_compactness = 5;  // m of SNIC (paper IV-C), > 0
  int gop = 10;  // frames from one I frame to the next: 1 I + 9 P (paper V-A); 1: I frames only; 0: one I frame
  Anchor anchor = Anchor::kGop;
  int p_threshold = 3;   // T_P of III-E, grey levels
  int i_threshold = 1;   // T_I of III-E
  int level_blocks = 0;  // n of IV-A; 0: from the job alone, see ResolveJob
  Partition partition = Partition::kInterleaved;
  Search search = Search::kSparse;
  int max_sweeps = 1;       // sweeps over the levels of a block; 0: until no move lowers the energy. A second one finds
                            // what no view shows (docs/method.md, 4). kSparse has just one
  int neighbours = 2;       // views matched against each view; the paper's two
  int refine_rounds = 4;    // rounds that turn levels into slanted planes after the cut; 0: levels, as the paper
  int choice_rounds = 2;    // the last rounds, as many as there are: with agreement between views, and a choice of
                            // plane for each pixel at depth jumps
  int compared = 4;         // views that refinement compares each view with, 1..kMostCompared
  bool confidence = false;  // also write how likely the depth of each pixel is right
  double holes = 0;         // no depth where that is less likely than this; 0..1, less than 1; 0: depth everywhere
  DepthFormat output_format = DepthFormat::kPng16;  // of depth files
  // Folders that the submitter turns into files of the sequence (common/sequence/guides.h); jobs do not carry them.
  std::string prior;               // of prior depth; empty: none
  std::string mask;                // of foreground masks; "sequence": those that the sequence names; empty: none
  int downscale = 1;               // 1, 2 or 4
  std::vector<std::string> views;  // camera names; empty: every camera that has pictures
  int first_frame = 0;             // frames [first_frame, end_frame)
  int end_frame = -1;              // -1: to the end

  // Whether the confidence of the depth is asked for.
  [[nodiscard]] bool assesses() const { return confidence || holes > 0; }
  // kInvalidArgument names the option, its value and its bounds.
  [[nodiscard]] Status Validate() const;
  bool operator==(const EstimationParams&) const = default;
};

// "default"; "paper" (the published method: 250 levels, n = 1, no refinement); "best" (more choice of pixels: thin
// objects and edges, 30 % more CPU); "fast" (fewer and larger of everything, a quarter less): docs/results.md,
// Presets. kInvalidArgument lists the names.
[[nodiscard]] Result<EstimationParams> Preset(const std::string& name);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_JOB_ESTIMATION_PARAMS_H_
