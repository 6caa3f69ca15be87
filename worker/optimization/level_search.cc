#include "worker/optimization/level_search.h"

#include <algorithm>
#include <cstddef>
#include <span>

#include "common/base/parallel.h"
#include "common/base/thread_budget.h"
#include "worker/optimization/expansion.h"

namespace depthfarm {
namespace {

// Of `threads` those that are idle and get enough nodes to be worth their start, often: to be ready for more costs time
// where they do not come.
int WorthStarting(const LabellingProblem& problem, int threads) {
  constexpr std::ptrdiff_t kNodesOfThread = 4096;
  const std::ptrdiff_t num_free = std::count(problem.fixed.begin(), problem.fixed.end(), 0);
  const std::ptrdiff_t most = ThreadBudget::IdleForThisThread(std::max(threads, 1) - 1) + 1;
  return static_cast<int>(std::clamp<std::ptrdiff_t>(num_free / kNodesOfThread, 1, most));
}

}  // namespace

SearchSummary SearchFully(const LabellingProblem& problem, std::vector<Level>& labels, int max_sweeps,
                          const std::stop_token& stop, int threads) {
  Expansion expansion(problem, labels, WorthStarting(problem, threads));
  SearchSummary summary;
  const std::size_t num_levels = problem.levels.size();
  std::vector<std::int64_t> tried_at(num_levels, -1);  // number of moves made when the level was last tried
  bool lowered = true;
  while (lowered && (max_sweeps == 0 || summary.sweeps < max_sweeps)) {
    lowered = false;
    for (std::size_t step = 0; step < num_levels; ++step) {
      if (stop.stop_requested()) {
        summary.cancelled = true;
        return summary;
      }
      const std::size_t level = summary.sweeps % 2 == 0 ? step : num_levels - 1 - step;
      if (tried_at[level] == summary.moves) continue;
      if (expansion.Expand(level) < 0) {
        ++summary.moves;
        lowered = true;
      }
      tried_at[level] = summary.moves;
    }
    ++summary.sweeps;
  }
  summary.energy = expansion.energy();
  return summary;
}

namespace {

void MoveNear(Expansion& expansion, std::size_t num_levels, std::size_t band, const std::stop_token& stop,
              SearchSummary& summary) {
  for (std::size_t step = 0; step < num_levels && !stop.stop_requested(); ++step) {
    summary.moves += expansion.ExpandNear(num_levels - 1 - step, band) < 0 ? 1 : 0;
  }
  for (std::size_t level = 0; level < num_levels && !stop.stop_requested(); ++level) {
    summary.moves += expansion.ExpandNear(level, 0) < 0 ? 1 : 0;
  }
}

void Conclude(const Expansion& expansion, const std::stop_token& stop, SearchSummary& summary) {
  summary.sweeps = 1;
  summary.energy = expansion.energy();
  summary.cancelled = stop.stop_requested();
}

// For each k-th level, from k / 2 on, the free nodes that believe it plausible or one of the k around it.
std::vector<std::vector<NodeIndex>> WhoBelieves(const LabellingProblem& problem, const LevelBeliefs& beliefs,
                                                std::size_t stride, int threads) {
  constexpr std::size_t kNodesAtOnce = 1U << 14U;  // of a thread
  const std::size_t num_levels = problem.levels.size();
  const std::int32_t most = beliefs.Scaled(kPlausible);
  using Believers = std::vector<std::vector<NodeIndex>>;
  Believers believers((num_levels + stride - 1 - stride / 2) / stride);
  std::vector<Believers> pieces((problem.num_nodes + kNodesAtOnce - 1) / kNodesAtOnce, believers);
  ParallelForPieces(problem.num_nodes, kNodesAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    Believers& of_piece = pieces[begin / kNodesAtOnce];
    for (auto node = static_cast<NodeIndex>(begin); node < end; ++node) {
      if (problem.fixed[node] != 0) continue;
      const std::span<const std::int16_t> costs = beliefs.Of(node);
      for (std::size_t i = 0; i < of_piece.size(); ++i) {
        const auto around = costs.subspan(i * stride, std::min(stride, num_levels - i * stride));
        if (*std::min_element(around.begin(), around.end()) <= most) of_piece[i].push_back(node);
      }
    }
  });
  for (const Believers& of_piece : pieces) {
    for (std::size_t i = 0; i < believers.size(); ++i)
      believers[i].insert(believers[i].end(), of_piece[i].begin(), of_piece[i].end());
  }
  return believers;
}

}  // namespace

SearchSummary SearchSparsely(const LabellingProblem& problem, LevelBeliefs beliefs, std::vector<Level>& labels,
                             const std::stop_token& stop, int threads) {
  constexpr std::size_t kFewLevels = 32;  // as cheap as it gets, and each far from the next
  constexpr std::size_t kFullLevels = 16;
  constexpr std::size_t kMostStride = 4;
  constexpr std::size_t kFullMoves = 4;  // each such of those levels is for everybody: beliefs may be wrong
  constexpr std::size_t kBand = 3;
  const std::size_t num_levels = problem.levels.size();
  const std::size_t stride =
      num_levels <= kFewLevels ? 1 : std::clamp<std::size_t>(num_levels / kFullLevels, 1, kMostStride);
  std::vector<std::vector<NodeIndex>> believers;
  const bool all = beliefs.empty() || num_levels <= kFewLevels;
  if (!all) believers = WhoBelieves(problem, beliefs, stride, threads);
  beliefs = {};  // their memory is as much as all matches take
  Expansion expansion(problem, labels, WorthStarting(problem, threads));
  SearchSummary summary;
  for (std::size_t i = 0; stride / 2 + i * stride < num_levels && !stop.stop_requested(); ++i) {
    const std::size_t level = stride / 2 + i * stride;
    summary.moves += (all || i % kFullMoves == kFullMoves / 2 ? expansion.Expand(level)
                                                              : expansion.ExpandAmong(level, believers[i])) < 0
                         ? 1
                         : 0;
  }
  MoveNear(expansion, num_levels, kBand, stop, summary);
  Conclude(expansion, stop, summary);
  return summary;
}

SearchSummary SearchNear(const LabellingProblem& problem, std::size_t band, std::vector<Level>& labels,
                         const std::stop_token& stop, int threads) {
  Expansion expansion(problem, labels, WorthStarting(problem, threads));
  SearchSummary summary;
  MoveNear(expansion, problem.levels.size(), band, stop, summary);
  Conclude(expansion, stop, summary);
  return summary;
}

}  // namespace depthfarm
