#include "tests/experiments/pixel_labelling.h"

#include <algorithm>
#include <cstdlib>

#include "worker/optimization/max_flow.h"

namespace depthfarm {
namespace {

std::int64_t Variation(const PixelLabelling& problem, Level a, Level b) {
  return std::int64_t{problem.step} * std::min(std::abs(int{a} - int{b}), problem.most_steps);
}

// Calls visit(p, q) for each pair of 4-neighbours.
template <typename Visit>
void ForEachPair(const PixelLabelling& problem, const Visit& visit) {
  const auto width = static_cast<MaxFlow::Node>(problem.width);
  MaxFlow::Node p = 0;
  for (int y = 0; y < problem.height; ++y) {
    for (int x = 0; x < problem.width; ++x, ++p) {
      if (x + 1 < problem.width) visit(p, p + 1);
      if (y + 1 < problem.height) visit(p, p + width);
    }
  }
}

// Moves of one level after another, x = 1 (source side) where a pixel takes alpha; see worker/optimization/expansion.h
// for the normal form of the pairs. Everything is counted twice, so that its halves are whole.
class PixelExpansion {
 public:
  PixelExpansion(const PixelLabelling& problem, std::vector<Level>& labels)
      : problem_(problem), labels_(labels), twice_(labels.size()) {}

  // Whether the move lowered E.
  bool Expand(Level alpha) {
    const auto pixels = static_cast<MaxFlow::Node>(labels_.size());
    flow_.Reset(pixels);
    const std::uint16_t* at_alpha = problem_.CostsOf(alpha);
    for (MaxFlow::Node p = 0; p < pixels; ++p) {
      twice_[p] = 2 * (std::int64_t{at_alpha[p]} - problem_.CostsOf(labels_[p])[p]);
    }
    ForEachPair(problem_, [&](MaxFlow::Node p, MaxFlow::Node q) { AddPair(p, q, alpha); });

    // Least E - E(keep all) = (sum of the negative linear coefficients) + maximum flow, both twice.
    std::int64_t change = 0;
    for (MaxFlow::Node p = 0; p < pixels; ++p) {
      if (labels_[p] == alpha || twice_[p] == 0) continue;
      change += std::min<std::int64_t>(twice_[p], 0);
      flow_.AddTerminal(p, -twice_[p]);
    }
    if (change == 0 || change + flow_.Solve() == 0) return false;
    for (MaxFlow::Node p = 0; p < pixels; ++p) {
      if (flow_.InSourceSide(p)) labels_[p] = alpha;
    }
    return true;
  }

 private:
  void AddPair(MaxFlow::Node p, MaxFlow::Node q, Level alpha) {
    const Level at_p = labels_[p];
    const Level at_q = labels_[q];
    const std::int64_t keep = Variation(problem_, at_p, at_q);
    const std::int64_t only_p = Variation(problem_, alpha, at_q);
    const std::int64_t only_q = Variation(problem_, at_p, alpha);
    if (at_p == alpha || at_q == alpha) {  // that one is a constant
      twice_[p] += 2 * (only_p - keep);
      twice_[q] += 2 * (only_q - keep);
      return;
    }
    const std::int64_t twice_apart = only_p + only_q - keep;  // >= 0: V is a metric
    twice_[p] += 2 * (only_p - keep) - twice_apart;
    twice_[q] += 2 * (only_q - keep) - twice_apart;
    if (twice_apart != 0) flow_.AddEdge(p, q, static_cast<std::int32_t>(twice_apart));
  }

  const PixelLabelling& problem_;
  std::vector<Level>& labels_;
  std::vector<std::int64_t> twice_;  // linear coefficient of x per pixel in the current move
  MaxFlow flow_;
};

}  // namespace

std::int64_t TotalEnergy(const PixelLabelling& problem, const std::vector<Level>& labels) {
  std::int64_t energy = 0;
  for (std::size_t p = 0; p < labels.size(); ++p) energy += problem.CostsOf(labels[p])[p];
  ForEachPair(problem, [&](MaxFlow::Node p, MaxFlow::Node q) { energy += Variation(problem, labels[p], labels[q]); });
  return energy;
}

std::vector<Level> CheapestLevels(const PixelLabelling& problem) {
  std::vector<Level> labels(problem.num_pixels(), 0);
  for (int level = 1; level < problem.num_levels; ++level) {
    const std::uint16_t* costs = problem.CostsOf(level);
    for (std::size_t p = 0; p < labels.size(); ++p) {
      if (costs[p] < problem.CostsOf(labels[p])[p]) labels[p] = static_cast<Level>(level);
    }
  }
  return labels;
}

std::int64_t ExpandPixels(const PixelLabelling& problem, int sweeps, std::vector<Level>& labels) {
  PixelExpansion expansion(problem, labels);
  std::vector<std::int64_t> tried_at(static_cast<std::size_t>(problem.num_levels), -1);
  std::int64_t moves = 0;  // that lowered E
  bool lowered = true;
  for (int sweep = 0; lowered && (sweeps == 0 || sweep < sweeps); ++sweep) {
    lowered = false;
    for (int step = 0; step < problem.num_levels; ++step) {
      const int level = sweep % 2 == 0 ? step : problem.num_levels - 1 - step;
      std::int64_t& tried = tried_at[static_cast<std::size_t>(level)];
      if (tried == moves) continue;  // nothing has changed since
      if (expansion.Expand(static_cast<Level>(level))) {
        ++moves;
        lowered = true;
      }
      tried = moves;
    }
  }
  return TotalEnergy(problem, labels);
}

}  // namespace depthfarm
