#include "worker/optimization/level_search.h"

#include <gtest/gtest.h>

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

// The order that the header states, written out.
TEST(SearchSparsely, TriesLevelsInItsOrder) {
  struct Stride {
    int levels;
    std::size_t stride;
  };
  for (const Stride& expected :
       {Stride{2, 1}, Stride{32, 1}, Stride{33, 2}, Stride{50, 3}, Stride{64, 4}, Stride{150, 4}}) {
    SCOPED_TRACE(expected.levels);
    Random random(static_cast<std::uint64_t>(expected.levels));
    const RandomProblem p = MakeRandomProblem(random, 40, 3, expected.levels, 10);
    std::vector<Level> plain = p.labels;
    Expansion expansion(p.problem, plain);
    const std::size_t levels = p.problem.levels.size();
    std::int64_t moves = 0;
    for (std::size_t l = expected.stride / 2; l < levels; l += expected.stride)
      moves += expansion.Expand(l) < 0 ? 1 : 0;
    for (std::size_t l = levels; l-- > 0;) moves += expansion.ExpandNear(l, 3) < 0 ? 1 : 0;
    for (std::size_t l = 0; l < levels; ++l) moves += expansion.ExpandNear(l, 0) < 0 ? 1 : 0;
    std::vector<Level> labels = p.labels;
    const SearchSummary summary = SearchSparsely(p.problem, labels, {});
    EXPECT_EQ(labels, plain);
    EXPECT_EQ(summary.moves, moves);
    EXPECT_GT(moves, 0);
  }
}

TEST(SearchSparsely, NeverRaisesTheEnergyAndTracksIt) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Random random(seed);
    RandomProblem p = MakeRandomProblem(random, random.Int(3, 30), 3, random.Int(2, 20), seed % 3 == 0 ? 30 : 0);
    std::vector<Level> labels = p.labels;
    const SearchSummary summary = SearchSparsely(p.problem, labels, {});
    EXPECT_EQ(summary.energy, test::EnergyPlainly(p.problem, labels)) << "seed " << seed;
    EXPECT_LE(summary.energy, test::EnergyPlainly(p.problem, p.labels)) << "seed " << seed;
    for (NodeIndex node = 0; node < p.problem.num_nodes; ++node) {
      if (p.problem.fixed[node] != 0) {
        EXPECT_EQ(labels[node], p.labels[node]);
      }
    }
  }
}

TEST(SearchSparsely, IsCancelledByItsStopToken) {
  Random random(1);
  RandomProblem p = MakeRandomProblem(random, 10, 2, 4, 0);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_TRUE(SearchSparsely(p.problem, p.labels, stop.get_token()).cancelled);
}

}  // namespace
}  // namespace depthfarm
