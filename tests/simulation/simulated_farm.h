#ifndef DEPTHFARM_TESTS_SIMULATION_SIMULATED_FARM_H_
#define DEPTHFARM_TESTS_SIMULATION_SIMULATED_FARM_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "coordinator/service/coordinator.h"
#include "tests/simulation/event_queue.h"
#include "tests/simulation/fault_plan.h"
#include "tests/simulation/network.h"
#include "tests/simulation/simulated_disk.h"
#include "tests/simulation/simulated_worker.h"
#include "tests/simulation/submitter.h"
#include "tests/simulation/tally.h"
#include "tests/support/random.h"

namespace depthfarm::simulation {

// A farm and those who use it, on one clock, from one seed: the real coordinator with its journal, the real lifecycle,
// wire messages and output folder of workers; network, disk of the journal, computing and stores are simulated.
class SimulatedFarm {
 public:
  struct Options {
    std::string scratch;  // an empty folder, for output
    CoordinatorOptions coordinator;
    std::vector<WorkerShape> workers;
    FaultPlan faults;
    bool narrates = false;     // to stderr
    bool checks_files = true;  // against those of a run in which nothing goes wrong
  };
  SimulatedFarm(std::uint64_t seed, const Options& options);
  SimulatedFarm(const SimulatedFarm&) = delete;
  SimulatedFarm& operator=(const SimulatedFarm&) = delete;

  // Somebody who submits these to a folder of the scratch folder.
  void AddSubmitter(const std::string& name, std::vector<Wish> wishes, Milliseconds pause);

  // Until all jobs have ended; what is wrong goes to problems().
  void Run();

  // What is not as it must be, with its time.
  [[nodiscard]] const std::vector<std::string>& problems() const { return problems_; }
  [[nodiscard]] const std::map<std::string, std::unique_ptr<Submitter>>& submitters() const { return submitters_; }
  [[nodiscard]] Tally tally() const;
  // Of every message that was sent, when and to whom: equal runs have equal ones.
  [[nodiscard]] std::uint64_t trace() const { return trace_; }
  // When a task of the job was first begun.
  [[nodiscard]] const std::map<JobId, TimePoint>& first_tasks() const { return first_tasks_; }
  [[nodiscard]] const EventQueue& events() const { return events_; }

 private:
  void StartCoordinator();
  void CrashCoordinator(SimulatedDisk::Loss loss);
  void TickCoordinator();
  void ToCoordinator(const std::string& peer, const std::string& payload);
  void Deliver();
  // Says what happens, if asked to; `message`: a serialised Envelope, or empty.
  void Narrate(const std::string& what, const std::string& message = "") const;
  void Trace(const std::string& to, const std::string& payload);

  void PlanFault(Milliseconds mean, void (SimulatedFarm::*fault)());
  void CrashWorker();
  void HangWorker();
  void SlowWorker();
  void CutNetwork();
  void LoseArtifacts();
  void ReplaceWorker();
  void CrashCoordinatorNow();
  void CrashCoordinatorInWrite();
  void RestartDeadWorkers();
  void BeCalm();
  [[nodiscard]] SimulatedWorker& AnyWorker();
  [[nodiscard]] Milliseconds Lease() const { return options_.coordinator.lease; }

  // farm_checks.cc: what must hold.
  void OnBegun(const SimulatedWorker& worker, LeaseId lease, const TaskSpec& spec);
  void OnEnd(const Submitter& submitter, const JobEnd& end);
  // The jobs that have ended when things stop going wrong: their submitters may hear of it later.
  void NoteEndedInChaos();
  void CheckFolder(const Submitter& submitter, const JobEnd& end, bool last_look);
  // Of this life of the coordinator, which ends; `last`: when all is over.
  void CheckAttempts(bool last);
  // That each lease that was granted has ended once, or, before the last look, not yet; and that nothing is wanted at
  // last.
  void CheckMetrics(bool last);
  void CheckAttemptsOf(const v1::JobStatus& job, bool last);
  // At the beginning of a life: that all is there that the one before wrote.
  void CheckJournal(const Journal& journal);
  void CheckJobList();
  void CheckNothingIsLeft();
  void Problem(const std::string& text);

  const Options options_;
  test::Random random_;
  EventQueue events_;
  Network network_;
  TaskFaults task_faults_;
  Surroundings around_;
  SimulatedDisk disk_;
  std::unique_ptr<Coordinator> coordinator_;
  std::uint64_t coordinators_ = 0;
  bool calm_ = false;
  bool restarting_ = true;  // workers that ended
  std::vector<std::unique_ptr<SimulatedWorker>> workers_;
  std::map<std::string, std::unique_ptr<Submitter>> submitters_;
  std::map<JobId, TimePoint> first_tasks_;
  std::set<LeaseId> duplicates_;  // that the coordinator said to be such
  std::uint64_t granted_ = 0;     // leases, in this life of the coordinator
  std::map<TaskId, int> deaths_;  // of workers, by poisonous tasks
  using JobAndFrame = std::pair<std::uint64_t, int>;
  std::set<JobAndFrame> remembered_;        // frames that the journal had when the coordinator began
  std::set<JobAndFrame> written_;           // that the life before must have written
  std::set<std::uint64_t> ended_in_chaos_;  // jobs; with those whose Cleanup was begun there
  std::set<std::uint64_t> cleaned_up_;      // jobs whose Cleanup was done in their newest run
  std::vector<std::string> problems_;
  std::uint64_t trace_ = 0;
  Tally tally_;
};

// The files that such a job leaves in its folder, relative to it, with their content; from a run in which nothing goes
// wrong. Of a job that keeps its results there are none.
using FolderContent = std::map<std::string, std::string>;
[[nodiscard]] const FolderContent& ExpectedFiles(const JobKind& kind, const std::string& scratch);
[[nodiscard]] FolderContent ReadFolder(const std::string& folder);

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_SIMULATED_FARM_H_
