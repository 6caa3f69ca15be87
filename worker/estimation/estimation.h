#ifndef DEPTHFARM_WORKER_ESTIMATION_ESTIMATION_H_
#define DEPTHFARM_WORKER_ESTIMATION_ESTIMATION_H_

#include <cstdint>
#include <memory>
#include <stop_token>
#include <vector>

#include "common/base/status.h"
#include "common/image/grid.h"
#include "common/job/resolved_job.h"
#include "worker/estimation/label_field.h"
#include "worker/segmentation/analysis.h"

namespace depthfarm {

class RewardFloors;

// The analyses of all views of a frame, in the job's order.
using FrameAnalysis = std::vector<std::shared_ptr<const ViewAnalysis>>;

// What a P frame refers to (III-E): the frame before it and the GOP's I frame (the same one for the first P frame).
struct TemporalReferences {
  FrameAnalysis previous_analysis;
  std::shared_ptr<const LabelField> previous_labels;
  FrameAnalysis i_analysis;
  std::shared_ptr<const LabelField> i_labels;
};

// What an estimation did, for status and logs.
struct EstimationStats {
  int sweeps = 0;
  // E of eq. (1) at the result, less what unchanged segments earn from each other; energy units (cost/energy_units.h).
  std::int64_t energy = 0;
  std::int64_t moves = 0;  // moves that lowered E
  int nodes = 0;           // segments that are not unchanged
  int segments = 0;        // of all views
};

// How an estimation runs; what it computes does not depend on it.
struct EstimationRun {
  std::stop_token stop = {};
  EstimationStats* stats = nullptr;                // filled where given
  std::shared_ptr<RewardFloors> floors = nullptr;  // what other parts of the frame have measured already (FloorMemory)
  int threads = 1;
};

// Part `index` (0 ... count - 1) of the `count` parts that the levels are split into.
struct LevelBlock {
  int count = 1;
  int index = 0;
};

// Estimates the labels of one frame over the levels of a block (III, IV-A): memory to memory. `references` is null for
// I frames. Unchanged segments keep the label of their reference whatever block it belongs to. Same inputs, same
// result, on any machine and any number of threads. Errors: kInvalidArgument when sizes do not fit the job; kCancelled.
[[nodiscard]] Result<LabelField> EstimateBlock(const ResolvedJob& job, const FrameAnalysis& analysis,
                                               const TemporalReferences* references, const LevelBlock& block,
                                               const EstimationRun& run = {});

// Joins two partial results of the same frame into one by a two-label cut (IV-A, Fig. 3). E of the result is at most
// the smaller of the two; ties keep the first. Errors as EstimateBlock, also where the two differ in what is unchanged.
[[nodiscard]] Result<LabelField> MergeLabels(const ResolvedJob& job, const FrameAnalysis& analysis,
                                             const LabelField& first, const LabelField& second,
                                             const EstimationRun& run = {});

// kInvalidArgument unless `analysis` has one analysis per view, of the view's size and with segments.
[[nodiscard]] Status CheckAnalysis(const ResolvedJob& job, const FrameAnalysis& analysis);
// kInvalidArgument unless `field` has one level below L per segment of each view.
[[nodiscard]] Status CheckLabels(const ResolvedJob& job, const FrameAnalysis& analysis, const LabelField& field);

// Per-pixel depth of one view from its labels: the label's plane intersected with each pixel's ray gives the view's own
// z. Result: H x W, 16-bit code of the depth files (design 2): 1 + round(65534 (1/z - 1/zFar) / (1/zNear - 1/zFar))
// with the view's own range, 0 where the ray does not meet the plane in front of the view.
// The parts must fit each other: CheckAnalysis, CheckLabels.
[[nodiscard]] Grid<std::uint16_t> DepthCodes(const ResolvedJob& job, int view_index,
                                             const Grid<SegmentIndex>& segment_labels, const ViewLabels& labels);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ESTIMATION_ESTIMATION_H_
