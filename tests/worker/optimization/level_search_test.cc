#include "worker/optimization/level_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "tests/support/cut_oracle.h"
#include "tests/support/random_problem.h"
#include "worker/optimization/expansion.h"

namespace depthfarm {
namespace {

using test::MakeRandomProblem;
using test::Random;
using test::RandomProblem;

TEST(SearchFully, StopsWhereNoMoveLowersTheEnergy) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Random random(seed);
    RandomProblem p = MakeRandomProblem(random, 25, 3, 6, 10);
    std::vector<Level> labels = p.labels;
    WinnerTakesAll(p.problem, labels);
    const SearchSummary summary = SearchFully(p.problem, labels, 0, {});
    EXPECT_EQ(summary.energy, test::EnergyPlainly(p.problem, labels)) << "seed " << seed;
    for (const Level alpha : p.problem.levels) {
      EXPECT_EQ(test::EnergyPlainly(p.problem, test::ExpandPlainly(p.problem, labels, alpha)), summary.energy);
    }
  }
}

TEST(SearchFully, IsCancelledByItsStopToken) {
  Random random(1);
  RandomProblem p = MakeRandomProblem(random, 10, 2, 4, 0);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_TRUE(SearchFully(p.problem, p.labels, 0, stop.get_token()).cancelled);
}

// Each free node believes some levels plausible and others not.
LevelBeliefs RandomBeliefs(Random& random, const LabellingProblem& problem, int shift) {
  std::vector<std::uint32_t> row;
  std::uint32_t free = 0;
  for (const std::uint8_t fixed : problem.fixed) {
    row.push_back(free);
    free += fixed == 0 ? 1 : 0;
  }
  const std::size_t stride = problem.levels.size() + 3;
  auto costs = std::make_unique<std::int16_t[]>(free * stride);
  for (std::size_t i = 0; i < free * stride; ++i)
    costs[i] = static_cast<std::int16_t>(random.Int(0, 4 * kPlausible) >> shift);
  return {std::move(row), std::move(costs), problem.levels.size(), stride, shift};
}

void MoveNear(Expansion& expansion, std::size_t levels, std::size_t band, std::int64_t& moves) {
  for (std::size_t l = levels; l-- > 0;) moves += expansion.ExpandNear(l, band) < 0 ? 1 : 0;
  for (std::size_t l = 0; l < levels; ++l) moves += expansion.ExpandNear(l, 0) < 0 ? 1 : 0;
}

// The order that the header states, written out.
TEST(SearchSparsely, TriesLevelsInItsOrder) {
  struct Stride {
    int levels;
    std::size_t stride;
  };
  for (const Stride& expected :
       {Stride{1, 1}, Stride{2, 1}, Stride{32, 1}, Stride{33, 2}, Stride{50, 3}, Stride{64, 4}, Stride{150, 4}}) {
    for (const int shift : {-1, 0, 2}) {  // -1: nothing is believed
      SCOPED_TRACE(expected.levels);
      Random random(static_cast<std::uint64_t>(expected.levels));
      const RandomProblem p = MakeRandomProblem(random, 40, 3, expected.levels, 10);
      const auto believe = [&] {
        Random of_beliefs(static_cast<std::uint64_t>(shift + 1));
        return shift >= 0 ? RandomBeliefs(of_beliefs, p.problem, shift) : LevelBeliefs();
      };
      const LevelBeliefs beliefs = believe();
      std::vector<Level> plain = p.labels;
      Expansion expansion(p.problem, plain);
      const std::size_t levels = p.problem.levels.size();
      std::int64_t moves = 0;
      std::size_t movers = 0;
      std::size_t step = 0;
      for (std::size_t l = expected.stride / 2; l < levels; l += expected.stride, ++step) {
        const bool all = beliefs.empty() || expected.levels <= 32 || step % 4 == 2;
        std::vector<NodeIndex> nodes;
        for (NodeIndex node = 0; node < p.problem.num_nodes; ++node) {
          if (p.problem.fixed[node] != 0) continue;
          bool plausible = all;
          const std::size_t begin = l - expected.stride / 2;
          for (std::size_t k = begin; !plausible && k < std::min(begin + expected.stride, levels); ++k) {
            plausible = beliefs.Of(node)[k] <= (kPlausible >> shift);
          }
          if (plausible) nodes.push_back(node);
        }
        movers += nodes.size();
        moves += expansion.ExpandAmong(l, nodes) < 0 ? 1 : 0;
      }
      EXPECT_GT(movers, 0U);
      MoveNear(expansion, levels, 3, moves);
      std::vector<Level> labels = p.labels;
      const SearchSummary summary = SearchSparsely(p.problem, believe(), labels, {});
      EXPECT_EQ(labels, plain);
      EXPECT_EQ(summary.moves, moves);
      EXPECT_GT(moves, expected.levels > 1 ? 0 : -1);
      std::vector<Level> again = p.labels;
      (void)SearchSparsely(p.problem, believe(), again, {});
      EXPECT_EQ(again, labels);
    }
  }
}

TEST(SearchSparsely, NeverRaisesTheEnergyAndTracksIt) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    RandomProblem p = MakeRandomProblem(random, random.Int(3, 30), 3, random.Int(2, 20), seed % 3 == 0 ? 30 : 0);
    std::vector<Level> labels = p.labels;
    LevelBeliefs beliefs;
    if (seed % 2 == 0) beliefs = RandomBeliefs(random, p.problem, 0);
    const SearchSummary summary = SearchSparsely(p.problem, std::move(beliefs), labels, {});
    EXPECT_EQ(summary.energy, test::EnergyPlainly(p.problem, labels)) << "seed " << seed;
    EXPECT_LE(summary.energy, test::EnergyPlainly(p.problem, p.labels)) << "seed " << seed;
    for (NodeIndex node = 0; node < p.problem.num_nodes; ++node) {
      if (p.problem.fixed[node] != 0) {
        EXPECT_EQ(labels[node], p.labels[node]);
      }
    }
  }
}

TEST(SearchNear, TriesLevelsInItsOrderAndTracksTheEnergy) {
  for (const std::size_t band : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
    Random random(band);
    const RandomProblem p = MakeRandomProblem(random, 40, 3, 20, 10);
    std::vector<Level> plain = p.labels;
    Expansion expansion(p.problem, plain);
    std::int64_t moves = 0;
    MoveNear(expansion, p.problem.levels.size(), band, moves);
    std::vector<Level> labels = p.labels;
    const SearchSummary summary = SearchNear(p.problem, band, labels, {});
    EXPECT_EQ(labels, plain);
    EXPECT_EQ(summary.moves, moves);
    EXPECT_GT(moves, 0);
    EXPECT_EQ(summary.energy, test::EnergyPlainly(p.problem, labels));
    EXPECT_LT(summary.energy, test::EnergyPlainly(p.problem, p.labels));
  }
}

// Enough nodes for each thread to be worth its start.
TEST(SearchSparsely, FindsTheSameLabelsOnAnyNumberOfThreads) {
  LabellingProblem problem;
  problem.num_nodes = 24000;
  problem.levels = {0, 1, 2, 3, 4};
  problem.matches_per_node = 1;
  problem.fixed.assign(problem.num_nodes, 0);
  problem.view_begin = {0, 12000};
  Random random(7);
  std::vector<Level> start;
  MatchTableBuilder matches(1);
  for (NodeIndex node = 0; node < problem.num_nodes; ++node) {
    const NodeIndex other = (node + 12000 + static_cast<NodeIndex>(random.Int(0, 40))) % problem.num_nodes;
    for (const std::size_t level : {1, 3}) matches.Add(level, other, static_cast<std::uint16_t>(random.Int(0, 270)));
    matches.EndNode();
    for (const NodeIndex step : {1U, 100U}) {
      if (node % 12000 + step < 12000) problem.smoothness.push_back({node, node + step, 2 * random.Int(1, 4000)});
    }
    start.push_back(static_cast<Level>(random.Int(0, 4)));
  }
  problem.matches = std::move(matches).Take();
  std::vector<Level> one = start;
  const SearchSummary summary = SearchSparsely(problem, {}, one, {});
  EXPECT_GT(summary.moves, 0);
  std::vector<Level> one_fully = start;
  const SearchSummary fully = SearchFully(problem, one_fully, 1, {});
  for (const int threads : {2, 3, 5}) {
    std::vector<Level> labels = start;
    EXPECT_EQ(SearchSparsely(problem, {}, labels, {}, threads).energy, summary.energy);
    EXPECT_EQ(labels, one) << threads << " threads";
    labels = start;
    EXPECT_EQ(SearchFully(problem, labels, 1, {}, threads).energy, fully.energy);
    EXPECT_EQ(labels, one_fully) << threads << " threads";
  }
}

TEST(SearchSparsely, IsCancelledByItsStopToken) {
  Random random(1);
  RandomProblem p = MakeRandomProblem(random, 10, 2, 4, 0);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_TRUE(SearchSparsely(p.problem, {}, p.labels, stop.get_token()).cancelled);
}

}  // namespace
}  // namespace depthfarm
