#include "coordinator/service/status_wire.h"

#include <chrono>

#include "common/wire/task_wire.h"

namespace depthfarm {
namespace {

double Seconds(TimePoint::duration duration) { return std::chrono::duration<double>(duration).count(); }

// "frame 3 merge round 0 pair 1": the reader knows the job.
std::string NameWithinJob(const TaskId& task) {
  const std::string prefix = "job " + std::to_string(task.job.value()) + " ";
  return TaskName(task).substr(prefix.size());
}

}  // namespace

v1::JobState ToProto(JobState state) {
  switch (state) {
    case JobState::kRunning:
      return v1::JOB_STATE_RUNNING;
    case JobState::kDone:
      return v1::JOB_STATE_DONE;
    case JobState::kFailed:
      return v1::JOB_STATE_FAILED;
    case JobState::kCancelled:
      return v1::JOB_STATE_CANCELLED;
  }
  return v1::JOB_STATE_UNSPECIFIED;
}

v1::JobStatus StatusToProto(const JobSnapshot& job, const std::string& summary, TimePoint now) {
  v1::JobStatus status;
  status.set_job_id(job.id.value());
  status.set_name(job.name);
  status.set_state(ToProto(job.state));
  *status.mutable_error() = ToProto(job.error);
  status.set_frames_done(static_cast<std::uint32_t>(job.frames_done));
  status.set_frames_total(static_cast<std::uint32_t>(job.frames_total));
  for (int kind = 0; kind < kNumTaskKinds; ++kind) {
    const StageSnapshot& stage = job.stages[static_cast<std::size_t>(kind)];
    if (stage.tasks_total == 0) continue;
    v1::StageStatus* added = status.add_stages();
    added->set_kind(ToProto(static_cast<TaskKind>(kind)));
    added->set_tasks_done(stage.tasks_done);
    added->set_tasks_total(stage.tasks_total);
    added->set_cpu_seconds(stage.cpu_seconds);
    added->set_wall_seconds(stage.wall_seconds);
    added->set_peak_memory_bytes(stage.peak_memory_bytes);
    added->set_fetched_bytes(stage.fetched_bytes);
    added->set_sweeps(stage.sweeps);
    added->set_reused(stage.reused);
    added->set_left_aside(stage.left_aside);
    if (stage.first_left_aside) *added->mutable_first_left_aside() = ToProto(*stage.first_left_aside);
  }
  status.set_elapsed_seconds(Seconds((job.state == JobState::kRunning ? now : job.ended) - job.submitted));
  if (job.seconds_left && job.state == JobState::kRunning) status.set_seconds_left(*job.seconds_left);
  status.set_retries(job.retries);
  status.set_duplicates(job.duplicates);
  status.set_duplicates_won(job.duplicates_won);
  if (job.failed_task) *status.mutable_failed_task() = ToProto(*job.failed_task);
  for (const RunningTask& task : job.running) {
    status.add_running(NameWithinJob(task.task) + " on " + task.worker_name + (task.duplicate ? " (duplicate)" : ""));
  }
  status.set_output_dir(job.output_dir);
  status.set_keeps_results(job.keeps_results);
  status.set_summary(summary);
  status.set_determinism_violations(job.determinism_violations);
  status.set_priority(job.priority);
  for (const std::string& tag : job.tags) status.add_required_tags(tag);
  status.set_algorithm_version(job.algorithm_version);
  status.set_lacks_worker(job.lacks_worker && job.state == JobState::kRunning);
  return status;
}

v1::WorkerStatus StatusToProto(const WorkerSnapshot& worker, const WorkerSession* session, TimePoint now) {
  v1::WorkerStatus status;
  status.set_worker_id(worker.id.value());
  status.set_name(worker.name);
  if (session != nullptr) status.set_software_version(session->software_version);
  std::string running;
  for (const TaskId& task : worker.running) running += (running.empty() ? "" : ", ") + TaskName(task);
  status.set_running(running);
  status.set_slots(static_cast<std::uint32_t>(worker.slots));
  status.set_tasks(static_cast<std::uint32_t>(worker.running.size()));
  status.set_draining(worker.draining);
  for (const std::string& tag : worker.tags) status.add_tags(tag);
  status.set_algorithm_version(worker.algorithm_version);
  status.set_seconds_since_heard(Seconds(now - worker.last_heard));
  status.set_tasks_done(worker.tasks_done);
  status.set_artifacts(worker.artifacts);
  status.set_artifact_bytes(worker.artifact_bytes);
  return status;
}

}  // namespace depthfarm
