#ifndef DEPTHFARM_COORDINATOR_SERVICE_ATTEMPT_RECORDS_H_
#define DEPTHFARM_COORDINATOR_SERVICE_ATTEMPT_RECORDS_H_

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/scheduling/actions.h"

namespace depthfarm {

// One lease of a task, from its grant on.
struct AttemptRecord {
  // Whether the attempt failed, or its worker was lost with it.
  [[nodiscard]] bool failed() const;

  TaskId task;
  WorkerId worker;
  std::string worker_name;
  int attempt = 1;
  bool duplicate = false;  // beside one that took too long
  TimePoint started;
  TimePoint ended;  // unless it is running
  AttemptOutcome outcome = AttemptOutcome::kRunning;
  Status error;
  TaskStats stats;  // as its worker told
  TaskLog log;
};

struct AttemptBounds {
  std::size_t well_of_job = 10'000;       // attempts of one job that did not fail, the newest
  std::size_t failed_of_job = 100'000;    // that did
  std::size_t in_all = 250'000;           // of all jobs; the oldest go, first those that did not fail
  std::size_t text_bytes = 64ULL << 20U;  // of log lines and reasons of all jobs; the oldest go
};

// What happened to the tasks of the jobs that the coordinator knows, attempt by attempt. Bounded; how many attempts of
// a job were forgotten is told. Not thread-safe.
class AttemptRecords {
 public:
  explicit AttemptRecords(const AttemptBounds& bounds = {}) : bounds_(bounds) {}

  void Begin(LeaseId lease, AttemptRecord attempt);
  // What a worker tells at the end of a task; nothing unless that worker has the lease and it did not end.
  void Report(WorkerId worker, LeaseId lease, const TaskId& task, const TaskStats& stats, TaskLog log);
  // Last words, where there are any, take the place of the log. Returns what the attempt used, if its worker told.
  TaskStats End(const AttemptEnded& end, TimePoint now);
  // Forgets the jobs that are not known any more.
  void KeepJobs(const std::function<bool(JobId)>& known);

  // Attempts of a job in the order of their grants, which is that of their leases: those after `after` that `wanted`
  // takes, as many as `take` takes (false: no more). Returns the lease to go on after; nothing when there is no more.
  using Take = std::function<bool(const AttemptRecord&)>;
  [[nodiscard]] std::optional<LeaseId> ForEach(JobId job, LeaseId after,
                                               const std::function<bool(const TaskId&)>& wanted,
                                               const Take& take) const;
  // How many attempts of the job are not kept any more.
  [[nodiscard]] std::uint64_t Forgotten(JobId job) const;
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  using LeaseQueue = std::deque<LeaseId>;  // in the order of their ends
  struct OfJob {
    std::map<LeaseId, AttemptRecord> attempts;
    LeaseQueue well;
    LeaseQueue failed;
    std::uint64_t forgotten = 0;
  };
  void ForgetOldest(OfJob& job, LeaseQueue& queue);
  void ForgetTexts();
  void ForgetAttempts();

  const AttemptBounds bounds_;
  std::map<JobId, OfJob> jobs_;
  std::map<LeaseId, JobId> running_;
  std::size_t size_ = 0;
  std::size_t text_bytes_ = 0;
  std::deque<std::pair<JobId, LeaseId>> with_text_;  // in the order of their ends; some may be forgotten
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_ATTEMPT_RECORDS_H_
