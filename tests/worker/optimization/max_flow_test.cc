#include "worker/optimization/max_flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/cut_oracle.h"
#include "tests/support/random.h"

namespace depthfarm {
namespace {

using test::CutProblem;
using test::CutSolution;
using test::Random;

// A grid with random long links, as in expansion graphs: symmetric capacities, many of them saturated or zero.
CutProblem RandomCut(Random& random, int width, int height, int max_capacity) {
  CutProblem problem;
  const int nodes = width * height;
  for (int i = 0; i < nodes; ++i) {
    const int kind = random.Int(0, 2);
    problem.from_source.push_back(kind == 0 ? random.Int(0, max_capacity) : 0);
    problem.to_sink.push_back(kind == 1 ? random.Int(0, max_capacity) : 0);
  }
  const auto add = [&](int u, int v) {
    const int capacity = random.Int(0, max_capacity);
    problem.edges.push_back({u, v, capacity, capacity});
  };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      if (x + 1 < width) add(y * width + x, y * width + x + 1);
      if (y + 1 < height) add(y * width + x, y * width + x + width);
      if (random.Chance(30)) {
        const int other = random.Int(0, nodes - 1);
        if (other != y * width + x) add(y * width + x, other);
      }
    }
  }
  return problem;
}

void ExpectSameCut(const CutProblem& problem, MaxFlow& flow) {
  const CutSolution oracle = test::SolveCutPlainly(problem);
  flow.Reset(static_cast<MaxFlow::Node>(problem.from_source.size()));
  std::int64_t direct =
      0;  // what flows source -> node -> sink without an edge: the oracle counts it, a terminal sum does not
  for (std::size_t i = 0; i < problem.from_source.size(); ++i) {
    flow.AddTerminal(static_cast<MaxFlow::Node>(i), problem.from_source[i] - problem.to_sink[i]);
    direct += std::min(problem.from_source[i], problem.to_sink[i]);
  }
  for (const CutProblem::Edge& edge : problem.edges) {
    flow.AddEdge(static_cast<MaxFlow::Node>(edge.u), static_cast<MaxFlow::Node>(edge.v),
                 static_cast<std::int32_t>(edge.forth));
  }
  ASSERT_EQ(flow.Solve() + direct, oracle.flow);
  for (std::size_t i = 0; i < problem.from_source.size(); ++i) {
    ASSERT_EQ(flow.InSourceSide(static_cast<MaxFlow::Node>(i)), oracle.source_side[i]) << "node " << i;
  }
}

TEST(MaxFlow, FindsTheSmallestMinimumCutOfRandomGraphs) {
  MaxFlow flow;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    // Small capacities make many ties, where only the canonical cut is a function of the graph.
    const int max_capacity = seed % 3 == 0 ? 2 : (seed % 3 == 1 ? 20 : 1'000'000);
    ExpectSameCut(RandomCut(random, random.Int(1, 12), random.Int(1, 12), max_capacity), flow);
    if (HasFatalFailure()) return;
  }
}

TEST(MaxFlow, FindsTheSmallestMinimumCutOfLargeGraphs) {
  MaxFlow flow;
  for (std::uint64_t seed = 1000; seed < 1006; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    ExpectSameCut(RandomCut(random, 60, 50, seed % 2 == 0 ? 4 : 300), flow);
    if (HasFatalFailure()) return;
  }
}

TEST(MaxFlow, AgreesWithBruteForceOverAllCutsOfTinyGraphs) {
  MaxFlow flow;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const CutProblem problem = RandomCut(random, random.Int(1, 4), random.Int(1, 2), 3);
    const auto nodes = static_cast<unsigned>(problem.from_source.size());
    std::int64_t least = -1;
    unsigned smallest =
        0;  // minimum cuts are closed under intersection: the one with fewest nodes is the canonical one
    for (unsigned side = 0; side < (1U << nodes); ++side) {
      std::int64_t cost = 0;
      for (unsigned i = 0; i < nodes; ++i)
        cost += ((side >> i) & 1U) != 0 ? problem.to_sink[i] : problem.from_source[i];
      for (const CutProblem::Edge& edge : problem.edges) {
        if (((side >> edge.u) & 1U) != ((side >> edge.v) & 1U)) cost += edge.forth;
      }
      if (least < 0 || cost < least) {
        least = cost;
        smallest = side;
      } else if (cost == least) {
        smallest &= side;
      }
    }
    flow.Reset(nodes);
    for (unsigned i = 0; i < nodes; ++i) flow.AddTerminal(i, problem.from_source[i] - problem.to_sink[i]);
    for (const CutProblem::Edge& edge : problem.edges) {
      flow.AddEdge(static_cast<unsigned>(edge.u), static_cast<unsigned>(edge.v), static_cast<std::int32_t>(edge.forth));
    }
    ASSERT_EQ(flow.Solve(), least);
    for (unsigned i = 0; i < nodes; ++i) ASSERT_EQ(flow.InSourceSide(i), ((smallest >> i) & 1U) != 0) << "node " << i;
  }
}

TEST(MaxFlow, ANodeWithoutFlowStaysOnTheSinkSide) {
  MaxFlow flow;
  flow.Reset(3);
  flow.AddTerminal(0, 5);
  flow.AddTerminal(2, -5);
  flow.AddEdge(0, 1, 5);
  flow.AddEdge(1, 2, 5);
  EXPECT_EQ(flow.Solve(), 5);
  // All of 0, 1 saturate together: every cut along the path is minimal, the smallest source side is empty.
  EXPECT_FALSE(flow.InSourceSide(0));
  EXPECT_FALSE(flow.InSourceSide(1));
  EXPECT_FALSE(flow.InSourceSide(2));
}

TEST(MaxFlow, ResetForgetsTheProblemBefore) {
  MaxFlow flow;
  flow.Reset(2);
  flow.AddTerminal(0, 7);
  flow.AddTerminal(1, -7);
  flow.AddEdge(0, 1, 3);
  EXPECT_EQ(flow.Solve(), 3);
  flow.Reset(2);
  flow.AddTerminal(0, 7);
  flow.AddTerminal(1, -2);
  flow.AddEdge(0, 1, 3);
  EXPECT_EQ(flow.Solve(), 2);
  EXPECT_TRUE(flow.InSourceSide(0));
  EXPECT_TRUE(flow.InSourceSide(1));
}

// The same graph in parts of consecutive nodes, in ranges of parts on threads: their flows differ, the canonical cut
// does not.
TEST(MaxFlow, PartsOnAnyNumberOfThreadsFindTheSameCut) {
  MaxFlow whole;
  MaxFlow in_parts;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int max_capacity = seed % 3 == 0 ? 2 : (seed % 3 == 1 ? 20 : 1'000'000);
    const CutProblem problem = RandomCut(random, random.Int(2, 20), random.Int(2, 20), max_capacity);
    const auto nodes = static_cast<MaxFlow::Node>(problem.from_source.size());
    whole.Reset(nodes);
    const auto add_terminals = [&](MaxFlow& flow) {
      for (MaxFlow::Node i = 0; i < nodes; ++i) flow.AddTerminal(i, problem.from_source[i] - problem.to_sink[i]);
    };
    add_terminals(whole);
    for (const CutProblem::Edge& edge : problem.edges) {
      whole.AddEdge(static_cast<MaxFlow::Node>(edge.u), static_cast<MaxFlow::Node>(edge.v),
                    static_cast<std::int32_t>(edge.forth));
    }
    const std::int64_t expected = whole.Solve();
    for (const auto& [parts, threads] : {std::pair(2, 2), {3, 2}, {5, 5}, {9, 3}, {4, 1}, {1, 2}}) {
      SCOPED_TRACE(std::to_string(parts) + " parts, " + std::to_string(threads) + " threads");
      std::vector<MaxFlow::Node> bounds{0};  // ascending, some parts empty
      for (int i = 1; i < parts; ++i)
        bounds.push_back(
            static_cast<MaxFlow::Node>(random.Int(static_cast<int>(bounds.back()), static_cast<int>(nodes))));
      bounds.push_back(nodes);
      in_parts.Reset(bounds, threads);
      add_terminals(in_parts);
      for (const CutProblem::Edge& edge : problem.edges) {
        const auto u = static_cast<MaxFlow::Node>(edge.u);
        const auto part =
            static_cast<std::size_t>(std::upper_bound(bounds.begin(), bounds.end(), u) - bounds.begin() - 1);
        in_parts.AddEdge(part, u, static_cast<MaxFlow::Node>(edge.v), static_cast<std::int32_t>(edge.forth));
      }
      ASSERT_EQ(in_parts.Solve(threads), expected);
      for (MaxFlow::Node i = 0; i < nodes; ++i)
        ASSERT_EQ(in_parts.InSourceSide(i), whole.InSourceSide(i)) << "node " << i;
    }
  }
}

}  // namespace
}  // namespace depthfarm
