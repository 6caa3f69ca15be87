#include "coordinator/cli/plan_report.h"

#include <algorithm>
#include <map>

#include "common/text/text_table.h"
#include "coordinator/cli/report.h"
#include "coordinator/planning/cost_model.h"

namespace depthfarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::string Bytes(std::uint64_t bytes) { return FormatBytes(static_cast<double>(bytes)); }

std::string Count(std::size_t count, const std::string& one) {
  return std::to_string(count) + " " + one + (count == 1 ? "" : "s");
}

std::string Range(const std::string& least, const std::string& most) {
  return least == most ? least : least + " to " + most;
}

Choice SegmentsChoice(const ResolvedJob& job) {
  const auto [least, most] = std::ranges::minmax_element(job.views, {}, &JobView::segments);
  const auto pixels_of_one = [](const JobView& view) {
    return static_cast<double>(view.camera.width) * view.camera.height / view.segments;
  };
  const auto [small, large] = std::ranges::minmax_element(job.views, {}, pixels_of_one);
  std::string reason = "of a view; one for each ";
  reason += Range(Decimal(pixels_of_one(*small), 0), Decimal(pixels_of_one(*large), 0)) + " pixels";
  if (pixels_of_one(*large) > job.params.segment_pixels + 0.5) reason += ": larger in pictures above 1024x768";
  return {"segments", Range(WithThousands(least->segments), WithThousands(most->segments)), reason};
}

Choice LevelsChoice(const ResolvedJob& job) {
  const int levels = job.params.levels;
  std::string reason = "about a pixel apart in the nearest neighbour";
  if (levels <= kFewAutoLevels) reason = "so few that they are less than a pixel apart in the nearest neighbour";
  if (job.params.refine_rounds == 0)
    reason = "about a quarter of a pixel apart in the nearest neighbour: no refinement";
  if (levels >= kMostAutoLevels) reason = "as many as are taken without being asked for";
  return {"levels", std::to_string(levels), reason};
}

Choice BlocksChoice(const ResolvedJob& job) {
  const bool sparse = job.params.search == Search::kSparse;
  std::string value = std::to_string(job.level_blocks_i);
  if (job.HasPFrames() && job.level_blocks_p != job.level_blocks_i)
    value += ", P frames " + std::to_string(job.level_blocks_p);
  const std::string most = std::to_string(kMostBytesOfPart / 1'000'000) + " MB";
  std::string reason = "one task searches all levels of a frame: ";
  reason += sparse ? "its matches and beliefs take less than " + most : "splitting would cost more than it saves";
  if (job.level_blocks_i > 1) {
    reason = "so many tasks of a frame search some levels each, side by side, and are merged";
    if (sparse) reason += ": each takes about " + most + " or less for matches and beliefs";
  }
  return {"level-blocks", value, reason};
}

Choice GopsChoice(const ResolvedJob& job) {
  const int gops = job.num_gops();
  std::string reason = "every frame is an I frame, estimated on its own";
  if (job.params.anchor == Anchor::kShared && gops > 1) {
    reason = "all refer to the first frame, the only I frame; GOPs side by side once that is done";
  } else if (job.HasPFrames()) {
    const int p_frames = std::min(job.params.gop, job.num_frames) - 1;
    const bool alike = job.num_frames % std::min(job.params.gop, job.num_frames) == 0;
    reason = std::string("an I frame and ") + (alike ? "" : "up to ") +
             Count(static_cast<std::size_t>(p_frames), "P frame") + ", one after the other";
    if (gops > 1) reason = "each " + reason + "; GOPs side by side";
  }
  return {"GOPs", WithThousands(gops), reason};
}

StageForecast Sum(const std::vector<StageForecast>& stages) {
  StageForecast sum;
  for (const StageForecast& stage : stages) {
    sum.tasks += stage.tasks;
    sum.seconds += stage.seconds;
    sum.longest_seconds = std::max(sum.longest_seconds, stage.longest_seconds);
    sum.peak_memory_bytes = std::max(sum.peak_memory_bytes, stage.peak_memory_bytes);
    sum.result_bytes += stage.result_bytes;
    sum.read_bytes += stage.read_bytes;
  }
  return sum;
}

std::vector<std::string> StageRow(const std::string& name, const StageForecast& stage) {
  const auto bytes = [](std::uint64_t count) { return count == 0 ? std::string("-") : Bytes(count); };
  return {name,
          WithThousands(stage.tasks),
          FormatDuration(stage.seconds),
          FormatDuration(stage.longest_seconds),
          Bytes(stage.peak_memory_bytes),
          bytes(stage.result_bytes),
          bytes(stage.read_bytes)};
}

std::string FormatStages(const std::vector<StageForecast>& stages) {
  std::vector<std::vector<std::string>> rows = {{"stage", "tasks", "CPU", "longest task", "memory", "makes", "reads"}};
  for (const StageForecast& stage : stages) rows.push_back(StageRow(TaskKindName(stage.kind), stage));
  rows.push_back(StageRow("all", Sum(stages)));
  return FormatTable(rows, {false, true, true, true, true, true, true}, 2);
}

// "analyse, estimate, 5 refine, emit, commit".
std::string PathText(const JobForecast& forecast) {
  std::map<TaskKind, int> counts;
  int first = forecast.frames;
  int last = 0;
  for (const TaskId& id : forecast.critical_path) {
    ++counts[id.kind];
    if (id.kind == TaskKind::kPrepare || id.kind == TaskKind::kManifest) continue;
    first = std::min(first, id.frame);
    last = std::max(last, id.frame);
  }
  std::string text;
  for (const auto& [kind, count] : counts) {
    text += (text.empty() ? "" : ", ") + (count > 1 ? std::to_string(count) + " " : "") + TaskKindName(kind);
  }
  if (forecast.frames > 1) {
    text += first == last ? "; of frame " + std::to_string(first)
                          : "; of frames " + std::to_string(first) + " to " + std::to_string(last);
  }
  return text;
}

std::string FormatFarms(const std::vector<FarmForecast>& farms) {
  std::vector<std::vector<std::string>> rows = {{"workers", "wall time", "busy", "moved"}};
  const bool compares = farms.size() > 1;
  if (compares) rows.front().emplace_back("speed-up");
  for (const FarmForecast& farm : farms) {
    const double busy = farm.cpu_seconds / (farm.wall_seconds * farm.workers);
    rows.push_back({std::to_string(farm.workers), FormatDuration(farm.wall_seconds), Decimal(100 * busy, 0) + " %",
                    Bytes(farm.moved_bytes)});
    if (compares) rows.back().push_back(Decimal(farms.front().wall_seconds / farm.wall_seconds, 1));
  }
  return FormatTable(rows, std::vector<bool>(rows.front().size(), true), 2);
}

}  // namespace

std::vector<Choice> ChoicesOf(const EstimationParams& asked, const ResolvedJob& job) {
  std::vector<Choice> choices;
  if (asked.segments == 0) choices.push_back(SegmentsChoice(job));
  if (asked.levels == 0) choices.push_back(LevelsChoice(job));
  if (asked.level_blocks == 0) choices.push_back(BlocksChoice(job));
  choices.push_back(GopsChoice(job));
  return choices;
}

std::string FormatPlan(const PlanReport& report) {
  const JobForecast& forecast = report.forecast;
  std::string text = "plan of '" + report.sequence + "': " + report.description + "\n\nchosen\n";
  std::vector<std::vector<std::string>> rows;
  for (const Choice& choice : report.choices) rows.push_back({choice.option, choice.value, choice.reason});
  text += FormatTable(rows, {false, false, false}, 2);

  text += "\ntasks, predicted for " + std::string(kCostMachine) + "\n" + FormatStages(forecast.stages);
  text +=
      "  CPU     depends on what pictures show: rendered test scenes took about 0.8 times as long, photographs 0.8 to\n"
      "          1.5 times. 'depthfarm bench' measures this machine.\n"
      "  memory  of a worker for the largest such task; it also keeps what it may need again, within its --memory\n"
      "  makes   artifacts as they are stored; emit: files\n"
      "  reads   artifacts, fetched or the worker's own\n";

  text += "\ncritical path: " + FormatDuration(forecast.critical_seconds) + "; no farm of such cores is faster\n";
  text += "  " + PathText(forecast) + "\n";

  text += "\nfarms of such cores, one worker on each, with nothing else to do\n" + FormatFarms(forecast.farms);
  text +=
      "  busy    share of the time in which workers compute\n"
      "  moved   artifacts fetched from other workers; decoding them counts, network and disk do not\n";
  if (forecast.more_do_not_help) {
    text += "  More than " + Count(static_cast<std::size_t>(forecast.farms.back().workers), "worker") +
            ": next to nothing is gained.\n";
  }
  if (forecast.extrapolated()) {
    text += "  Extrapolated: of " + WithThousands(forecast.frames) + " frames the first " +
            WithThousands(forecast.played_frames) +
            " were played through; tasks of the critical path are of\n  these, all seconds of the whole job.\n";
  }
  return text;
}

OrderedJson PlanToJson(const PlanReport& report) {
  const JobForecast& forecast = report.forecast;
  OrderedJson choices = OrderedJson::array();
  for (const Choice& choice : report.choices)
    choices.push_back({{"option", choice.option}, {"value", choice.value}, {"reason", choice.reason}});
  const auto stage_json = [](const std::string& name, const StageForecast& stage) {
    return OrderedJson{{"stage", name},
                       {"tasks", stage.tasks},
                       {"cpuSeconds", stage.seconds},
                       {"longestTaskSeconds", stage.longest_seconds},
                       {"peakMemoryBytes", stage.peak_memory_bytes},
                       {"madeBytes", stage.result_bytes},
                       {"readBytes", stage.read_bytes}};
  };
  OrderedJson stages = OrderedJson::array();
  for (const StageForecast& stage : forecast.stages) stages.push_back(stage_json(TaskKindName(stage.kind), stage));
  OrderedJson tasks = OrderedJson::array();
  for (const TaskId& id : forecast.critical_path) {
    const std::string name = TaskName(id);  // "job 1 frame 0 ...": the job has no number yet
    tasks.push_back(name.substr(name.find(' ', name.find(' ') + 1) + 1));
  }
  OrderedJson farms = OrderedJson::array();
  for (const FarmForecast& farm : forecast.farms) {
    farms.push_back({{"workers", farm.workers},
                     {"wallSeconds", farm.wall_seconds},
                     {"cpuSeconds", farm.cpu_seconds},
                     {"movedBytes", farm.moved_bytes}});
  }
  return {{"sequence", report.sequence},
          {"summary", report.description},
          {"choices", std::move(choices)},
          {"machine", kCostMachine},
          {"algorithmVersion", kAlgorithmVersion},
          {"stages", std::move(stages)},
          {"all", stage_json("all", Sum(forecast.stages))},
          {"criticalPath", {{"seconds", forecast.critical_seconds}, {"tasks", std::move(tasks)}}},
          {"farms", std::move(farms)},
          {"frames", forecast.frames},
          {"playedFrames", forecast.played_frames}};
}

}  // namespace depthfarm
