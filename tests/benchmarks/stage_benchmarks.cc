// The stages of the core, one task's worth of each, in the order of a frame's life.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/compression/zstd_frame.h"
#include "common/job/level_partition.h"
#include "tests/benchmarks/benchmarks.h"
#include "tests/support/cut_oracle.h"
#include "worker/estimation/estimation.h"
#include "worker/estimation/frame_problem.h"
#include "worker/estimation/reward_floors.h"
#include "worker/merging/fusion.h"
#include "worker/optimization/belief_start.h"
#include "worker/optimization/level_search.h"
#include "worker/refinement/refine.h"
#include "worker/segmentation/describe.h"
#include "worker/segmentation/label_codec.h"
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

// Means, centres and adjacency of segments that are known.
void MeasureDescription(benchmark::State& state, MeasuredFrames& frames) {
  const YcbcrImage& picture = frames.FirstPicture();
  const Grid<SegmentIndex> labels =
      SegmentSnic(picture, frames.workload().snic_segments, EstimationParams().snic_compactness).value();
  for ([[maybe_unused]] auto _ : state) benchmark::DoNotOptimize(DescribeSegments(labels, picture));
  state.counters["pixels"] = static_cast<double>(picture.size());
}

// The label map of an artifact, to compressed bytes or back.
void MeasureLabels(benchmark::State& state, MeasuredFrames& frames, bool encodes) {
  const Grid<SegmentIndex> labels =
      SegmentSnic(frames.FirstPicture(), frames.workload().snic_segments, EstimationParams().snic_compactness).value();
  std::string bytes;
  std::string frame;
  std::vector<std::size_t> cuts;
  const auto encode = [&] {
    bytes.clear();
    frame.clear();
    cuts.clear();
    AppendLabels(labels, bytes, cuts);
    AppendZstdFrame(bytes, frame, cuts);
  };
  encode();
  const auto decode = [&] {
    const std::string content = ReadZstdFrame(frame, bytes.size(), bytes.size()).value();
    return ReadLabels(content, labels.width(), labels.height(), static_cast<SegmentIndex>(labels.size())).value();
  };
  for ([[maybe_unused]] auto _ : state) {
    if (encodes) {
      encode();
    } else {
      benchmark::DoNotOptimize(decode());
    }
  }
  const auto pixels = static_cast<double>(labels.size());
  state.counters["bits_per_pixel"] = 8.0 * static_cast<double>(frame.size()) / pixels;
  state.counters["per_pixel"] =
      benchmark::Counter(pixels, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
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

constexpr int kSparse = 0;  // sweeps

// Labels from nothing: full sweeps from each node's best reward, or (kSparse) the default's search with its start.
void MeasureSearch(benchmark::State& state, const MeasuredFrame& frame, const MeasuredFrame::Block& block, int sweeps) {
  const std::vector<SegmentGrid> grids = FrameProblem(frame.job, frame.analysis).Grids();
  SearchSummary summary;
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    std::vector<Level> labels = block.start;
    state.ResumeTiming();
    if (sweeps == kSparse) {
      LevelBeliefs beliefs = BeliefStart(block.problem, grids, kBeliefPasses, labels, {});
      summary = SearchSparsely(block.problem, std::move(beliefs), labels, {});
    } else {
      summary = SearchFully(block.problem, labels, sweeps, {});
    }
  }
  state.counters["nodes"] = block.problem.num_nodes;
  state.counters["levels"] = static_cast<double>(block.problem.levels.size());
  state.counters["moves"] = static_cast<double>(summary.moves);
  state.counters["energy"] = static_cast<double>(summary.energy);
}

// One sweep over some levels of the paper's problem by moves that are written out term by term and cut by Boost.
void MeasureOracle(benchmark::State& state, const MeasuredFrame::Block& block, bool& failed) {
  std::vector<Level> labels;
  for ([[maybe_unused]] auto _ : state) {
    labels = block.start;
    for (const Level level : block.problem.levels) labels = test::ExpandPlainly(block.problem, labels, level);
  }
  std::vector<Level> ours = block.start;
  state.counters["energy"] = static_cast<double>(SearchFully(block.problem, ours, 1, {}).energy);
  if (ours != labels) {
    failed = true;
    state.SkipWithError("the labels of the core's sweep are others");
  }
}

std::vector<Level> EveryTwentyFifth(int num_levels) {
  std::vector<Level> levels;
  for (int level = 12; level < num_levels; level += 25) levels.push_back(static_cast<Level>(level));
  return levels;
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
        EstimateBlock(frame.job, frame.analysis, nullptr, {frame.num_blocks, map}, {.floors = floors}).value();
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

void RegisterStageBenchmarks(MeasuredFrames& frames, bool& failed) {
  const auto add = [&](const std::string& name, const std::function<void(benchmark::State&)>& measure) {
    benchmark::RegisterBenchmark(name.c_str(), measure)->Unit(benchmark::kMillisecond);
  };
  add("SegmentSnic", [&frames](benchmark::State& state) { MeasureSnic(state, frames); });
  add("DescribeSegments", [&frames](benchmark::State& state) { MeasureDescription(state, frames); });
  add("EncodeLabels", [&frames](benchmark::State& state) { MeasureLabels(state, frames, true); });
  add("DecodeLabels", [&frames](benchmark::State& state) { MeasureLabels(state, frames, false); });
  add("MatchesOnLevels/floors_unknown", [&frames](benchmark::State& state) { MeasureMatching(state, frames, false); });
  add("MatchesOnLevels/floors_known", [&frames](benchmark::State& state) { MeasureMatching(state, frames, true); });
  for (const int sweeps : {1, kSparse}) {
    const std::string name = sweeps == kSparse ? "SearchSparsely" : "SearchFully/sweeps:" + std::to_string(sweeps);
    add(name, [&frames, sweeps](benchmark::State& state) {
      const MeasuredFrame& frame = frames.WithSegments(0);
      MeasureSearch(state, frame, frame.FirstBlock(), sweeps);
    });
  }
  for (const int sweeps : {2, kSparse}) {
    const std::string name = sweeps == kSparse ? "SearchSparsely" : "SearchFully/sweeps:" + std::to_string(sweeps);
    add("PaperEnergy/" + name, [&frames, sweeps](benchmark::State& state) {
      const MeasuredFrame& frame = frames.OfPaper();
      MeasureSearch(state, frame, frame.BlockOf(frame.LevelsOfFirstBlock()), sweeps);
    });
  }
  add("PaperEnergy/some_levels/SearchFully/sweeps:1", [&frames](benchmark::State& state) {
    const MeasuredFrame& frame = frames.OfPaper();
    MeasureSearch(state, frame, frame.BlockOf(EveryTwentyFifth(frame.job.params.levels)), 1);
  });
  add("PaperEnergy/some_levels/oracle", [&frames, &failed](benchmark::State& state) {
    const MeasuredFrame& frame = frames.OfPaper();
    MeasureOracle(state, frame.BlockOf(EveryTwentyFifth(frame.job.params.levels)), failed);
  });
  add("Fuse", [&frames](benchmark::State& state) { MeasureFusion(state, frames); });
  const auto rounds = std::make_shared<RefinedRounds>(frames);
  for (const int round : {1, EstimationParams().refine_rounds}) {
    add("RefineView/round:" + std::to_string(round),
        [&frames, rounds, round](benchmark::State& state) { MeasureRefinement(state, frames, *rounds, round); });
  }
}

}  // namespace depthfarm::benchmarks
