#include "tests/experiments/per_view.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>

#include "common/image/depth_code.h"
#include "tests/experiments/anchored_problem.h"
#include "worker/estimation/estimation.h"
#include "worker/estimation/frame_problem.h"

namespace depthfarm {

Result<std::vector<DepthMap>> PerViewOfFrame(const ResolvedJob& job, std::vector<YcbcrImage> pictures) {
  FrameAnalysis analysis;
  for (std::size_t v = 0; v < job.views.size(); ++v) {
    DEPTHFARM_ASSIGN_OR_RETURN(ViewAnalysis view,
                               AnalyseView(std::move(pictures[v]), job.views[v].segments, job.params.snic_compactness));
    analysis.push_back(std::make_shared<const ViewAnalysis>(std::move(view)));
  }
  const FrameProblem frame(job, analysis);
  const int num_levels = job.params.levels;
  // Without links between them the views do not know of each other, so all are solved in one go.
  AnchoredProblem problem(frame.num_nodes(), num_levels);
  problem.smoothness() = frame.smoothness();
  const int slots = frame.matches_per_node();
  for (int level = 0; level < num_levels; ++level) {
    const std::vector<MatchLink> matches = frame.MatchesOnLevels({static_cast<Level>(level)}, {});
    for (NodeIndex node = 0; node < frame.num_nodes(); ++node) {
      int reward = 0;
      for (int slot = 0; slot < slots; ++slot) {
        reward +=
            2 *
            matches[static_cast<std::size_t>(node) * static_cast<std::size_t>(slots) + static_cast<std::size_t>(slot)]
                .reward;
      }
      problem.SetReward(level, node, static_cast<std::uint16_t>(std::min(reward, 0xFFFF)));
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
