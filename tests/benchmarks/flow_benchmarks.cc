// One move of the first sweep, its minimum cut by our MaxFlow and by those of others.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "tests/benchmarks/benchmarks.h"
#include "tests/benchmarks/move_graph.h"
#include "tests/benchmarks/other_flows.h"
#include "tests/benchmarks/thread_seconds.h"
#include "worker/optimization/expansion.h"
#include "worker/optimization/max_flow.h"

namespace depthfarm::benchmarks {
namespace {

// The graph of a move in the middle of the first sweep, and what Expansion finds for it.
struct MeasuredMove {
  MoveGraph graph;
  std::int64_t flow = 0;
};

MeasuredMove MoveInTheMiddle(const MeasuredFrame& frame) {
  const MeasuredFrame::Block block = frame.FirstBlock();
  std::vector<Level> labels = block.start;
  Expansion expansion(block.problem, labels);
  const std::size_t middle = block.problem.levels.size() / 2;
  for (std::size_t level_index = 0; level_index < middle; ++level_index) expansion.Expand(level_index);
  MeasuredMove move;
  move.graph = GraphOfMove(block.problem, labels, middle);
  move.flow = expansion.Expand(middle) - move.graph.constant;
  return move;
}

// Made when the first solver asks for it.
class LazyMove {
 public:
  LazyMove(MeasuredFrames& frames, int segments) : frames_(frames), segments_(segments) {}
  [[nodiscard]] const MeasuredMove& Get() {
    if (!move_) move_ = MoveInTheMiddle(frames_.WithSegments(segments_));
    return *move_;
  }

 private:
  MeasuredFrames& frames_;
  int segments_;
  std::optional<MeasuredMove> move_;
};

// `solver` keeps its memory from one problem to the next, as in a sweep.
SolvedFlow SolveWithOurs(const MoveGraph& graph, MaxFlow& solver) {
  const double start = ThreadSeconds();
  solver.Reset(static_cast<MaxFlow::Node>(graph.num_nodes()));
  for (const MoveGraph::Edge& edge : graph.edges) solver.AddEdge(edge.u, edge.v, edge.capacity);
  for (std::size_t node = 0; node < graph.num_nodes(); ++node) {
    solver.AddTerminal(static_cast<MaxFlow::Node>(node), graph.terminal[node]);
  }
  const double built = ThreadSeconds();
  const std::int64_t flow = solver.Solve();
  return {flow, built - start, ThreadSeconds() - built};
}

struct Solver {
  std::string name;
  std::function<SolvedFlow(const MoveGraph&)> solve;
  bool exact = true;  // a wrong flow is an error
};

void MeasureSolver(benchmark::State& state, const Solver& solver, LazyMove& lazy_move, bool& failed) {
  const MeasuredMove& move = lazy_move.Get();
  double build_seconds = 0;
  double solve_seconds = 0;
  bool agrees = true;
  for ([[maybe_unused]] auto _ : state) {
    const SolvedFlow solved = solver.solve(move.graph);
    build_seconds += solved.build_seconds;
    solve_seconds += solved.solve_seconds;
    agrees = agrees && solved.flow == move.flow;
  }
  if (!agrees && solver.exact) {
    failed = true;
    state.SkipWithError("the flow is not that of the expansion move");
    return;
  }
  const auto mean_ms = [](double seconds) {
    return benchmark::Counter(1000 * seconds, benchmark::Counter::kAvgIterations);
  };
  state.counters["nodes"] = static_cast<double>(move.graph.num_nodes());
  state.counters["edges"] = static_cast<double>(move.graph.edges.size());
  state.counters["build_ms"] = mean_ms(build_seconds);
  state.counters["solve_ms"] = mean_ms(solve_seconds);
  state.SetLabel(agrees ? "flow agrees" : "FLOW DIFFERS");
}

}  // namespace

void RegisterFlowBenchmarks(MeasuredFrames& frames, bool& failed) {
  const auto ours = std::make_shared<MaxFlow>();
  const Solver solvers[] = {
      {"depthfarm", [ours](const MoveGraph& graph) { return SolveWithOurs(graph, *ours); }},
      {"opencv_gcgraph", SolveWithOpenCv, false},
      {"boost_boykov_kolmogorov", SolveWithBoostBoykovKolmogorov},
      {"boost_push_relabel", SolveWithBoostPushRelabel},
  };
  for (const int segments : frames.workload().flow_segments) {
    const auto move = std::make_shared<LazyMove>(frames, segments);
    for (const Solver& solver : solvers) {
      const Workload& of = frames.workload();
      const std::string frame =
          of.sequence.empty() ? std::to_string(of.views) + "x" + std::to_string(segments) : "first_frame";
      const std::string name = "MaxFlow/" + solver.name + "/" + frame;
      benchmark::RegisterBenchmark(name.c_str(), [solver, move, &failed](benchmark::State& state) {
        MeasureSolver(state, solver, *move, failed);
      })->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace depthfarm::benchmarks
