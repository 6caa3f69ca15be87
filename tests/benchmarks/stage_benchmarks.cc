// The stages of the core, one task's worth of each, in the order of a frame's life.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "common/job/level_partition.h"
#include "tests/benchmarks/benchmarks.h"
#include "worker/estimation/estimation.h"
#include "worker/estimation/frame_problem.h"
#include "worker/estimation/reward_floors.h"
#include "worker/merging/fusion.h"
#include "worker/optimization/belief_start.h"
#include "worker/optimization/level_search.h"
#include "worker/refinement/refine.h"
#include "worker/segmentation/snic.h"

namespace depthfarm::benchmarks {
namespace {

void MeasureSnic(benchmark::State& state, MeasuredFrames& frames) {
  const YcbcrImage& picture = frames.FirstPicture();
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(
        SegmentSnic(picture, frames.workload().snic_segments, EstimationParams().snic_compactness).value());
  }
  state.counters["segments"] = frames.workload().snic_segments;
  state.counters["pixels"] = static_cast<double>(picture.size());
}

// Entries of a matching volume that have a neighbour to match.
std::size_t NumEntries(const MeasuredFrame& frame, std::size_t num_levels) {
  std::size_t entries = 0;
  for (std::size_t v = 0; v < frame.job.views.size(); ++v) {
    entries += static_cast<std::size_t>(frame.analysis[v]->segments.num_segments()) *
               frame.job.views[v].neighbours.size() * num_levels;
  }
  return entries;
}

// The first part of a frame measures the floors of its matches, the others find them.
void MeasureMatching(benchmark::State& state, MeasuredFrames& frames, bool floors_known) {
  const MeasuredFrame& frame = frames.WithSegments(0);
  const std::vector<Level> levels =
      LevelsOfBlock(frame.job.params.levels, frame.num_blocks, frame.job.params.partition, 0);
  auto floors = std::make_shared<RewardFloors>();
  if (floors_known) {
    benchmark::DoNotOptimize(FrameProblem(frame.job, frame.analysis, floors).MatchesOnLevels(levels, {}));
  }
  NodeIndex num_nodes = 0;
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    if (!floors_known) floors = std::make_shared<RewardFloors>();
    const FrameProblem problem(frame.job, frame.analysis, floors);
    state.ResumeTiming();
    benchmark::DoNotOptimize(problem.MatchesOnLevels(levels, {}));
    num_nodes = problem.num_nodes();
  }
  const auto entries = static_cast<double>(NumEntries(frame, levels.size()));
  state.counters["nodes"] = num_nodes;
  state.counters["levels"] = static_cast<double>(levels.size());
  state.counters["entries"] = entries;
  state.counters["per_entry"] =
      benchmark::Counter(entries, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

// Labels from nothing: one full sweep from each node's best reward, or the default's search with its start.
void MeasureSearch(benchmark::State& state, MeasuredFrames& frames, bool sparse) {
  const MeasuredFrame& frame = frames.WithSegments(0);
  const MeasuredFrame::Block block = frame.FirstBlock();
  const std::vector<SegmentGrid> grids = FrameProblem(frame.job, frame.analysis).Grids();
  SearchSummary summary;
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    std::vector<Level> labels = block.start;
    state.ResumeTiming();
    if (sparse) BeliefStart(block.problem, grids, kBeliefPasses, labels, {});
    summary = sparse ? SearchSparsely(block.problem, labels, {}) : SearchFully(block.problem, labels, 1, {});
  }
  state.counters["nodes"] = block.problem.num_nodes;
  state.counters["levels"] = static_cast<double>(block.problem.levels.size());
  state.counters["moves"] = static_cast<double>(summary.moves);
  state.counters["energy"] = static_cast<double>(summary.energy);
}

// Blocks 0 and 1 into one.
void MeasureFusion(benchmark::State& state, MeasuredFrames& frames) {
  const MeasuredFrame& frame = frames.WithSegments(0);
  const auto floors = std::make_shared<RewardFloors>();
  const FrameProblem numbers(frame.job, frame.analysis, floors);
  FusionProblem problem;
  problem.num_nodes = numbers.num_nodes();
  problem.matches_per_node = numbers.matches_per_node();
  problem.smoothness = &numbers.smoothness();
  for (const int map : {0, 1}) {
    const LabelField field =
        EstimateBlock(frame.job, frame.analysis, nullptr, frame.num_blocks, map, {}, nullptr, floors).value();
    problem.labels[map] = numbers.ToNodes(field);
    problem.matches[map] =
        numbers.MatchesOnOwnLevels(problem.labels[map], std::vector<std::uint8_t>(problem.num_nodes, 0));
  }
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(Fuse(problem));
  state.counters["nodes"] = problem.num_nodes;
  state.counters["links"] = static_cast<double>(problem.smoothness->size());
}

// A frame's views before each round of refinement; made when the first round is asked for.
class RefinedRounds {
 public:
  explicit RefinedRounds(MeasuredFrames& frames) : frames_(frames) {}

  [[nodiscard]] const FrameRefinement& Before(int round) {
    const MeasuredFrame& frame = frames_.WithSegments(0);
    if (before_.empty()) before_.push_back(Start(frame));
    while (static_cast<int>(before_.size()) < round) {
      const FrameRefinement& last = before_.back();
      const int next_round = static_cast<int>(before_.size());
      FrameRefinement next;
      for (int view = 0; view < frame.job.num_views(); ++view) {
        next.push_back(
            std::make_shared<const RefinedView>(RefineView(frame.job, view, next_round, frame.analysis, last).value()));
      }
      before_.push_back(std::move(next));
    }
    return before_[static_cast<std::size_t>(round - 1)];
  }

 private:
  [[nodiscard]] static FrameRefinement Start(const MeasuredFrame& frame) {
    const LabelField labels = test::EstimateFrame(frame.job, frame.analysis, nullptr, frame.num_blocks);
    FrameRefinement start;
    for (int view = 0; view < frame.job.num_views(); ++view) {
      const auto v = static_cast<std::size_t>(view);
      start.push_back(std::make_shared<const RefinedView>(
          StartRefinement(frame.job, view, *frame.analysis[v], labels.views[v], nullptr).value()));
    }
    return start;
  }

  MeasuredFrames& frames_;
  std::vector<FrameRefinement> before_;  // [round - 1]
};

// The view in the middle, which is compared with most others.
void MeasureRefinement(benchmark::State& state, MeasuredFrames& frames, RefinedRounds& rounds, int round) {
  const MeasuredFrame& frame = frames.WithSegments(0);
  const int view = frame.job.num_views() / 2;
  const FrameRefinement& before = rounds.Before(round);
  for ([[maybe_unused]] auto _ : state) {
    benchmark::DoNotOptimize(RefineView(frame.job, view, round, frame.analysis, before).value());
  }
  const auto v = static_cast<std::size_t>(view);
  state.counters["segments"] = static_cast<double>(frame.analysis[v]->segments.num_segments());
  state.counters["compared"] = static_cast<double>(frame.job.views[v].compared.size());
}

}  // namespace

void RegisterStageBenchmarks(MeasuredFrames& frames) {
  const auto add = [&](const std::string& name, const std::function<void(benchmark::State&)>& measure) {
    benchmark::RegisterBenchmark(name.c_str(), measure)->Unit(benchmark::kMillisecond);
  };
  add("SegmentSnic", [&frames](benchmark::State& state) { MeasureSnic(state, frames); });
  add("MatchesOnLevels/floors_unknown", [&frames](benchmark::State& state) { MeasureMatching(state, frames, false); });
  add("MatchesOnLevels/floors_known", [&frames](benchmark::State& state) { MeasureMatching(state, frames, true); });
  add("SearchFully/one_sweep", [&frames](benchmark::State& state) { MeasureSearch(state, frames, false); });
  add("SearchSparsely", [&frames](benchmark::State& state) { MeasureSearch(state, frames, true); });
  add("Fuse", [&frames](benchmark::State& state) { MeasureFusion(state, frames); });
  const auto rounds = std::make_shared<RefinedRounds>(frames);
  for (const int round : {1, EstimationParams().refine_rounds}) {
    add("RefineView/round:" + std::to_string(round),
        [&frames, rounds, round](benchmark::State& state) { MeasureRefinement(state, frames, *rounds, round); });
  }
}

}  // namespace depthfarm::benchmarks
