#include "coordinator/cli/logs_report.h"

#include <sstream>
#include <vector>

#include "common/text/text_table.h"
#include "common/wire/envelope.h"
#include "common/wire/task_wire.h"
#include "coordinator/cli/report.h"

namespace depthfarm {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::string CodeOf(const v1::TaskAttempt& attempt) {
  return attempt.has_error() ? std::string(ErrorCodeName(FromProto(attempt.error()).code())) : "";
}

std::string OutcomeText(const v1::TaskAttempt& attempt) {
  const std::string name = OutcomeName(attempt.outcome());
  return attempt.outcome() == v1::ATTEMPT_OUTCOME_FAILED ? name + ": " + CodeOf(attempt) : name;
}

// Its worker told; else it is the time from the grant on.
double WallSeconds(const v1::TaskAttempt& attempt) {
  return attempt.stats().wall_seconds() > 0 ? attempt.stats().wall_seconds() : attempt.seconds();
}

std::vector<std::string> RowOf(const v1::TaskAttempt& attempt) {
  const v1::TaskStats& stats = attempt.stats();
  const auto bytes = [](std::uint64_t count) { return count == 0 ? "-" : FormatBytes(static_cast<double>(count)); };
  return {NameWithinJob(attempt.task()),
          attempt.worker(),
          std::to_string(attempt.attempt()) + (attempt.duplicate() ? "+" : ""),
          FormatDuration(attempt.started_seconds()),
          FormatDuration(WallSeconds(attempt)),
          stats.cpu_seconds() > 0 ? FormatDuration(stats.cpu_seconds()) : "-",
          bytes(stats.peak_memory_bytes()),
          bytes(stats.fetched_bytes()),
          OutcomeText(attempt)};
}

}  // namespace

std::string NameWithinJob(const v1::TaskId& task_id) {
  const Result<TaskId> task = FromProto(task_id);
  if (!task.ok()) return "unknown";
  const std::string prefix = "job " + std::to_string(task->job.value()) + " ";
  return TaskName(*task).substr(prefix.size());
}

std::string NotesOf(const v1::TaskAttempt& attempt) {
  std::string text;
  if (attempt.has_error() && !attempt.error().message().empty())
    text += "    reason: " + attempt.error().message() + "\n";
  if (attempt.log().left_out() > 0) text += "    | (" + std::to_string(attempt.log().left_out()) + " lines before)\n";
  for (const std::string& line : attempt.log().lines()) text += "    | " + line + "\n";
  return text;
}

std::string OutcomeName(v1::AttemptOutcome outcome) {
  switch (outcome) {
    case v1::ATTEMPT_OUTCOME_RUNNING:
      return "running";
    case v1::ATTEMPT_OUTCOME_DONE:
      return "done";
    case v1::ATTEMPT_OUTCOME_REUSED:
      return "reused";
    case v1::ATTEMPT_OUTCOME_FAILED:
      return "failed";
    case v1::ATTEMPT_OUTCOME_GIVEN_BACK:
      return "given back";
    case v1::ATTEMPT_OUTCOME_REVOKED:
      return "revoked";
    case v1::ATTEMPT_OUTCOME_OVERTAKEN:
      return "overtaken";
    case v1::ATTEMPT_OUTCOME_EXPIRED:
      return "lease expired";
    case v1::ATTEMPT_OUTCOME_WORKER_LOST:
      return "worker lost";
    default:
      return "unknown";
  }
}

std::string FormatLogs(const v1::JobLogs& logs) {
  std::string text;
  if (logs.forgotten() > 0)
    text += WithThousands(logs.forgotten()) + " older attempts of the job are not kept any more\n";
  if (logs.attempts().empty()) return text + "no attempts\n";
  std::vector<std::vector<std::string>> rows = {
      {"task", "worker", "try", "start", "wall", "CPU", "peak memory", "fetched", "outcome"}};
  for (const v1::TaskAttempt& attempt : logs.attempts()) rows.push_back(RowOf(attempt));
  std::istringstream table(FormatTable(rows, {false, false, true, true, true, true, true, true, false}));
  std::string line;
  std::getline(table, line);
  text += line + "\n";
  for (const v1::TaskAttempt& attempt : logs.attempts()) {
    std::getline(table, line);
    text += line + "\n" + NotesOf(attempt);
  }
  return text;
}

OrderedJson AttemptToJson(const v1::TaskAttempt& attempt) {
  OrderedJson error = nullptr;
  if (attempt.has_error()) error = {{"code", CodeOf(attempt)}, {"message", attempt.error().message()}};
  return {{"task", NameWithinJob(attempt.task())},
          {"worker", attempt.worker()},
          {"attempt", attempt.attempt()},
          {"duplicate", attempt.duplicate()},
          {"startSeconds", attempt.started_seconds()},
          {"seconds", attempt.seconds()},
          {"wallSeconds", attempt.stats().wall_seconds()},
          {"cpuSeconds", attempt.stats().cpu_seconds()},
          {"peakMemoryBytes", attempt.stats().peak_memory_bytes()},
          {"fetchedBytes", attempt.stats().fetched_bytes()},
          {"outcome", OutcomeName(attempt.outcome())},
          {"error", error},
          {"log", std::vector<std::string>(attempt.log().lines().begin(), attempt.log().lines().end())},
          {"logLinesLeftOut", attempt.log().left_out()}};
}

OrderedJson LogsToJson(const v1::JobLogs& logs) {
  OrderedJson attempts = OrderedJson::array();
  for (const v1::TaskAttempt& attempt : logs.attempts()) attempts.push_back(AttemptToJson(attempt));
  return {{"job", logs.job_id()}, {"attemptsForgotten", logs.forgotten()}, {"attempts", attempts}};
}

}  // namespace depthfarm
