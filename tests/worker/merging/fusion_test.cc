#include "worker/merging/fusion.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/random.h"

namespace depthfarm {
namespace {

using test::Random;

struct RandomMaps {
  std::vector<SmoothnessLink> smoothness;
  FusionProblem problem;
};

// Two views; levels of the first map below those of the second (contiguous blocks), or drawn from odd and even levels.
void MakeRandomMaps(Random& random, int nodes_per_view, bool interleaved, RandomMaps& maps) {
  const int num_nodes = 2 * nodes_per_view;
  FusionProblem& problem = maps.problem;
  problem.num_nodes = static_cast<NodeIndex>(num_nodes);
  problem.matches_per_node = 1;
  std::vector<bool> is_unchanged;
  for (int node = 0; node < num_nodes; ++node) {
    const bool unchanged = random.Chance(10);
    is_unchanged.push_back(unchanged);
    const int kept = random.Int(0, 19);
    for (const int map : {0, 1}) {
      const int level = interleaved ? 2 * random.Int(0, 9) + map : 10 * map + random.Int(0, 9);
      problem.labels[map].push_back(static_cast<Level>(unchanged ? kept : level));
    }
  }
  for (const int map : {0, 1}) {
    for (int node = 0; node < num_nodes; ++node) {
      const int other = node < nodes_per_view ? nodes_per_view : 0;
      const auto target = static_cast<NodeIndex>(other + random.Int(0, nodes_per_view - 1));
      problem.matches[map].push_back({target, static_cast<std::uint16_t>(random.Chance(30) ? 0 : random.Int(1, 270))});
      if (map == 1 && is_unchanged[static_cast<std::size_t>(node)])
        problem.matches[1].back() = problem.matches[0][static_cast<std::size_t>(node)];
      const bool both_change = !is_unchanged[static_cast<std::size_t>(node)] && !is_unchanged[target];
      if (both_change && random.Chance(60))
        problem.labels[map][target] = problem.labels[map][static_cast<std::size_t>(node)];
    }
  }
  for (int view = 0; view < 2; ++view) {
    for (int s = 0; s + 1 < nodes_per_view; ++s) {
      const auto first = static_cast<NodeIndex>(view * nodes_per_view + s);
      maps.smoothness.push_back({first, first + 1, 2 * random.Int(1, 3000)});
      if (s + 3 < nodes_per_view && random.Chance(50))
        maps.smoothness.push_back({first, first + 3, 2 * random.Int(1, 3000)});
    }
  }
  problem.smoothness = &maps.smoothness;
}

std::int64_t BruteForceOptimum(const FusionProblem& problem) {
  std::int64_t best = 0;
  for (unsigned bits = 0; bits < (1U << problem.num_nodes); ++bits) {
    std::vector<std::uint8_t> choice;
    for (NodeIndex node = 0; node < problem.num_nodes; ++node)
      choice.push_back(static_cast<std::uint8_t>((bits >> node) & 1U));
    const std::int64_t energy = FusionEnergy(problem, choice);
    best = bits == 0 ? energy : std::min(best, energy);
  }
  return best;
}

TEST(Fuse, IsExactForContiguousBlocksMergedWithTheirNeighbours) {
  for (std::uint64_t seed = 0; seed < 80; ++seed) {
    Random random(seed);
    RandomMaps maps;
    MakeRandomMaps(random, 6, false, maps);
    EXPECT_EQ(Fuse(maps.problem).energy, BruteForceOptimum(maps.problem)) << "seed " << seed;
  }
}

TEST(Fuse, NeverRaisesTheEnergyOfEitherMap) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    RandomMaps maps;
    MakeRandomMaps(random, random.Int(2, 40), true, maps);
    const FusionResult result = Fuse(maps.problem);
    EXPECT_LE(result.energy, std::min(result.first_energy, result.second_energy)) << "seed " << seed;
    EXPECT_EQ(result.energy, FusionEnergy(maps.problem, result.from_second));
  }
}

TEST(Fuse, TiesKeepTheFirstMap) {
  const std::vector<SmoothnessLink> smoothness = {{0, 1, 10}};
  FusionProblem problem;
  problem.num_nodes = 2;
  problem.matches_per_node = 1;
  problem.smoothness = &smoothness;
  problem.labels[0] = {3, 3};
  problem.labels[1] = {5, 5};
  problem.matches[0] = problem.matches[1] = {{1, 7}, {}};
  const FusionResult result = Fuse(problem);
  EXPECT_EQ(result.labels, problem.labels[0]);
  EXPECT_EQ(result.first_energy, result.second_energy);
}

TEST(Fuse, TakesFromEachMapWhatItMatchesBetter) {
  const std::vector<SmoothnessLink> smoothness;
  FusionProblem problem;
  problem.num_nodes = 4;  // 0, 1 in one view, 2, 3 in the other: pairs (0, 2) and (1, 3)
  problem.matches_per_node = 1;
  problem.smoothness = &smoothness;
  problem.labels[0] = {1, 1, 1, 1};
  problem.labels[1] = {8, 8, 8, 8};
  problem.matches[0] = {{2, 200}, {3, 50}, {0, 200}, {1, 50}};
  problem.matches[1] = {{2, 100}, {3, 90}, {0, 100}, {1, 90}};
  EXPECT_EQ(Fuse(problem).labels, (std::vector<Level>{1, 8, 1, 8}));
}

}  // namespace
}  // namespace depthfarm
