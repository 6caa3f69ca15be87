#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/cli/bench_report.h"
#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/job_request.h"
#include "coordinator/cli/local_job.h"
#include "coordinator/cli/media_program.h"
#include "coordinator/cli/private_folder.h"
#include "coordinator/cli/progress.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

struct PresetRequest {
  std::string name;
  EstimationArguments estimation;
};

// Each preset that was asked for, in that order. Looks at all of them, so that what cannot work is refused before
// anything is rendered.
Result<std::vector<PresetRequest>> PresetsOf(const EstimationArguments& asked) {
  std::vector<PresetRequest> presets;
  std::istringstream list(asked.preset);
  for (std::string name; std::getline(list, name, ',');) {
    DEPTHFARM_RETURN_IF_ERROR(Preset(name).status());
    presets.push_back({name, asked});
    presets.back().estimation.preset = name;
  }
  // That of the params file, if it has one.
  if (presets.empty()) presets.push_back({asked.params_file.empty() ? "default" : asked.params_file, asked});
  for (const PresetRequest& preset : presets) {
    DEPTHFARM_RETURN_IF_ERROR(BuildEstimationParams(preset.estimation).status());
  }
  return presets;
}

std::string ContentOf(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// Renders the arc scene that `arguments` describe, with as many frames as are estimated; its sequence file.
Result<std::string> RenderScene(const BenchArguments& arguments, const EstimationParams& params,
                                const fs::path& folder) {
  const int frames = params.end_frame > 0 ? params.end_frame : params.first_frame + 1;
  const fs::path log = folder / "scene.log";
  std::cerr << "rendering " << arguments.cameras << " views " << arguments.size << "\n";
  DEPTHFARM_ASSIGN_OR_RETURN(
      const ProcessEnd end,
      RunMedia({"scene", "arc", "-o", (folder / "scene").string(), "--cameras", std::to_string(arguments.cameras),
                "--size", arguments.size, "--frames", std::to_string(frames), "--seed", std::to_string(arguments.seed)},
               log));
  if (end.ok()) return (folder / "scene" / "sequence.json").string();
  const std::string reason = "the scene cannot be rendered: depthfarm-media " + Describe(end) + "\n" + ContentOf(log);
  return end.signal == 0 && end.exit_code == kExitBadInput ? InvalidArgument(reason) : Unavailable(reason);
}

// Quality that cannot be measured (for want of a view between others, say) is no reason to throw the times away.
Result<BenchQuality> Evaluate(const std::string& sequence, const fs::path& depth, const fs::path& log) {
  DEPTHFARM_ASSIGN_OR_RETURN(const ProcessEnd end, RunMedia({"evaluate", sequence, depth.string(), "--json"}, log));
  const std::string text = ContentOf(log);
  if (!end.ok()) std::cerr << "quality is not known: depthfarm-media " << Describe(end) << "\n" << text;
  return QualityOf(nlohmann::json::parse(text, nullptr, false));
}

void Describe(const JobRequest& request, BenchedPreset& preset) {
  const ResolvedJob& job = request.resolved;
  preset.description = DescribeJob(job);
  preset.views = job.num_views();
  preset.frames = job.num_frames;
  preset.width = job.views.front().camera.width;
  preset.height = job.views.front().camera.height;
  for (const JobView& view : job.views) preset.segments += view.segments;
  preset.levels = job.params.levels;
}

// Runs one job of a preset, its files below `folder`, and adds it to `preset`; its quality after the first one. The
// exit code of a job that failed, which is said on stderr.
Result<int> AddRun(const BenchArguments& arguments, const PresetRequest& asked, const std::string& sequence,
                   const fs::path& folder, BenchedPreset& preset) {
  const fs::path output = folder / "depth";
  DEPTHFARM_ASSIGN_OR_RETURN(const JobRequest request, PrepareJobRequest({.sequence = sequence,
                                                                          .output_dir = output.string(),
                                                                          .allow_outside = arguments.allow_outside,
                                                                          .estimation = asked.estimation}));
  std::cerr << asked.name << ", run " << preset.runs.size() + 1 << " of " << arguments.repeats << ": ";
  DEPTHFARM_ASSIGN_OR_RETURN(LocalJob job, RunLocally(request, {.workers = arguments.workers,
                                                                .threads = arguments.threads,
                                                                .worker_log_dir = "",
                                                                .cache_dir = "",
                                                                .cache_size = ""}));
  if (job.status.state() != v1::JOB_STATE_DONE) {
    std::cerr << "depthfarm: preset " << asked.name << ": " << job.status.error().message() << "\n" << job.log_tails;
    return ExitCodeOfJob(job.status);
  }
  if (preset.runs.empty()) {
    Describe(request, preset);
    DEPTHFARM_ASSIGN_OR_RETURN(preset.quality, Evaluate(sequence, output, output / "evaluation.json"));
  }
  preset.runs.push_back({std::move(job.status), job.wall_seconds});
  std::error_code ignored;  // goes with the folder
  fs::remove_all(output, ignored);
  return kExitOk;
}

// Fills in `report`; the exit code of a job that failed.
Result<int> Measure(const BenchArguments& arguments, const std::vector<PresetRequest>& presets, BenchReport& report) {
  DEPTHFARM_ASSIGN_OR_RETURN(const PrivateFolder folder, PrivateFolder::Make());
  report.machine = ThisMachine();
  report.workers = arguments.workers;
  report.scene = arguments.sequence;
  std::string sequence = arguments.sequence;
  if (sequence.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const EstimationParams params, BuildEstimationParams(presets.front().estimation));
    DEPTHFARM_ASSIGN_OR_RETURN(sequence, RenderScene(arguments, params, folder.path()));
    report.scene = "arc of seed " + std::to_string(arguments.seed) + ", rendered";
  }
  for (const PresetRequest& preset : presets) report.presets.emplace_back().name = preset.name;
  for (int repeat = 0; repeat < arguments.repeats; ++repeat) {
    for (std::size_t i = 0; i < presets.size(); ++i) {  // in turn: what else the machine does meets all of them
      DEPTHFARM_ASSIGN_OR_RETURN(const int exit_code,
                                 AddRun(arguments, presets[i], sequence, folder.path(), report.presets[i]));
      if (exit_code != kExitOk) return exit_code;
    }
  }
  return kExitOk;
}

}  // namespace

int Execute(const BenchArguments& arguments) {
  CatchInterruptions();
  const Result<std::vector<PresetRequest>> presets = PresetsOf(arguments.estimation);
  if (!presets.ok()) return Fail(presets.status());
  BenchReport report;
  const Result<int> exit_code = Measure(arguments, *presets, report);
  if (!exit_code.ok() && Interrupted()) {
    std::cerr << "depthfarm: interrupted\n";
    return kExitInterrupted;
  }
  if (!exit_code.ok()) return Fail(exit_code.status());
  if (*exit_code != kExitOk) return *exit_code;
  if (arguments.json) {
    std::cout << BenchToJson(report).dump(2) << "\n";
  } else {
    std::cout << FormatBench(report);
  }
  return kExitOk;
}

}  // namespace depthfarm
