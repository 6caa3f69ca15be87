#ifndef DEPTHFARM_COORDINATOR_CLI_BENCH_REPORT_H_
#define DEPTHFARM_COORDINATOR_CLI_BENCH_REPORT_H_

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "coordinator/cli/machine.h"
#include "depthfarm/v1/farm.pb.h"

namespace depthfarm {

// One job that is done.
struct BenchRun {
  v1::JobStatus job;
  double wall_seconds = 0;  // with starting and stopping its farm

  [[nodiscard]] double CpuSeconds() const;              // of all stages
  [[nodiscard]] std::uint64_t PeakMemoryBytes() const;  // of the largest worker
};

// What is known of the quality of its depth; NaN: not known.
struct BenchQuality {
  double psnr_db = std::numeric_limits<double>::quiet_NaN();         // PSNR-Y of synthesised views
  double bad_px_percent = std::numeric_limits<double>::quiet_NaN();  // off by more than 1 px from exact depth
};
// From what `depthfarm evaluate --json` printed; what is not in there is not known.
[[nodiscard]] BenchQuality QualityOf(const nlohmann::json& evaluation);

struct BenchedPreset {
  std::string name;
  std::string description;  // of the job, one line
  int views = 0;
  int frames = 0;
  int width = 0;  // of the first view, pixels
  int height = 0;
  long segments = 0;  // of all views
  int levels = 0;
  std::vector<BenchRun> runs;  // at least one
  BenchQuality quality;        // the same for every run: its depth is the same bytes
};

struct BenchReport {
  Machine machine;
  std::string scene;  // what was estimated
  int workers = 1;    // of each farm
  std::vector<BenchedPreset> presets;
};

// For people: machine, jobs and a table of CPU seconds of a view by stage, medians of the runs.
[[nodiscard]] std::string FormatBench(const BenchReport& report);
// The same and every run, for programs.
[[nodiscard]] nlohmann::ordered_json BenchToJson(const BenchReport& report);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_BENCH_REPORT_H_
