#ifndef DEPTHFARM_TESTS_COORDINATOR_SCHEDULING_FAKE_FARM_H_
#define DEPTHFARM_TESTS_COORDINATOR_SCHEDULING_FAKE_FARM_H_

#include <map>
#include <set>
#include <string>
#include <vector>

#include "coordinator/scheduling/scheduler.h"

namespace depthfarm {

// A worker as the scheduler sees one: takes tasks up to its room, holds artifacts in memory, does nothing by itself.
struct FakeWorker {
  WorkerId id;
  bool alive = true;  // false: silent, its store is gone
  std::map<LeaseId, Grant> running;
  std::map<ArtifactKey, ArtifactInfo> store;
  std::uint64_t asks = 0;
  std::uint64_t beats = 0;
  int slots = 1;
  int ahead = 0;
  std::uint64_t memory_bytes = 0;
  std::set<std::string> tags;
  std::uint32_t algorithm_version = kAlgorithmVersion;

  [[nodiscard]] bool HasRoom() const { return static_cast<int>(running.size()) < slots + ahead; }
};

// A farm in memory on a virtual clock: carries out the scheduler's actions and keeps what they were.
class FakeFarm {
 public:
  explicit FakeFarm(const SchedulerOptions& options = {}) : scheduler(options), lease_(options.lease) {}

  void Submit(const PlannedJob& job, int priority = 0, const std::set<std::string>& tags = {});
  // On a farm that remembers these frames of it.
  void Resume(const PlannedJob& job, const CommittedFrames& frames) {
    Send(JobSubmitted{job, "job", 0, {}, frames, true});
  }
  void Cancel(std::uint64_t job) { Send(JobCancelled{JobId(job)}); }

  WorkerId Join(int slots = 1, int ahead = 0);  // a new worker, which does not ask yet
  // One that asks until it has as many tasks as it takes, or there are no more.
  WorkerId JoinAndAsk(int slots = 1, int ahead = 0);
  void Rejoin(WorkerId worker);  // says Hello again with what it holds and runs
  void Ask(WorkerId worker);
  void Beat(WorkerId worker);
  void Kill(WorkerId worker) { At(worker).alive = false; }
  void Leave(WorkerId worker);
  void Drop(WorkerId worker, const ArtifactKey& key);
  // The end of a task that the worker runs, of the oldest by default: well if all its inputs can be fetched, else with
  // missing inputs. Asks again.
  void Finish(WorkerId worker) { Finish(worker, At(worker).running.begin()->first); }
  void Finish(WorkerId worker, LeaseId lease);
  void Fail(WorkerId worker, const Status& error);
  void Pass(Milliseconds time);  // no heartbeats
  void PassWithBeats(Milliseconds time);
  // Workers answer what they were asked to give back: tasks that no slot has begun go back.
  void AnswerAskedBack();
  // Works with all living workers until nothing is left to do.
  void RunToTheEnd();

  [[nodiscard]] FakeWorker& At(WorkerId worker) { return workers.at(worker); }
  // The oldest task that the worker runs now.
  [[nodiscard]] const Grant& Running(WorkerId worker) { return At(worker).running.begin()->second; }
  [[nodiscard]] bool IsIdle(WorkerId worker) { return At(worker).running.empty(); }
  [[nodiscard]] int CountNotes(const std::string& event) const;
  // How often a task of the kind and frame was granted.
  [[nodiscard]] int CountGrants(TaskKind kind, int frame) const;

  // Workers with room ask again for each grant.
  void Send(const Event& event);
  // What a worker that ran the task would report; its artifact and inputs enter its store.
  [[nodiscard]] TaskFinished ResultOf(FakeWorker& worker, const Grant& grant);
  [[nodiscard]] std::vector<ArtifactKey> MissingInputs(const FakeWorker& worker, const Grant& grant) const;

  Scheduler scheduler;
  TimePoint now{std::chrono::hours(1)};
  std::map<WorkerId, FakeWorker> workers;
  std::vector<Grant> grants;
  std::vector<Revoke> revokes;
  std::vector<AskBack> asked_back;
  bool answers_late = false;  // what is asked back waits for AnswerAskedBack
  bool stops_late = false;    // tasks that are revoked go on; else they end at once, and that is reported
  std::set<LeaseId> begun;    // whose tasks a slot took
  std::vector<Release> releases;
  std::vector<Keep> keeps;
  std::map<JobId, JobSnapshot> ended;
  std::map<LeaseId, AttemptEnded> attempts_ended;
  std::set<WorkerId> told_to_end;
  std::vector<Note> notes;
  std::map<JobId, CommittedFrames> committed;
  std::set<std::pair<JobId, std::string>> emitted;  // staging folders
  std::set<TaskId> left_aside;                      // tasks that tell so
  std::uint64_t artifact_bytes = 100;               // of an artifact, less than that and 256

 private:
  void Apply(const std::vector<Action>& actions);
  void Apply(const Grant& grant);
  void Apply(const AcknowledgeHeartbeat& answer);
  void Apply(const Revoke& revoke);
  void Apply(const AskBack& ask);
  void Apply(const Release& release) { releases.push_back(release); }
  void Apply(const Keep& keep) { keeps.push_back(keep); }
  void Apply(const ForgetJob&) {}
  void Apply(const JobEnded& event);
  void Apply(const FrameCommitted& event) { committed[event.job][event.frame] = event.committed; }
  void Apply(const AttemptEnded& end);
  void Apply(const FrameLost& event) { committed[event.job].erase(event.frame); }
  void Apply(const WorkerLost&) {}
  void Apply(const EndWorker& action) { told_to_end.insert(action.worker); }
  void Apply(const Note& note) { notes.push_back(note); }

  Milliseconds lease_;
  // A worker's slots take its tasks in the order of their leases.
  void BeginTasks();
  void Stop(WorkerId worker, LeaseId lease);
  void ReportStopped();

  std::vector<WorkerId> to_ask_;
  std::vector<AskBack> to_answer_;
  std::vector<TaskFailed> to_report_;
  std::uint64_t last_worker_ = 0;
};

// Runs tasks on one worker until it is given one of the kind.
const Grant& RunUntil(FakeFarm& farm, WorkerId worker, TaskKind kind);

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COORDINATOR_SCHEDULING_FAKE_FARM_H_
