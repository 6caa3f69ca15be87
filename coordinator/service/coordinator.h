#ifndef DEPTHFARM_COORDINATOR_SERVICE_COORDINATOR_H_
#define DEPTHFARM_COORDINATOR_SERVICE_COORDINATOR_H_

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/status.h"
#include "common/transport/farm_keys.h"
#include "common/transport/server_channel.h"
#include "common/wire/envelope.h"
#include "coordinator/journal/journal.h"
#include "coordinator/metrics/farm_metrics.h"
#include "coordinator/planning/job_plan.h"
#include "coordinator/scheduling/scheduler.h"
#include "coordinator/service/attempt_records.h"
#include "coordinator/service/job_history.h"
#include "coordinator/service/note_pace.h"
#include "coordinator/service/refusals.h"
#include "coordinator/service/status_waits.h"
#include "coordinator/service/worker_sessions.h"

namespace depthfarm {

struct CoordinatorOptions {
  std::string endpoint = "tcp://127.0.0.1:7700";
  std::string keys_dir = {};  // empty: no CURVE (ipc, or `insecure` on loopback)
  bool insecure = false;
  std::chrono::milliseconds heartbeat{1000};
  std::chrono::milliseconds lease{6000};
  int max_attempts = 4;          // of one task
  std::string metrics = {};      // HOST:PORT to serve them at; empty: nowhere
  std::string version = {};      // of the program, for the metrics
  bool duplicates = true;        // tasks that take too long go to a second worker, too
  std::string journal = {};      // file in which jobs outlive the coordinator; empty: they do not
  std::size_t kept_jobs = 1000;  // that ended, for status

  // kInvalidArgument: heartbeat 10..60000 ms, lease at least 3 heartbeats and at most 1 h, attempts 1..100, kept jobs
  // 1 to 20,000.
  [[nodiscard]] Status Validate() const;
};

// A message for a worker or a client.
struct OutgoingMessage {
  std::string peer;  // PeerMessage::peer
  v1::Envelope envelope;
};

// What the daemon is without its socket: carries out what the scheduler decides, keeps the journal, answers clients.
// Holds no socket, thread or clock; times passed to it never go back. The rules of the wire: proto/PROTOCOL.md.
class Coordinator {
 public:
  // `first_lease`: a lease number that no earlier coordinator of the same workers used. `secure`: peers are
  // authenticated, messages carry their users. Requires options.Validate().
  Coordinator(const CoordinatorOptions& options, std::uint64_t first_lease, std::unique_ptr<Journal> journal,
              bool secure);

  // Goes on with the jobs of the journal. Once, before anything else. Errors: those of the journal.
  [[nodiscard]] Status Restore(TimePoint now);
  void Handle(const PeerMessage& message, TimePoint now);
  // The keys that may come were replaced: workers whose key is not one of a worker any more are told so and to stop,
  // and their tasks go back without a failed attempt. The number of these workers.
  int DropUnlisted(const AllowedKeys& allowed, TimePoint now);
  // Does what is due: leases that ran out, jobs that end.
  void Tick(TimePoint now);
  // Logs how much was not logged in the minutes that are over at `now`, or without it until now.
  void LogLeftOut(std::optional<TimePoint> now);
  // What is to be sent, in order; empty until the next call that makes some.
  [[nodiscard]] std::vector<OutgoingMessage> TakeOutgoing() { return std::exchange(outgoing_, {}); }

  [[nodiscard]] const MessageRefusals& refusals() const { return refusals_; }
  // Whether a client asked for the end.
  [[nodiscard]] bool asked_to_stop() const { return asked_to_stop_; }
  // Tells the workers to stop.
  void SayGoodbye();
  [[nodiscard]] const Scheduler& scheduler() const { return scheduler_; }
  // All but what only the socket knows: refused handshakes, version.
  [[nodiscard]] FarmMetrics Metrics() const;

 private:
  void HandleFromWorker(const PeerMessage& message, const v1::Envelope& envelope);
  void HandleFromClient(const PeerMessage& message, const v1::Envelope& envelope);
  void HandleHello(const PeerMessage& message, const v1::WorkerHello& hello);
  void HandleDied(const PeerMessage& message, const v1::WorkerDied& died);
  void HandleTaskFinished(WorkerId worker, const v1::TaskFinished& message);
  [[nodiscard]] Result<v1::Envelope> Answer(const v1::Envelope& request);
  [[nodiscard]] Result<v1::Envelope> Submit(const v1::SubmitJob& request);
  [[nodiscard]] Result<v1::Envelope> Retry(JobId id);
  [[nodiscard]] Result<v1::Envelope> StatusOf(JobId id) const;
  // Whether GetJobStatus is to be answered later, when its job has ended; notes it if so.
  [[nodiscard]] bool Waits(const PeerMessage& message, const v1::Envelope& question);
  void AnswerThoseThatWait(const std::vector<StatusWaits::Question>& questions);
  // With the attempts of the task that it failed with.
  [[nodiscard]] v1::JobStatus FullStatus(const JobSnapshot& job) const;
  [[nodiscard]] Result<v1::Envelope> ResultsOf(const v1::GetResults& request) const;
  [[nodiscard]] Result<v1::Envelope> LogsOf(const v1::GetJobLogs& request) const;
  [[nodiscard]] Result<v1::Envelope> Cancel(JobId id);
  [[nodiscard]] Result<v1::Envelope> Drain(const std::string& name);
  [[nodiscard]] v1::Envelope ListJobs(const v1::ListJobs& request) const;
  [[nodiscard]] v1::Envelope ListWorkers() const;
  [[nodiscard]] Result<v1::Envelope> BacklogOf(const v1::GetBacklog& request) const;

  // coordinator_journal.cc
  [[nodiscard]] Status RestoreEnded(const JournaledJob& job);
  // Plans a job of the journal again and lets it go on from its committed frames.
  [[nodiscard]] Status GoOn(const JournaledJob& job, bool workers_are_here);
  [[nodiscard]] static Result<PlannedJob> PlanAgain(const JournaledJob& job);
  // What the journal has of a job, less what no worker holds, if they are here.
  [[nodiscard]] Result<CommittedFrames> FramesInPlace(const PlannedJob& job, bool workers_are_here) const;
  void Start(PlannedJob job, const v1::SubmitJob& submission, std::set<std::string> tags, CommittedFrames committed,
             bool ran_before);

  void Dispatch(const Event& event);
  void CarryOut(const std::vector<Action>& actions);
  void Do(const Grant& action);
  void Do(const AcknowledgeHeartbeat& action);
  void Do(const Revoke& action);
  void Do(const AskBack& action);
  void Do(const Release& action);
  void Do(const Keep& action);
  void Do(const ForgetJob& action);
  void Do(const FrameCommitted& action);
  void Do(const FrameLost& action);
  void Do(const JobEnded& action);
  void Do(const AttemptEnded& action);
  void Do(const WorkerLost& action);
  void Do(const EndWorker& action);
  void Do(const Note& action);

  // coordinator_metrics.cc
  void Count(const AttemptEnded& action, const TaskStats& stats);

  void Send(const std::string& peer, v1::Envelope envelope);
  void SendTo(WorkerId worker, v1::Envelope envelope);
  void Refuse(const PeerMessage& message, std::uint64_t request_id, const Status& reason);
  void CountRefusal(std::uint64_t& counter, const std::string& user, const Status& reason);

  const CoordinatorOptions options_;
  const bool secure_;
  bool asked_to_stop_ = false;
  TimePoint now_;  // of the message being handled
  std::vector<OutgoingMessage> outgoing_;

  Scheduler scheduler_;
  WorkerSessions workers_;
  struct KnownJob {
    v1::JobConfig config;  // as it is sent with first grants
    std::string summary;
  };
  std::map<JobId, KnownJob> jobs_;
  JobHistory history_;
  std::unique_ptr<Journal> journal_;
  std::map<JobId, v1::JobConfig> kept_configs_;  // of jobs of the history that keep their results
  // Of the jobs that ran since the coordinator was started: when each was submitted, what became of its attempts.
  std::map<JobId, TimePoint> submitted_;
  AttemptRecords attempts_;
  StatusWaits status_waits_;
  MessageRefusals refusals_;
  NotePace note_pace_;
  // Since the start, see FarmMetrics.
  std::map<std::string, std::uint64_t> jobs_ended_;
  std::map<std::pair<std::string, std::string>, std::uint64_t> attempts_ended_;
  std::map<std::string, double> cpu_seconds_;
  std::uint64_t last_job_ = 0;
  std::uint64_t last_claim_;  // counted from the first lease on: no other coordinator has used it
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_COORDINATOR_H_
