#ifndef DEPTHFARM_TESTS_SUPPORT_CUT_ORACLE_H_
#define DEPTHFARM_TESTS_SUPPORT_CUT_ORACLE_H_

#include <cstdint>
#include <vector>

#include "worker/optimization/labelling_problem.h"

namespace depthfarm::test {

// A plain minimum cut: Boost.Graph's Boykov-Kolmogorov on an adjacency list, then a breadth-first search from the
// source over arcs with residual capacity. (Not Boost's push-relabel: it leaves a preflow whose excess at nodes that
// cannot reach the sink was never returned, so that its residual graph has another source side. Brute force over small
// graphs tells them apart.)
struct CutProblem {
  struct Edge {
    int u = 0;
    int v = 0;
    std::int64_t forth = 0;  // capacity u -> v
    std::int64_t back = 0;   // capacity v -> u
  };
  std::vector<std::int64_t> from_source;  // per node
  std::vector<std::int64_t> to_sink;      // per node
  std::vector<Edge> edges;
};
struct CutSolution {
  std::int64_t flow = 0;
  std::vector<bool> source_side;  // the smallest minimum cut
};
CutSolution SolveCutPlainly(const CutProblem& problem);

// E of eq. (1), written out from the definition without any of the code under test.
std::int64_t EnergyPlainly(const LabellingProblem& problem, const std::vector<Level>& labels);

// One expansion move the plain way: every pairwise term as the four numbers of its definition, Kolmogorov-Zabih
// construction, SolveCutPlainly. Returns the new labels.
std::vector<Level> ExpandPlainly(const LabellingProblem& problem, const std::vector<Level>& labels, Level alpha);

}  // namespace depthfarm::test

#endif  // DEPTHFARM_TESTS_SUPPORT_CUT_ORACLE_H_
