#include "worker/optimization/belief_start.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <span>

#include "tests/support/match_lists.h"
#include "tests/support/random_problem.h"

namespace depthfarm {
namespace {

using test::MakeRandomProblem;
using test::Random;
using test::RandomProblem;

std::vector<SegmentGrid> RandomGrids(Random& random, int nodes_per_view, int num_views, int columns) {
  std::vector<SegmentGrid> grids;
  for (int view = 0; view < num_views; ++view) {
    SegmentGrid grid{.first = static_cast<NodeIndex>(view * nodes_per_view),
                     .columns = columns,
                     .rows = nodes_per_view / columns,
                     .beta_right = {},
                     .beta_down = {}};
    for (int i = 0; i < nodes_per_view; ++i) {
      grid.beta_right.push_back(2 * random.Int(1, 5000));
      grid.beta_down.push_back(2 * random.Int(1, 5000));
    }
    grids.push_back(grid);
  }
  return grids;
}

// The definition in the header, node by node, in wide integers.
class Plain {
 public:
  Plain(const LabellingProblem& problem, const std::vector<SegmentGrid>& grids, const std::vector<Level>& labels)
      : problem_(problem), grids_(grids), labels_(labels) {}

  std::vector<Level> Best(int iterations) {
    for (int pass = 0; pass < iterations; ++pass) Pass(pass == 0);
    std::vector<Level> best = labels_;
    for (NodeIndex node = 0; node < problem_.num_nodes; ++node) {
      if (problem_.fixed[node] != 0) continue;
      const auto least = std::min_element(beliefs_[node].begin(), beliefs_[node].end());
      best[node] = problem_.levels[static_cast<std::size_t>(least - beliefs_[node].begin())];
    }
    return best;
  }

  // After Best.
  [[nodiscard]] const std::vector<long>& Beliefs(NodeIndex node) const { return beliefs_[node]; }

 private:
  using Costs = std::vector<long>;

  Costs Own(NodeIndex node, bool first) const {
    Costs own(problem_.levels.size(), 0);
    for (const MatchTable::Match& match : test::MatchesOf(problem_.matches, node)) {
      long reward = match.reward;
      if (problem_.fixed[match.target] != 0) {
        if (labels_[match.target] != problem_.levels[match.level]) reward = 0;
      } else if (!first) {
        reward = std::max(0L, reward - beliefs_[match.target][match.level]);
      }
      own[match.level] -= reward;
    }
    return own;
  }

  // The least cost of each level at `to` along the line that comes from `from`, and so on.
  Costs Path(const SegmentGrid& grid, int x, int y, int dx, int dy, bool first) const {
    const auto at = [&](int column, int row) {
      return grid.first + static_cast<NodeIndex>(row * grid.columns + column);
    };
    Costs path = Own(at(x, y), first);
    const int from_x = x - dx;
    const int from_y = y - dy;
    if (from_x < 0 || from_y < 0 || from_x >= grid.columns || from_y >= grid.rows) return path;
    const auto link = static_cast<std::size_t>(std::min(from_y, y)) * static_cast<std::size_t>(grid.columns) +
                      static_cast<std::size_t>(std::min(from_x, x));
    const long step = std::max(1, (dx != 0 ? grid.beta_right : grid.beta_down)[link] / kEnergyUnitsPerMatchStep);
    const NodeIndex before = at(from_x, from_y);
    Costs came(problem_.levels.size(), 0);
    for (std::size_t l = 0; l < came.size(); ++l) {
      const auto distance = [&](int level) { return step * std::abs(int{problem_.levels[l]} - level); };
      if (problem_.fixed[before] != 0) {
        came[l] = distance(labels_[before]);
      } else {
        const Costs costs = Path(grid, from_x, from_y, dx, dy, first);
        const long least = *std::min_element(costs.begin(), costs.end());
        came[l] = std::numeric_limits<long>::max();
        for (std::size_t k = 0; k < costs.size(); ++k)
          came[l] = std::min(came[l], costs[k] - least + distance(problem_.levels[k]));
      }
      path[l] += std::min(came[l], 4000L);
    }
    return path;
  }

  void Pass(bool first) {
    std::vector<Costs> next(problem_.num_nodes);
    for (const SegmentGrid& grid : grids_) {
      for (int y = 0; y < grid.rows; ++y) {
        for (int x = 0; x < grid.columns; ++x) {
          const NodeIndex node = grid.first + static_cast<NodeIndex>(y * grid.columns + x);
          Costs belief = Own(node, first);
          for (long& cost : belief) cost *= -3;
          for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
            const Costs path = Path(grid, x, y, dx, dy, first);
            for (std::size_t l = 0; l < path.size(); ++l) belief[l] += path[l];
          }
          const long least = *std::min_element(belief.begin(), belief.end());
          for (long& cost : belief) cost -= least;
          next[node] = belief;
        }
      }
    }
    beliefs_ = next;
  }

  const LabellingProblem& problem_;
  const std::vector<SegmentGrid>& grids_;
  const std::vector<Level>& labels_;
  std::vector<Costs> beliefs_;
};

TEST(BeliefStart, IsThatOfItsDefinition) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int columns = random.Int(1, 4);
    const int nodes = columns * random.Int(1, 4);
    const RandomProblem p = MakeRandomProblem(random, nodes, 2, random.Int(1, 6), seed % 2 == 0 ? 30 : 0);
    const std::vector<SegmentGrid> grids = RandomGrids(random, nodes, 2, columns);
    for (const int iterations : {1, 2, 3}) {
      std::vector<Level> labels = p.labels;
      const LevelBeliefs beliefs = BeliefStart(p.problem, grids, iterations, labels, {});
      Plain plain(p.problem, grids, p.labels);
      EXPECT_EQ(labels, plain.Best(iterations)) << iterations << " passes";
      for (NodeIndex node = 0; node < p.problem.num_nodes; ++node) {
        if (p.problem.fixed[node] != 0) continue;
        const std::span<const std::int16_t> costs = beliefs.Of(node);
        EXPECT_EQ(std::vector<long>(costs.begin(), costs.end()), plain.Beliefs(node));
      }
    }
  }
}

// K = 765 gives the largest rewards there are, here of 16 neighbours, and then links as strong with small rewards; what
// is certain lies as far as levels go.
TEST(BeliefStart, TheLargestRewardsAndDistancesFit) {
  for (const std::uint16_t reward : {std::uint16_t{6885}, std::uint16_t{60}}) {
    LabellingProblem problem;
    problem.num_nodes = 4;
    problem.levels = {0, 65533};
    problem.matches_per_node = 16;
    problem.fixed = {0, 0, 0, 1};
    MatchTableBuilder matches(16);
    for (NodeIndex node = 0; node < 4; ++node) {
      for (int slot = 0; slot < 16; ++slot) matches.Add(node == 1 ? 0 : 1, (node + 1) % 3, reward);
      matches.EndNode();
    }
    problem.matches = std::move(matches).Take();
    SegmentGrid grid{.first = 0, .columns = 4, .rows = 1, .beta_right = {}, .beta_down = {}};
    grid.beta_right.assign(4, 1 << 24);
    grid.beta_down.assign(4, 1 << 24);
    std::vector<Level> labels = {0, 0, 0, 65533};
    BeliefStart(problem, {grid}, 4, labels, {});
    EXPECT_EQ(labels, (std::vector<Level>{65533, 65533, 65533, 65533})) << reward;
  }
}

// Of beta in 16 bits nothing, or a negative number, would be left.
TEST(BeliefStart, AStrongLinkIsNeverAWeakOne) {
  for (const std::int32_t beta : {1 << 22, 1 << 23, 112050 * kEnergyUnitsPerMatchStep, 1 << 24}) {
    LabellingProblem problem;
    problem.num_nodes = 6;
    problem.levels = {0, 1, 2};
    problem.matches_per_node = 1;
    problem.fixed.assign(6, 0);
    MatchTableBuilder matches(1);
    for (NodeIndex node = 0; node < 6; ++node) {
      matches.Add(node == 3 ? 2 : 1, (node + 1) % 6, 270);
      matches.EndNode();
    }
    problem.matches = std::move(matches).Take();
    SegmentGrid grid{.first = 0, .columns = 6, .rows = 1, .beta_right = {}, .beta_down = {}};
    grid.beta_right.assign(6, beta);
    grid.beta_down.assign(6, beta);
    std::vector<Level> labels(6, 0);
    BeliefStart(problem, {grid}, 1, labels, {});
    EXPECT_EQ(labels, std::vector<Level>(6, 1)) << beta;
  }
}

TEST(BeliefStart, IsTheSameOnAnyNumberOfThreads) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    Random random(seed);
    const int columns = random.Int(20, 40);
    const int nodes = columns * random.Int(20, 40);
    const RandomProblem p = MakeRandomProblem(random, nodes, 2, random.Int(1, 6), seed % 2 == 0 ? 30 : 0);
    const std::vector<SegmentGrid> grids = RandomGrids(random, nodes, 2, columns);
    std::vector<Level> one = p.labels;
    BeliefStart(p.problem, grids, 2, one, {});
    for (const int threads : {2, 3, 5}) {
      std::vector<Level> labels = p.labels;
      BeliefStart(p.problem, grids, 2, labels, {}, threads);
      EXPECT_EQ(labels, one) << "seed " << seed << ", " << threads << " threads";
    }
  }
}

TEST(BeliefStart, LeavesLabelsAloneWhenCancelled) {
  Random random(1);
  const RandomProblem p = MakeRandomProblem(random, 4, 2, 3, 0);
  std::vector<Level> labels = p.labels;
  std::stop_source stop;
  stop.request_stop();
  EXPECT_TRUE(BeliefStart(p.problem, RandomGrids(random, 4, 2, 2), 2, labels, stop.get_token()).empty());
  EXPECT_EQ(labels, p.labels);
}

}  // namespace
}  // namespace depthfarm
