// What the coordinator tells of itself in numbers.
#include "common/job/estimation_params.h"
#include "common/job/task.h"
#include "coordinator/service/coordinator.h"

namespace depthfarm {
namespace {

const char* Word(AttemptOutcome outcome) {
  switch (outcome) {
    case AttemptOutcome::kRunning:
      return "running";
    case AttemptOutcome::kDone:
      return "done";
    case AttemptOutcome::kReused:
      return "reused";
    case AttemptOutcome::kFailed:
      return "failed";
    case AttemptOutcome::kGivenBack:
      return "given back";
    case AttemptOutcome::kRevoked:
      return "revoked";
    case AttemptOutcome::kExpired:
      return "expired";
    case AttemptOutcome::kWorkerLost:
      return "worker lost";
    case AttemptOutcome::kOvertaken:
      return "overtaken";
  }
  return "unknown";
}

}  // namespace

void Coordinator::Count(const AttemptEnded& action, const TaskStats& stats) {
  const std::string kind = TaskKindName(action.task.kind);
  ++attempts_ended_[{kind, Word(action.outcome)}];
  if (action.outcome == AttemptOutcome::kDone || action.outcome == AttemptOutcome::kReused) {
    cpu_seconds_[kind] += stats.cpu_seconds;
  }
}

FarmMetrics Coordinator::Metrics() const {
  FarmMetrics metrics;
  metrics.algorithm_version = kAlgorithmVersion;
  metrics.protocol_version = static_cast<int>(kProtocolVersion);
  metrics.jobs_running = jobs_.size();
  metrics.jobs_ended = jobs_ended_;
  const Backlog backlog = scheduler_.TotalBacklog();
  metrics.tasks_leased = backlog.leased;
  metrics.tasks_ready = backlog.ready;
  metrics.gops_unopened = backlog.unopened_gops;
  for (const WorkerSnapshot& worker : scheduler_.Workers()) {
    ++metrics.workers;
    metrics.workers_draining += worker.draining ? 1 : 0;
    metrics.slots += worker.draining ? 0 : static_cast<std::uint64_t>(worker.slots);
    metrics.artifacts += worker.artifacts;
    metrics.artifact_bytes += worker.artifact_bytes;
  }
  metrics.attempts = attempts_ended_;
  metrics.cpu_seconds = cpu_seconds_;
  metrics.late_results = scheduler_.late_results();
  metrics.refused = {{"message malformed", refusals_.malformed},
                     {"message of another version", refusals_.other_version},
                     {"message of a wrong role", refusals_.wrong_role}};
  return metrics;
}

}  // namespace depthfarm
