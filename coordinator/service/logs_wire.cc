#include "coordinator/service/logs_wire.h"

#include <chrono>
#include <deque>
#include <optional>
#include <utility>

#include "common/wire/task_wire.h"
#include "coordinator/service/task_filter.h"

namespace depthfarm {
namespace {

constexpr int kMostAttempts = 1000;
constexpr std::size_t kMostBytes = std::size_t{4} << 20;
constexpr std::size_t kAttemptsOfStatus = 8;
constexpr std::size_t kLogBytesOfStatus = 2048;  // of each

double Seconds(TimePoint::duration duration) { return std::chrono::duration<double>(duration).count(); }

v1::AttemptOutcome ToProto(AttemptOutcome outcome) {
  switch (outcome) {
    case AttemptOutcome::kRunning:
      return v1::ATTEMPT_OUTCOME_RUNNING;
    case AttemptOutcome::kDone:
      return v1::ATTEMPT_OUTCOME_DONE;
    case AttemptOutcome::kReused:
      return v1::ATTEMPT_OUTCOME_REUSED;
    case AttemptOutcome::kFailed:
      return v1::ATTEMPT_OUTCOME_FAILED;
    case AttemptOutcome::kGivenBack:
      return v1::ATTEMPT_OUTCOME_GIVEN_BACK;
    case AttemptOutcome::kRevoked:
      return v1::ATTEMPT_OUTCOME_REVOKED;
    case AttemptOutcome::kOvertaken:
      return v1::ATTEMPT_OUTCOME_OVERTAKEN;
    case AttemptOutcome::kExpired:
      return v1::ATTEMPT_OUTCOME_EXPIRED;
    case AttemptOutcome::kWorkerLost:
      return v1::ATTEMPT_OUTCOME_WORKER_LOST;
  }
  return v1::ATTEMPT_OUTCOME_UNSPECIFIED;
}

v1::TaskAttempt ToProto(const AttemptRecord& record, TimePoint submitted, TimePoint now) {
  v1::TaskAttempt attempt;
  *attempt.mutable_task() = ToProto(record.task);
  attempt.set_worker(record.worker_name);
  attempt.set_attempt(static_cast<std::uint32_t>(record.attempt));
  attempt.set_duplicate(record.duplicate);
  attempt.set_started_seconds(Seconds(record.started - submitted));
  attempt.set_seconds(Seconds((record.outcome == AttemptOutcome::kRunning ? now : record.ended) - record.started));
  attempt.set_outcome(ToProto(record.outcome));
  if (!record.error.ok()) *attempt.mutable_error() = ToProto(record.error);
  *attempt.mutable_stats() = ToProto(record.stats);
  if (!record.log.lines.empty() || record.log.left_out > 0) *attempt.mutable_log() = ToProto(record.log);
  return attempt;
}

}  // namespace

Result<v1::JobLogs> LogsToProto(const AttemptRecords& records, const v1::GetJobLogs& request, TimePoint submitted,
                                TimePoint now) {
  DEPTHFARM_ASSIGN_OR_RETURN(const TaskFilter filter, TaskFilter::Parse(request.task()));
  const JobId job(request.job_id());
  v1::JobLogs logs;
  logs.set_job_id(request.job_id());
  logs.set_forgotten(records.Forgotten(job));
  std::size_t bytes = 0;
  const std::optional<LeaseId> last = records.ForEach(
      job, LeaseId(request.after()), [&](const TaskId& task) { return filter.Matches(task); },
      [&](const AttemptRecord& record) {
        if (logs.attempts_size() == kMostAttempts) return false;
        v1::TaskAttempt attempt = ToProto(record, submitted, now);
        bytes += attempt.ByteSizeLong();
        if (bytes > kMostBytes && logs.attempts_size() > 0) return false;
        *logs.add_attempts() = std::move(attempt);
        return true;
      });
  logs.set_next(last ? last->value() : 0);
  return logs;
}

void AddFailedAttempts(const AttemptRecords& records, const TaskId& task, TimePoint submitted, TimePoint now,
                       v1::JobStatus& status) {
  std::deque<AttemptRecord> last;
  (void)records.ForEach(
      task.job, LeaseId(0), [&](const TaskId& other) { return other == task; },
      [&](const AttemptRecord& record) {
        if (!record.failed()) return true;
        last.push_back(record);
        if (last.size() > kAttemptsOfStatus) last.pop_front();
        return true;
      });
  for (AttemptRecord& record : last) {
    std::vector<std::string>& lines = record.log.lines;
    std::size_t bytes = 0;
    std::size_t kept = 0;
    while (kept < lines.size() && bytes + lines[lines.size() - 1 - kept].size() <= kLogBytesOfStatus)
      bytes += lines[lines.size() - 1 - kept++].size();
    record.log.left_out += lines.size() - kept;
    lines.erase(lines.begin(), lines.end() - static_cast<std::ptrdiff_t>(kept));
    *status.add_failed_attempts() = ToProto(record, submitted, now);
  }
}

}  // namespace depthfarm
