#include "worker/optimization/level_search.h"

#include <algorithm>
#include <cstddef>

#include "worker/optimization/expansion.h"

namespace depthfarm {

SearchSummary SearchFully(const LabellingProblem& problem, std::vector<Level>& labels, int max_sweeps,
                          const std::stop_token& stop) {
  Expansion expansion(problem, labels);
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

SearchSummary SearchSparsely(const LabellingProblem& problem, std::vector<Level>& labels, const std::stop_token& stop) {
  constexpr std::size_t kFewLevels = 32;  // as cheap as it gets, and each far from the next
  constexpr std::size_t kFullLevels = 16;
  constexpr std::size_t kMostStride = 4;
  constexpr std::size_t kBand = 3;
  Expansion expansion(problem, labels);
  SearchSummary summary;
  const auto count = [&](std::int64_t delta) { summary.moves += delta < 0 ? 1 : 0; };
  const std::size_t num_levels = problem.levels.size();
  const std::size_t stride =
      num_levels <= kFewLevels ? 1 : std::clamp<std::size_t>(num_levels / kFullLevels, 1, kMostStride);
  for (std::size_t level = stride / 2; level < num_levels && !stop.stop_requested(); level += stride) {
    count(expansion.Expand(level));
  }
  for (std::size_t step = 0; step < num_levels && !stop.stop_requested(); ++step) {
    count(expansion.ExpandNear(num_levels - 1 - step, kBand));
  }
  for (std::size_t level = 0; level < num_levels && !stop.stop_requested(); ++level) {
    count(expansion.ExpandNear(level, 0));
  }
  summary.sweeps = 1;
  summary.energy = expansion.energy();
  summary.cancelled = stop.stop_requested();
  return summary;
}

}  // namespace depthfarm
