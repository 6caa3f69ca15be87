// depthfarm-benchmarks: CPU time of the core's stages on a rendered scene, of its maximum flow beside those of others,
// the transfer of artifacts beside bare ZeroMQ, and how soon a coordinator goes on with its jobs. Built where Google
// Benchmark is there, never installed. Takes its options, --quick: a tiny scene, in seconds, to see that all of it
// works, and --sequence=FILE: maximum flow alone, of the first frame of a sequence.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "tests/benchmarks/benchmarks.h"

namespace {

constexpr std::size_t kArtifactBytes = std::size_t{256} << 20;
constexpr std::size_t kQuickArtifactBytes = std::size_t{9} << 20;
constexpr int kRounds = 9;
constexpr int kQuickRounds = 1;
constexpr int kFrames = 10'000;  // of the job of a coordinator that is started again: 180,000 tasks
constexpr int kQuickFrames = 50;
constexpr std::string_view kSequence = "--sequence=";

// Runs what the words ask for. Without an option of the library's own that says so, --quick spends no time on
// exactness.
int Run(std::vector<std::string> words) {
  using depthfarm::benchmarks::MeasuredFrames;
  using depthfarm::benchmarks::Workload;
  const bool quick = std::erase(words, "--quick") > 0;
  std::string sequence;
  if (const auto option =
          std::ranges::find_if(words, [](const std::string& word) { return word.starts_with(kSequence); });
      option != words.end()) {
    sequence = option->substr(kSequence.size());
    words.erase(option);
  }
  if (quick) words.insert(words.begin() + 1, "--benchmark_min_time=0.01");
  std::vector<char*> arguments;
  arguments.reserve(words.size());
  for (std::string& word : words) arguments.push_back(word.data());
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;

  if (!sequence.empty()) {
    MeasuredFrames frames(Workload{.sequence = sequence, .flow_segments = {0}});
    bool failed = false;
    depthfarm::benchmarks::RegisterFlowBenchmarks(frames, failed);
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return failed ? 1 : 0;
  }
  MeasuredFrames frames(quick ? Workload{{}, 3, 160, 120, 960, {300, 900}, 200, 40} : Workload{});
  bool failed = false;
  depthfarm::benchmarks::RegisterStageBenchmarks(frames, failed);
  depthfarm::benchmarks::RegisterFlowBenchmarks(frames, failed);
  depthfarm::benchmarks::RegisterTransferBenchmarks(quick ? kQuickArtifactBytes : kArtifactBytes,
                                                    quick ? kQuickRounds : kRounds, failed);
  depthfarm::benchmarks::RegisterRestartBenchmarks(quick ? kQuickFrames : kFrames, failed);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return failed ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) { return Run(std::vector<std::string>(argv, argv + argc)); }
