#include "worker/estimation/estimation.h"

#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>

#include "common/job/level_partition.h"
#include "worker/estimation/frame_problem.h"
#include "worker/merging/fusion.h"
#include "worker/optimization/belief_start.h"
#include "worker/optimization/level_search.h"
#include "worker/temporal/unchanged.h"

namespace depthfarm {
namespace {

Status CheckReferences(const ResolvedJob& job, const TemporalReferences& references) {
  DEPTHFARM_RETURN_IF_ERROR(CheckAnalysis(job, references.previous_analysis).WithContext("previous frame"));
  DEPTHFARM_RETURN_IF_ERROR(CheckAnalysis(job, references.i_analysis).WithContext("I frame"));
  DEPTHFARM_RETURN_IF_ERROR(
      CheckLabels(job, references.previous_analysis, *references.previous_labels).WithContext("previous frame"));
  return CheckLabels(job, references.i_analysis, *references.i_labels).WithContext("I frame");
}

// Marks the unchanged segments of a P frame and gives them their adopted depth (III-E).
void AdoptDepth(const ResolvedJob& job, const FrameAnalysis& analysis, const TemporalReferences& references,
                const FrameProblem& frame, std::vector<Level>& labels, std::vector<std::uint8_t>& fixed) {
  for (int view_index = 0; view_index < job.num_views(); ++view_index) {
    const auto v = static_cast<std::size_t>(view_index);
    const std::vector<AdoptedSegment> adopted =
        FindUnchanged(analysis[v]->segments, references.previous_analysis[v]->segments,
                      references.i_analysis[v]->segments, job.params.p_threshold, job.params.i_threshold);
    for (std::size_t s = 0; s < adopted.size(); ++s) {
      if (adopted[s].source == DepthSource::kEstimated) continue;
      const LabelField& from =
          adopted[s].source == DepthSource::kIFrame ? *references.i_labels : *references.previous_labels;
      const std::size_t node = frame.offset(view_index) + s;
      labels[node] = from.views[v].levels[adopted[s].collocated];
      fixed[node] = 1;
    }
  }
}

// The lower of two that are as near. levels: ascending, not empty.
Level NearestLevel(const std::vector<Level>& levels, Level level) {
  const auto above = std::lower_bound(levels.begin(), levels.end(), level);
  if (above == levels.begin()) return *above;
  if (above == levels.end()) return levels.back();
  return level - *(above - 1) <= *above - level ? *(above - 1) : *above;
}

// From nothing to labels, as the job says.
SearchSummary SearchLevels(const EstimationParams& params, const FrameProblem& frame, LabellingProblem& problem,
                           std::vector<Level>& labels, const std::stop_token& stop, int threads) {
  problem.matches = frame.MatchesOnLevels(problem.levels, problem.fixed, labels, stop, threads);
  if (stop.stop_requested()) return {.cancelled = true};
  if (params.search == Search::kFull) {
    WinnerTakesAll(problem, labels);
    return SearchFully(problem, labels, params.max_sweeps, stop, threads);
  }
  LevelBeliefs beliefs = BeliefStart(problem, frame.Grids(), kBeliefPasses, labels, stop, threads);
  return SearchSparsely(problem, std::move(beliefs), labels, stop, threads);
}

// Each step-th of the problem's levels by the sparse search, in which unchanged segments count as on the nearest of
// these; then those around what is found. Levels less than a pixel apart share most of their matches, and have few
// that others would not lead to.
SearchSummary SearchInSteps(const EstimationParams& params, const FrameProblem& frame, LabellingProblem& problem,
                            std::size_t step, std::vector<Level>& labels, const std::stop_token& stop, int threads) {
  const std::vector<Level> all = std::exchange(problem.levels, {});
  for (std::size_t level = step / 2; level < all.size(); level += step) problem.levels.push_back(all[level]);
  const std::vector<Level> given = labels;
  for (std::size_t node = 0; node < labels.size(); ++node) {
    labels[node] = problem.fixed[node] != 0 ? NearestLevel(problem.levels, given[node]) : problem.levels.front();
  }
  SearchSummary summary = SearchLevels(params, frame, problem, labels, stop, threads);
  if (summary.cancelled) return summary;
  for (std::size_t node = 0; node < labels.size(); ++node) {
    if (problem.fixed[node] != 0) labels[node] = given[node];
  }
  problem.levels = all;
  problem.matches = {};
  problem.matches = frame.MatchesNear(problem.levels, step + 1, problem.fixed, labels, stop, threads);
  if (stop.stop_requested()) return {.cancelled = true};
  const std::int64_t moves = summary.moves;
  // Those levels are `step` apart, so what is nearest to the best of all is at most half of that away.
  summary = SearchNear(problem, step / 2, labels, stop, threads);
  summary.moves += moves;
  return summary;
}

}  // namespace

Result<LabelField> EstimateBlock(const ResolvedJob& job, const FrameAnalysis& analysis,
                                 const TemporalReferences* references, const LevelBlock& block,
                                 const EstimationRun& run) {
  if (block.count < 1 || block.count > job.params.levels || block.index < 0 || block.index >= block.count) {
    return InvalidArgument("block " + std::to_string(block.index) + " of " + std::to_string(block.count) + " of " +
                           std::to_string(job.params.levels) + " levels is asked for");
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckAnalysis(job, analysis));
  if (references != nullptr) DEPTHFARM_RETURN_IF_ERROR(CheckReferences(job, *references));

  const FrameProblem frame(job, analysis, run.floors);
  LabellingProblem problem;
  problem.num_nodes = frame.num_nodes();
  problem.levels = LevelsOfBlock(job.params.levels, block.count, job.params.partition, block.index);
  problem.matches_per_node = frame.matches_per_node();
  problem.smoothness = frame.smoothness();
  problem.fixed.assign(frame.num_nodes(), 0);
  problem.view_begin = frame.FirstNodes();
  std::vector<Level> labels(frame.num_nodes(), problem.levels.front());
  if (references != nullptr) AdoptDepth(job, analysis, *references, frame, labels, problem.fixed);
  const auto step = static_cast<std::size_t>(SearchStep(job, block.count));
  const SearchSummary summary = step > 1 && problem.levels.size() > step
                                    ? SearchInSteps(job.params, frame, problem, step, labels, run.stop, run.threads)
                                    : SearchLevels(job.params, frame, problem, labels, run.stop, run.threads);
  if (summary.cancelled) return Cancelled();
  if (run.stats != nullptr) {
    run.stats->sweeps = summary.sweeps;
    run.stats->moves = summary.moves;
    run.stats->energy = summary.energy;
    run.stats->segments = static_cast<int>(frame.num_nodes());
    for (const std::uint8_t fixed : problem.fixed) run.stats->nodes += fixed == 0 ? 1 : 0;
  }
  return frame.FromNodes(labels, problem.fixed);
}

Result<LabelField> MergeLabels(const ResolvedJob& job, const FrameAnalysis& analysis, const LabelField& first,
                               const LabelField& second, const EstimationRun& run) {
  DEPTHFARM_RETURN_IF_ERROR(CheckAnalysis(job, analysis));
  DEPTHFARM_RETURN_IF_ERROR(CheckLabels(job, analysis, first));
  DEPTHFARM_RETURN_IF_ERROR(CheckLabels(job, analysis, second));
  for (std::size_t v = 0; v < first.views.size(); ++v) {
    if (first.views[v].unchanged != second.views[v].unchanged) {
      return InvalidArgument("camera '" + job.views[v].camera.name +
                             "': the parts to merge differ in which segments are unchanged");
    }
  }
  std::vector<std::uint8_t> unchanged;
  for (const ViewLabels& view : first.views)
    unchanged.insert(unchanged.end(), view.unchanged.begin(), view.unchanged.end());

  const FrameProblem frame(job, analysis, run.floors);
  FusionProblem problem;
  problem.num_nodes = frame.num_nodes();
  problem.matches_per_node = frame.matches_per_node();
  problem.smoothness = &frame.smoothness();
  problem.labels[0] = frame.ToNodes(first);
  problem.labels[1] = frame.ToNodes(second);
  for (const int map : {0, 1}) problem.matches[map] = frame.MatchesOnOwnLevels(problem.labels[map], unchanged);
  if (run.stop.stop_requested()) return Cancelled();
  const FusionResult fused = Fuse(problem);
  if (run.stats != nullptr) {
    run.stats->energy = fused.energy;
    run.stats->segments = static_cast<int>(frame.num_nodes());
    run.stats->nodes = static_cast<int>(std::count(unchanged.begin(), unchanged.end(), 0));
  }
  return frame.FromNodes(fused.labels, unchanged);
}

}  // namespace depthfarm
