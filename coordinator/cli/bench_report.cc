#include "coordinator/cli/bench_report.h"

#include <algorithm>
#include <array>
#include <functional>

#include "common/job/estimation_params.h"
#include "common/text/text_table.h"
#include "coordinator/cli/report.h"

namespace depthfarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

// In the order of a frame's life. The others (folders, manifest) take no time worth a column; they count in the sum.
constexpr std::array kStages = {v1::TASK_KIND_ANALYSE, v1::TASK_KIND_ESTIMATE, v1::TASK_KIND_MERGE,
                                v1::TASK_KIND_REFINE,  v1::TASK_KIND_ASSESS,   v1::TASK_KIND_EMIT};

double StageSeconds(const BenchRun& run, v1::TaskKind kind) {
  double seconds = 0;
  for (const v1::StageStatus& stage : run.job.stages())
    if (stage.kind() == kind) seconds += stage.cpu_seconds();
  return seconds;
}

bool HasStage(const BenchReport& report, v1::TaskKind kind) {
  const auto in_job = [&](const v1::JobStatus& job) {
    return std::ranges::any_of(
        job.stages(), [&](const v1::StageStatus& stage) { return stage.kind() == kind && stage.tasks_total() > 0; });
  };
  return std::ranges::any_of(report.presets,
                             [&](const BenchedPreset& preset) { return in_job(preset.runs.front().job); });
}

std::string StageName(v1::TaskKind kind) {
  v1::StageStatus stage;
  stage.set_kind(kind);
  return depthfarm::StageName(stage);
}

double Median(const BenchedPreset& preset, const std::function<double(const BenchRun&)>& figure) {
  std::vector<double> values;
  for (const BenchRun& run : preset.runs) values.push_back(figure(run));
  std::ranges::sort(values);
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

// CPU seconds of a view of a frame.
double MedianStage(const BenchedPreset& preset, v1::TaskKind kind) {
  return Median(preset, [&](const BenchRun& run) { return StageSeconds(run, kind); }) / (preset.views * preset.frames);
}
double MedianCpu(const BenchedPreset& preset) {
  return Median(preset, &BenchRun::CpuSeconds) / (preset.views * preset.frames);
}
double MedianWall(const BenchedPreset& preset) {
  return Median(preset, [](const BenchRun& run) { return run.wall_seconds; });
}
double MedianMemory(const BenchedPreset& preset) {
  return Median(preset, [](const BenchRun& run) { return static_cast<double>(run.PeakMemoryBytes()); });
}

std::size_t NumRuns(const BenchReport& report) { return report.presets.front().runs.size(); }

}  // namespace

double BenchRun::CpuSeconds() const {
  double seconds = 0;
  for (const v1::StageStatus& stage : job.stages()) seconds += stage.cpu_seconds();
  return seconds;
}

std::uint64_t BenchRun::PeakMemoryBytes() const {
  std::uint64_t bytes = 0;
  for (const v1::StageStatus& stage : job.stages()) bytes = std::max(bytes, stage.peak_memory_bytes());
  return bytes;
}

BenchQuality QualityOf(const nlohmann::json& evaluation) {
  const auto number = [&](const char* pointer, double& value) {
    const nlohmann::json::json_pointer path(pointer);
    if (evaluation.contains(path) && evaluation[path].is_number()) value = evaluation[path].get<double>();
  };
  BenchQuality quality;
  number("/mean/psnrY", quality.psnr_db);
  number("/depthError/allViews/all/bad1PxPercent", quality.bad_px_percent);
  return quality;
}

std::string FormatBench(const BenchReport& report) {
  std::string text = "machine: " + report.machine.cpu + ", " + std::to_string(report.machine.cores) + " cores\n";
  text += "scene: " + report.scene + "\n";
  for (const BenchedPreset& preset : report.presets) text += preset.name + ": " + preset.description + "\n";
  text += "\nCPU seconds of a view by stage; " + std::to_string(report.workers) +
          (report.workers == 1 ? " worker" : " workers") +
          (NumRuns(report) > 1 ? ", medians of " + std::to_string(NumRuns(report)) + " runs" : "") +
          ". Wall: of the whole job. Memory: peak of a worker.\n"
          "PSNR: luma of views synthesised from their neighbours, dB. Bad: % of pixels off by more than 1 px.\n\n";

  std::vector<std::vector<std::string>> rows = {{"preset"}};
  std::vector<bool> right = {false};
  std::vector<v1::TaskKind> stages;
  for (const v1::TaskKind kind : kStages) {
    if (!HasStage(report, kind)) continue;
    stages.push_back(kind);
    rows.front().push_back(StageName(kind));
  }
  for (const char* column : {"all", "wall", "memory", "PSNR", "bad"}) rows.front().emplace_back(column);
  right.resize(rows.front().size(), true);
  for (const BenchedPreset& preset : report.presets) {
    std::vector<std::string>& row = rows.emplace_back();
    row.push_back(preset.name);
    for (const v1::TaskKind kind : stages) row.push_back(Decimal(MedianStage(preset, kind), 2));
    row.push_back(Decimal(MedianCpu(preset), 2));
    row.push_back(FormatDuration(MedianWall(preset)));
    row.push_back(FormatBytes(MedianMemory(preset)));
    row.push_back(Decimal(preset.quality.psnr_db, 2));
    row.push_back(Decimal(preset.quality.bad_px_percent, 2));
  }
  return text + FormatTable(rows, right);
}

OrderedJson BenchToJson(const BenchReport& report) {
  OrderedJson presets = OrderedJson::array();
  for (const BenchedPreset& preset : report.presets) {
    OrderedJson seconds = OrderedJson::object();
    for (const v1::TaskKind kind : kStages)
      if (HasStage(report, kind)) seconds[StageName(kind)] = MedianStage(preset, kind);
    seconds["all"] = MedianCpu(preset);
    OrderedJson runs = OrderedJson::array();
    for (const BenchRun& run : preset.runs) {
      runs.push_back({{"wallSeconds", run.wall_seconds},
                      {"cpuSeconds", run.CpuSeconds()},
                      {"peakMemoryBytes", run.PeakMemoryBytes()},
                      {"stages", JobToJson(run.job)["stages"]}});
    }
    presets.push_back({{"preset", preset.name},
                       {"job", preset.description},
                       {"views", preset.views},
                       {"frames", preset.frames},
                       {"width", preset.width},
                       {"height", preset.height},
                       {"segments", preset.segments},
                       {"levels", preset.levels},
                       {"cpuSecondsOfView", std::move(seconds)},
                       {"wallSeconds", MedianWall(preset)},
                       {"peakMemoryBytes", MedianMemory(preset)},
                       {"psnrY", preset.quality.psnr_db},
                       {"bad1PxPercent", preset.quality.bad_px_percent},
                       {"runs", std::move(runs)}});
  }
  return {{"machine", {{"cpu", report.machine.cpu}, {"cores", report.machine.cores}}},
          {"algorithmVersion", kAlgorithmVersion},
          {"scene", report.scene},
          {"workers", report.workers},
          {"presets", std::move(presets)}};
}

}  // namespace depthfarm
