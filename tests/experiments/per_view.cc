#include "tests/experiments/per_view.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "common/image/depth_code.h"
#include "tests/experiments/anchored_problem.h"
#include "worker/cost/energy_units.h"
#include "worker/cost/matching.h"
#include "worker/estimation/estimation.h"
#include "worker/estimation/frame_problem.h"

namespace depthfarm {
namespace {

constexpr int kLevelsAtOnce = 16;  // neighbouring levels often match the same pixel: its window is compared once
constexpr std::size_t kMostReward = std::numeric_limits<std::uint16_t>::max();

}  // namespace

Result<std::vector<DepthMap>> PerViewOfFrame(const ResolvedJob& job, const std::vector<YcbcrImage>& pictures) {
  FrameAnalysis analysis;
  for (std::size_t v = 0; v < job.views.size(); ++v) {
    DEPTHFARM_ASSIGN_OR_RETURN(ViewAnalysis view,
                               AnalyseView(pictures[v], job.views[v].segments, job.params.snic_compactness));
    analysis.push_back(std::make_shared<const ViewAnalysis>(std::move(view)));
  }
  const FrameProblem frame(job, analysis);
  const int num_levels = job.params.levels;
  const auto slots = static_cast<std::size_t>(frame.matches_per_node());
  if (2 * slots * static_cast<std::size_t>(MatchOffsetSteps(job.params.matching_offset)) > kMostReward) {
    const auto most = kMostReward / (2 * slots * std::size_t{kMatchStepsPerGrey});
    return InvalidArgument("matching-offset is " + std::to_string(job.params.matching_offset) + ", expected at most " +
                           std::to_string(most) + " with " + std::to_string(slots) + " neighbours");
  }
  // Without links between them the views do not know of each other, so all are solved in one go.
  AnchoredProblem problem(frame.num_nodes(), num_levels);
  problem.smoothness() = frame.smoothness();
  for (int begin = 0; begin < num_levels; begin += kLevelsAtOnce) {
    std::vector<Level> levels;
    for (int level = begin; level < std::min(num_levels, begin + kLevelsAtOnce); ++level)
      levels.push_back(static_cast<Level>(level));
    const MatchTable matches = frame.MatchesOnLevels(levels, {});
    for (std::size_t level = 0; level < levels.size(); ++level) {
      for (NodeIndex node = 0; node < frame.num_nodes(); ++node) {
        int reward = 0;
        for (const MatchTable::Match& match : matches.At(node, level)) reward += 2 * match.reward;
        problem.SetReward(levels[level], node, static_cast<std::uint16_t>(reward));
      }
    }
  }
  const LabelField field =
      frame.FromNodes(problem.Solve(job.params.max_sweeps), std::vector<std::uint8_t>(frame.num_nodes(), 0));
  std::vector<DepthMap> depths;
  for (std::size_t v = 0; v < job.views.size(); ++v) {
    const DepthRange& range = job.views[v].own_range;
    DEPTHFARM_ASSIGN_OR_RETURN(const DepthCode code, DepthCode::Create(range.z_near, range.z_far));
    depths.push_back(
        DecodeDepth(DepthCodes(job, static_cast<int>(v), analysis[v]->segments.labels, field.views[v]), code));
  }
  return depths;
}

}  // namespace depthfarm
