#include "coordinator/cli/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>

#include "common/text/text_table.h"
#include "common/wire/envelope.h"
#include "common/wire/task_wire.h"
#include "coordinator/cli/logs_report.h"

namespace depthfarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

template <typename... Values>
std::string Format(const char* format, Values... values) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

struct TaskCount {
  std::uint64_t done = 0;
  std::uint64_t total = 0;
};
TaskCount CountTasks(const v1::JobStatus& job) {
  TaskCount count;
  for (const v1::StageStatus& stage : job.stages()) {
    count.done += stage.tasks_done();
    count.total += stage.tasks_total();
  }
  return count;
}

// What the frames of a job are to its user: a rendering job counts parts of some views each.
std::string UnitName(const v1::JobStatus& job) {
  const auto renders = [](const v1::StageStatus& stage) {
    return stage.kind() == v1::TASK_KIND_RENDER && stage.tasks_total() > 0;
  };
  return std::any_of(job.stages().begin(), job.stages().end(), renders) ? "part" : "frame";
}

std::string FramesText(const v1::JobStatus& job) {
  return std::to_string(job.frames_done()) + "/" + std::to_string(job.frames_total());
}

std::string Joined(const google::protobuf::RepeatedPtrField<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

std::vector<std::string> Words(const google::protobuf::RepeatedPtrField<std::string>& words) {
  return {words.begin(), words.end()};
}

std::string OutputText(const v1::JobStatus& job) {
  if (!job.keeps_results()) return job.output_dir();
  return "on the workers; depthfarm fetch " + std::to_string(job.job_id()) + " -o DIR";
}

// The task that the job failed with, and how.
std::string FailedTaskText(const v1::JobStatus& job, BegunAnewBy anew) {
  if (!job.has_failed_task()) return {};
  const char* const by = anew == BegunAnewBy::kRetry ? "retry" : "the same command";
  std::string text = "  quarantined: " + NameWithinJob(job.failed_task()) + "; " + by + " begins it anew\n";
  for (v1::TaskAttempt attempt : job.failed_attempts()) {
    // The job's reason is mostly that of its last attempt, after the name of the task: once is enough.
    if (job.error().message().ends_with(attempt.error().message())) attempt.clear_error();
    text += "    attempt " + std::to_string(attempt.attempt()) + " on " + attempt.worker() + ", " +
            FormatDuration(attempt.seconds()) + ": " + OutcomeName(attempt.outcome()) + "\n" + NotesOf(attempt);
  }
  return text;
}

std::string DuplicatesText(const v1::JobStatus& job) {
  if (job.duplicates() == 0) return {};
  return "  slow tasks given to a second worker: " + std::to_string(job.duplicates()) + ", which was faster with " +
         std::to_string(job.duplicates_won()) + "\n";
}

// What was there already, of the tasks that make an artifact; nothing if nothing was.
std::string ReusedText(const v1::JobStatus& job) {
  std::uint64_t reused = 0;
  for (const v1::StageStatus& stage : job.stages()) reused += stage.reused();
  if (reused == 0) return {};
  return "  reused " + std::to_string(reused) + " of " + std::to_string(CountTasks(job).total) + " tasks\n";
}

// What was given besides pictures and left aside, since they contradict it; nothing if nothing was.
std::string LeftAsideText(const v1::JobStatus& job) {
  std::string text;
  for (const v1::StageStatus& stage : job.stages()) {
    if (stage.left_aside() == 0) continue;
    const bool masks = stage.kind() == v1::TASK_KIND_ANALYSE;
    text += std::string("  left aside: the ") + (masks ? "masks" : "priors") + " of " +
            std::to_string(stage.left_aside()) + (stage.left_aside() == 1 ? " picture" : " pictures") +
            ", the first at " + NameWithinJob(stage.first_left_aside()) +
            (masks ? ": their contours are not those of the pictures\n" : ": they do not agree with the pictures\n");
  }
  return text;
}

OrderedJson FailedAttemptsJson(const v1::JobStatus& job) {
  OrderedJson attempts = OrderedJson::array();
  for (const v1::TaskAttempt& attempt : job.failed_attempts()) attempts.push_back(AttemptToJson(attempt));
  return attempts;
}

}  // namespace

std::string JobStateName(v1::JobState state) {
  switch (state) {
    case v1::JOB_STATE_RUNNING:
      return "running";
    case v1::JOB_STATE_DONE:
      return "done";
    case v1::JOB_STATE_FAILED:
      return "failed";
    case v1::JOB_STATE_CANCELLED:
      return "cancelled";
    default:
      return "unknown";
  }
}

std::string StageName(const v1::StageStatus& stage) {
  const Result<TaskKind> kind = FromProto(stage.kind());
  return kind.ok() ? TaskKindName(*kind) : "unknown";
}

std::string FormatDuration(double seconds) {
  if (seconds < 1) return Format("%.0f ms", seconds * 1000);
  if (seconds < 60) return Format("%.1f s", seconds);
  const long whole = std::lround(seconds);
  if (whole < 3600) return Format("%ld min %02ld s", whole / 60, whole % 60);
  return Format("%ld h %02ld min", whole / 3600, whole % 3600 / 60);
}

std::string FormatRoughDuration(double seconds) {
  const long whole = std::lround(std::clamp(seconds, 0.0, 1e9));
  if (whole < 100) return Format("%ld s", whole);
  const long minutes = (whole + 30) / 60;
  if (minutes < 60) return Format("%ld min", minutes);
  return Format("%ld h %02ld min", minutes / 60, minutes % 60);
}

std::string FormatBytes(double bytes) {
  const std::array<const char*, 5> units = {"B", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  while (bytes >= 1024 && unit + 1 < units.size()) {
    bytes /= 1024;
    ++unit;
  }
  return Format(bytes < 10 && unit > 0 ? "%.1f %s" : "%.0f %s", bytes, units[unit]);
}

OrderedJson JobToJson(const v1::JobStatus& job) {
  OrderedJson stages = OrderedJson::array();
  for (const v1::StageStatus& stage : job.stages()) {
    stages.push_back(
        {{"stage", StageName(stage)},
         {"tasksDone", stage.tasks_done()},
         {"tasksTotal", stage.tasks_total()},
         {"cpuSeconds", stage.cpu_seconds()},
         {"wallSeconds", stage.wall_seconds()},
         {"peakMemoryBytes", stage.peak_memory_bytes()},
         {"fetchedBytes", stage.fetched_bytes()},
         {"sweeps", stage.sweeps()},
         {"reused", stage.reused()},
         {"leftAside", stage.left_aside()},
         {"firstLeftAside",
          stage.has_first_left_aside() ? OrderedJson(NameWithinJob(stage.first_left_aside())) : OrderedJson(nullptr)}});
  }
  OrderedJson error = nullptr;
  if (job.has_error() && job.error().code() != v1::CODE_OK) {
    error = {{"code", std::string(ErrorCodeName(FromProto(job.error()).code()))}, {"message", job.error().message()}};
  }
  return {{"job", job.job_id()},
          {"name", job.name()},
          {"state", JobStateName(job.state())},
          {"error", error},
          {"framesDone", job.frames_done()},
          {"framesTotal", job.frames_total()},
          {"elapsedSeconds", job.elapsed_seconds()},
          {"secondsLeft", job.has_seconds_left() ? OrderedJson(job.seconds_left()) : OrderedJson(nullptr)},
          {"priority", job.priority()},
          {"retries", job.retries()},
          {"duplicates", job.duplicates()},
          {"duplicatesWon", job.duplicates_won()},
          {"failedTask", job.has_failed_task() ? OrderedJson(NameWithinJob(job.failed_task())) : OrderedJson(nullptr)},
          {"failedAttempts", FailedAttemptsJson(job)},
          {"determinismViolations", job.determinism_violations()},
          {"summary", job.summary()},
          {"outputDir", job.output_dir()},
          {"keepsResults", job.keeps_results()},
          {"requiredTags", Words(job.required_tags())},
          {"algorithmVersion", job.algorithm_version()},
          {"lacksWorker", job.lacks_worker()},
          {"running", Words(job.running())},
          {"stages", stages}};
}

OrderedJson WorkerToJson(const v1::WorkerStatus& worker) {
  return {{"worker", worker.worker_id()},
          {"name", worker.name()},
          {"version", worker.software_version()},
          {"algorithmVersion", worker.algorithm_version()},
          {"running", worker.running()},
          {"tasks", worker.tasks()},
          {"slots", worker.slots()},
          {"draining", worker.draining()},
          {"tags", Words(worker.tags())},
          {"secondsSinceHeard", worker.seconds_since_heard()},
          {"tasksDone", worker.tasks_done()},
          {"artifacts", worker.artifacts()},
          {"artifactBytes", worker.artifact_bytes()}};
}

std::string FormatJob(const v1::JobStatus& job, BegunAnewBy anew) {
  std::string text = "job " + std::to_string(job.job_id()) + " '" + job.name() + "': " + JobStateName(job.state());
  text += ", " + FormatProgress(job) + "\n";
  if (job.has_error() && job.error().code() != v1::CODE_OK) text += "  reason: " + job.error().message() + "\n";
  if (!job.summary().empty()) text += "  " + job.summary() + "\n";
  text += "  output: " + OutputText(job) + "\n";
  text += ReusedText(job) + LeftAsideText(job);
  if (job.retries() > 0) text += "  retries: " + std::to_string(job.retries()) + "\n";
  text += DuplicatesText(job) + FailedTaskText(job, anew);
  if (job.determinism_violations() > 0) {
    text += "  DETERMINISM VIOLATIONS: " + std::to_string(job.determinism_violations()) +
            ": a task done twice gave different results; one of the hosts computes wrongly\n";
  }
  std::vector<std::vector<std::string>> rows = {
      {"  stage", "tasks", "CPU", "wall", "peak memory", "fetched", "reused"}};
  for (const v1::StageStatus& stage : job.stages()) {
    if (stage.tasks_total() == 0) continue;
    rows.push_back({"  " + StageName(stage),
                    std::to_string(stage.tasks_done()) + "/" + std::to_string(stage.tasks_total()),
                    FormatDuration(stage.cpu_seconds()), FormatDuration(stage.wall_seconds()),
                    FormatBytes(static_cast<double>(stage.peak_memory_bytes())),
                    FormatBytes(static_cast<double>(stage.fetched_bytes())), std::to_string(stage.reused())});
  }
  if (rows.size() > 1) text += FormatTable(rows, {false, true, true, true, true, true, true});
  if (job.lacks_worker()) {
    text += "  waits for a worker";
    if (job.required_tags_size() > 0) text += " with the tags " + Joined(job.required_tags());
    text += " of algorithm version " + std::to_string(job.algorithm_version()) + "\n";
  }
  for (const std::string& task : job.running()) text += "  running: " + task + "\n";
  return text;
}

std::string FormatJobs(const std::vector<v1::JobStatus>& jobs) {
  std::vector<std::vector<std::string>> rows = {{"job", "state", "frames", "elapsed", "priority", "name", "output"}};
  for (const v1::JobStatus& job : jobs) {
    rows.push_back({std::to_string(job.job_id()), JobStateName(job.state()), FramesText(job),
                    FormatDuration(job.elapsed_seconds()), std::to_string(job.priority()), job.name(),
                    job.keeps_results() ? "on the workers" : job.output_dir()});
  }
  return FormatTable(rows, {true, false, true, true, true, false, false});
}

std::string FormatWorkers(const std::vector<v1::WorkerStatus>& workers) {
  std::vector<std::vector<std::string>> rows = {
      {"worker", "name", "version", "algorithm", "heard", "done", "cache", "tasks", "tags", "running"}};
  for (const v1::WorkerStatus& worker : workers) {
    rows.push_back({std::to_string(worker.worker_id()), worker.name(), worker.software_version(),
                    std::to_string(worker.algorithm_version()), FormatDuration(worker.seconds_since_heard()) + " ago",
                    std::to_string(worker.tasks_done()), FormatBytes(static_cast<double>(worker.artifact_bytes())),
                    std::to_string(worker.tasks()) + "/" + std::to_string(worker.slots()), Joined(worker.tags()),
                    (worker.draining() ? "draining: " : "") + (worker.running().empty() ? "idle" : worker.running())});
  }
  return FormatTable(rows, {true, false, false, true, true, true, true, true, false, false});
}

std::string FormatProgress(const v1::JobStatus& job) {
  const TaskCount tasks = CountTasks(job);
  std::string text = UnitName(job) + " " + FramesText(job) + ", task " + std::to_string(tasks.done) + "/" +
                     std::to_string(tasks.total) + ", " + FormatDuration(job.elapsed_seconds());
  if (job.has_seconds_left()) text += ", about " + FormatRoughDuration(job.seconds_left()) + " left";
  return text;
}

}  // namespace depthfarm
