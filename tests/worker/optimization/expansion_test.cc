#include "worker/optimization/expansion.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/support/cut_oracle.h"
#include "tests/support/match_lists.h"
#include "tests/support/random_problem.h"

namespace depthfarm {
namespace {

using test::MakeRandomProblem;
using test::Random;
using test::RandomProblem;

// Whether ExpandNear lets the node move, from its definition.
bool IsNear(const LabellingProblem& problem, const std::vector<Level>& labels, NodeIndex node, std::size_t level,
            std::size_t band) {
  const auto in_band = [&](NodeIndex seed) {
    const int held = LevelIndex(problem, labels[seed]);
    return held >= 0 && std::abs(held - static_cast<int>(level)) <= static_cast<int>(band);
  };
  if (in_band(node)) return true;
  for (const SmoothnessLink& link : problem.smoothness) {
    if (problem.fixed[link.first] != 0 && problem.fixed[link.second] != 0) continue;
    if ((link.first == node && in_band(link.second)) || (link.second == node && in_band(link.first))) return true;
  }
  for (NodeIndex seed = 0; seed < problem.num_nodes; ++seed) {
    for (const MatchTable::Match& match : problem.matches.At(seed, level)) {
      if (match.target == node && in_band(seed)) return true;
    }
  }
  return false;
}

TEST(TotalEnergy, EqualsTheSumWrittenOutFromEquationOne) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const RandomProblem p = MakeRandomProblem(random, 12, 3, 5, 20);
    EXPECT_EQ(TotalEnergy(p.problem, p.labels), test::EnergyPlainly(p.problem, p.labels)) << "seed " << seed;
  }
}

TEST(TotalEnergy, AddsNothingForAPairOnDifferentLevels) {  // eq. (5), second case
  LabellingProblem problem;
  problem.num_nodes = 2;
  problem.levels = {0, 1};
  problem.matches_per_node = 1;
  problem.matches = test::TableOf({{1, 100}, {}, {1, 90}, {}}, 2, 2, 1);
  problem.fixed = {0, 0};
  EXPECT_EQ(TotalEnergy(problem, {0, 0}), -100 * 128);
  EXPECT_EQ(TotalEnergy(problem, {1, 1}), -90 * 128);
  EXPECT_EQ(TotalEnergy(problem, {0, 1}), 0);
  EXPECT_EQ(TotalEnergy(problem, {1, 0}), 0);
}

TEST(Expansion, MovesAreThoseOfTheOracleAndEnergyIsTracked) {
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    RandomProblem p =
        MakeRandomProblem(random, random.Int(3, 30), random.Int(2, 3), random.Int(2, 6), seed % 3 == 0 ? 30 : 0);
    std::vector<Level> labels = p.labels;
    Expansion expansion(p.problem, labels);
    for (int sweep = 0; sweep < 2; ++sweep) {
      for (std::size_t l = 0; l < p.problem.levels.size(); ++l) {
        const std::vector<Level> expected = test::ExpandPlainly(p.problem, labels, p.problem.levels[l]);
        const std::int64_t before = expansion.energy();
        const std::int64_t delta = expansion.Expand(l);
        ASSERT_EQ(labels, expected);
        ASSERT_LE(delta, 0);
        ASSERT_EQ(expansion.energy(), before + delta);
        ASSERT_EQ(expansion.energy(), test::EnergyPlainly(p.problem, labels));
      }
    }
  }
}

TEST(Expansion,
     FindsTheOptimumOfTwoLevels) {  // against brute force: with two levels one move from the other level is global
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    RandomProblem p = MakeRandomProblem(random, 6, 2, 2, 0);
    std::vector<Level> labels(p.problem.num_nodes, p.problem.levels[0]);
    Expansion expansion(p.problem, labels);
    expansion.Expand(1);
    std::int64_t best = 0;
    for (unsigned bits = 0; bits < (1U << p.problem.num_nodes); ++bits) {
      std::vector<Level> candidate;
      for (NodeIndex node = 0; node < p.problem.num_nodes; ++node)
        candidate.push_back(p.problem.levels[(bits >> node) & 1U]);
      best = std::min(best, test::EnergyPlainly(p.problem, candidate));
      if (bits == 0) best = test::EnergyPlainly(p.problem, candidate);
    }
    EXPECT_EQ(expansion.energy(), best) << "seed " << seed;
  }
}

TEST(Expansion, FixedNodesKeepTheirLabelButCountForOthers) {
  LabellingProblem problem;
  problem.num_nodes = 2;
  problem.levels = {0, 1};
  problem.matches_per_node = 1;
  problem.matches = test::TableOf({{}, {0, 10}, {}, {0, 10}}, 2, 2, 1);
  problem.fixed = {1, 0};
  std::vector<Level> labels = {1, 0};
  Expansion expansion(problem, labels);
  EXPECT_EQ(expansion.Expand(0), 0);
  EXPECT_LT(expansion.Expand(1), 0);  // node 1 earns its reward only on the fixed node's level
  EXPECT_EQ(labels, (std::vector<Level>{1, 1}));
}

// A move of few nodes is the move of a problem in which all others are fixed.
TEST(Expansion, NearMovesAreExactOnTheNodesThatMove) {
  int moved = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    RandomProblem p =
        MakeRandomProblem(random, random.Int(3, 30), random.Int(2, 3), random.Int(2, 6), seed % 3 == 0 ? 30 : 0);
    std::vector<Level> labels = p.labels;
    Expansion expansion(p.problem, labels);
    for (int sweep = 0; sweep < 3; ++sweep) {
      for (std::size_t l = 0; l < p.problem.levels.size(); ++l) {
        const auto band = static_cast<std::size_t>(random.Int(0, 2));
        LabellingProblem others_fixed = p.problem;
        for (NodeIndex node = 0; node < p.problem.num_nodes; ++node) {
          if (!IsNear(p.problem, labels, node, l, band)) others_fixed.fixed[node] = 1;
        }
        const std::vector<Level> expected = test::ExpandPlainly(others_fixed, labels, p.problem.levels[l]);
        const bool full = sweep == 1 && random.Chance(20);  // both kinds of moves may take turns
        const std::vector<Level> expected_full = test::ExpandPlainly(p.problem, labels, p.problem.levels[l]);
        const std::int64_t before = expansion.energy();
        const std::int64_t delta = full ? expansion.Expand(l) : expansion.ExpandNear(l, band);
        ASSERT_EQ(labels, full ? expected_full : expected);
        ASSERT_LE(delta, 0);
        ASSERT_EQ(expansion.energy(), before + delta);
        ASSERT_EQ(expansion.energy(), test::EnergyPlainly(p.problem, labels));
        moved += !full && delta < 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(moved, 100);
}

TEST(Expansion, MovesOfChosenNodesAreExactOnThem) {
  int moved = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    RandomProblem p =
        MakeRandomProblem(random, random.Int(3, 30), random.Int(2, 3), random.Int(2, 6), seed % 3 == 0 ? 30 : 0);
    std::vector<Level> labels = p.labels;
    Expansion expansion(p.problem, labels);
    for (std::size_t l = 0; l < p.problem.levels.size(); ++l) {
      LabellingProblem others_fixed = p.problem;
      others_fixed.fixed.assign(p.problem.num_nodes, 1);
      std::vector<NodeIndex> chosen;
      for (NodeIndex node = 0; node < p.problem.num_nodes; ++node) {
        if (random.Chance(50)) continue;
        chosen.push_back(node);  // fixed ones among them
        others_fixed.fixed[node] = p.problem.fixed[node];
      }
      const std::vector<Level> expected = test::ExpandPlainly(others_fixed, labels, p.problem.levels[l]);
      const std::int64_t before = expansion.energy();
      const std::int64_t delta = expansion.ExpandAmong(l, chosen);
      ASSERT_EQ(labels, expected);
      ASSERT_LE(delta, 0);
      ASSERT_EQ(expansion.energy(), before + delta);
      ASSERT_EQ(expansion.energy(), test::EnergyPlainly(p.problem, labels));
      moved += delta < 0 ? 1 : 0;
    }
  }
  EXPECT_GT(moved, 100);
}

TEST(WinnerTakesAll, TakesTheLargestSumAndTheFarthestOfEquals) {
  LabellingProblem problem;
  problem.num_nodes = 2;
  problem.levels = {3, 5};
  problem.matches_per_node = 2;
  problem.matches = test::TableOf({{1, 10}, {1, 20}, {0, 5}, {}, {1, 30}, {}, {0, 6}, {}}, 2, 2, 2);
  problem.fixed = {0, 0};
  std::vector<Level> labels = {5, 3};
  WinnerTakesAll(problem, labels);
  EXPECT_EQ(labels, (std::vector<Level>{3, 5}));
}

TEST(Expansion, MovesAreTheSameOnAnyNumberOfThreads) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    RandomProblem p =
        MakeRandomProblem(random, random.Int(3, 60), random.Int(2, 3), random.Int(2, 6), seed % 3 == 0 ? 30 : 0);
    const auto per_view = p.problem.num_nodes / 2;
    if (seed % 2 == 0) p.problem.view_begin = {0, per_view};
    for (const int threads : {2, 3, 5}) {
      std::vector<Level> plain = p.labels;
      std::vector<Level> labels = p.labels;
      Expansion alone(p.problem, plain);
      Expansion shared(p.problem, labels, threads);
      for (std::size_t l = 0; l < p.problem.levels.size(); ++l) {
        ASSERT_EQ(shared.Expand(l), alone.Expand(l)) << threads << " threads";
        ASSERT_EQ(labels, plain) << threads << " threads, level " << l;
      }
      for (const std::size_t band : {std::size_t{1}, std::size_t{0}}) {
        for (std::size_t l = p.problem.levels.size(); l-- > 0;) {
          ASSERT_EQ(shared.ExpandNear(l, band), alone.ExpandNear(l, band)) << threads << " threads";
          ASSERT_EQ(labels, plain) << threads << " threads, near level " << l;
        }
      }
      EXPECT_EQ(shared.energy(), alone.energy());
    }
  }
}

TEST(BandsOf, CutsEachViewIntoPiecesOfAboutOneSize) {
  LabellingProblem problem;
  problem.num_nodes = 7;
  problem.view_begin = {0, 4};
  EXPECT_EQ(BandsOf(problem, 2), (std::vector<std::uint16_t>{0, 0, 1, 1, 0, 0, 1}));
  EXPECT_EQ(BandsOf(problem, 1), std::vector<std::uint16_t>(7, 0));
  problem.view_begin = {};
  EXPECT_EQ(BandsOf(problem, 3), (std::vector<std::uint16_t>{0, 0, 0, 1, 1, 2, 2}));
}

}  // namespace
}  // namespace depthfarm
