#include "tests/simulation/simulated_farm.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "common/digest/sha256.h"
#include "common/wire/digest_wire.h"
#include "common/wire/envelope.h"
#include "common/wire/task_wire.h"

namespace depthfarm::simulation {
namespace {

namespace fs = std::filesystem;

constexpr Milliseconds kTick{200};
constexpr Milliseconds kSettle{120'000};
// After the last fault: one worker may have a dozen jobs of long tasks to do.
constexpr std::chrono::hours kPatience{4};
constexpr const char* kCoordinator = "coordinator";
constexpr int kPatientAttempts = 50;  // so many failures of one task do not come by chance

std::string HostOf(const std::string& peer) { return peer.substr(0, peer.find('#')); }

}  // namespace

void Tally::Add(const Tally& other) {
  runs += other.runs;
  attempts += other.attempts;
  messages += other.messages;
  messages_lost += other.messages_lost;
  worker_crashes += other.worker_crashes;
  standstills += other.standstills;
  cuts += other.cuts;
  store_losses += other.store_losses;
  coordinator_crashes += other.coordinator_crashes;
  torn_writes += other.torn_writes;
  late_results += other.late_results;
  asked_back += other.asked_back;
  given_back += other.given_back;
  jobs_done += other.jobs_done;
  jobs_ended_otherwise += other.jobs_ended_otherwise;
  hours += other.hours;
  longest_end = std::max(longest_end, other.longest_end);
}

SimulatedFarm::SimulatedFarm(std::uint64_t seed, const Options& options)
    : options_(options),
      random_(seed),
      network_(events_, random_, options.faults.network),
      task_faults_(options.faults.tasks),
      around_{.events = events_,
              .random = random_,
              .network = network_,
              .faults = task_faults_,
              .send =
                  [this](const std::string& host, const std::string& peer, std::string payload) {
                    Trace(kCoordinator, payload);
                    network_.Send(host, kCoordinator, [this, host, peer, payload = std::move(payload)] {
                      // What waits in a socket goes through the connection that is there then.
                      const auto worker = std::ranges::find(workers_, host, [](const auto& w) { return w->name(); });
                      ToCoordinator(random_.Chance(50) ? (*worker)->peer() : peer, payload);
                    });
                  },
              .find = [this](const std::string& endpoint) -> const SimulatedWorker* {
                const auto worker =
                    std::ranges::find(workers_, endpoint, [](const auto& each) { return each->endpoint(); });
                return worker == workers_.end() ? nullptr : worker->get();
              },
              .begun = [this](const SimulatedWorker& worker, LeaseId lease,
                              const TaskSpec& spec) { OnBegun(worker, lease, spec); }},
      disk_(seed) {
  for (const WorkerShape& shape : options.workers) {
    const std::string name = "w" + std::to_string(workers_.size() + 1);
    workers_.push_back(std::make_unique<SimulatedWorker>(name, shape, around_));
  }
}

void SimulatedFarm::AddSubmitter(const std::string& name, std::vector<Wish> wishes, Milliseconds pause) {
  auto submitter = std::make_unique<Submitter>(
      name, options_.scratch + "/" + name, std::move(wishes), events_,
      [this, name](std::string payload) {
        Trace(kCoordinator, payload);
        network_.Send(name, kCoordinator, [this, name, payload = std::move(payload)] { ToCoordinator(name, payload); });
      },
      [this, name](const JobEnd& end) { OnEnd(*submitters_.at(name), end); });
  submitter->Start(pause);
  submitters_[name] = std::move(submitter);
}

// ---- the coordinator ----

void SimulatedFarm::StartCoordinator() {
  if (coordinator_) return;
  ++coordinators_;
  if (!calm_ && options_.faults.journal_crashes.count() > 0 && random_.Chance(20)) disk_.DieAtWrite(random_.Int(1, 12));
  Result<std::unique_ptr<Journal>> journal =
      Journal::Open("journal", {.kept_jobs = options_.coordinator.kept_jobs, .vfs = disk_.vfs()});
  Status started = journal.status();
  if (journal.ok()) {
    coordinator_ = std::make_unique<Coordinator>(options_.coordinator, coordinators_ * kLeasesOfCoordinator + 1,
                                                 std::move(journal).value(), false);
    started = coordinator_->Restore(events_.now());
  }
  if (disk_.dead()) {
    ++tally_.torn_writes;
    CrashCoordinator(options_.faults.power_fails ? SimulatedDisk::Loss::kPower : SimulatedDisk::Loss::kProcess);
    return;
  }
  if (!started.ok()) {
    Problem("the coordinator does not start: " + started.message());
    return;
  }
  for (const auto& worker : workers_) worker->Reconnect();
  Deliver();
}

void SimulatedFarm::CrashCoordinator(SimulatedDisk::Loss loss) {
  ++tally_.coordinator_crashes;
  Narrate("the coordinator crashes");
  if (coordinator_) tally_.late_results += coordinator_->scheduler().late_results();
  disk_.Die();
  coordinator_.reset();
  disk_.Restart(loss);
  events_.After(Milliseconds(random_.Int(100, 15'000)), [this] { StartCoordinator(); });
}

void SimulatedFarm::TickCoordinator() {
  if (coordinator_) {
    coordinator_->Tick(events_.now());
    Deliver();
  }
  events_.After(kTick, [this] { TickCoordinator(); });
}

void SimulatedFarm::ToCoordinator(const std::string& peer, const std::string& payload) {
  if (!coordinator_) return;
  Narrate(peer + " -> coordinator: ", payload);
  coordinator_->Handle({peer, "", payload}, events_.now());
  Deliver();
}

void SimulatedFarm::Deliver() {
  if (disk_.dead()) {  // it ended before it could say anything of this
    ++tally_.torn_writes;
    CrashCoordinator(options_.faults.power_fails ? SimulatedDisk::Loss::kPower : SimulatedDisk::Loss::kProcess);
    return;
  }
  for (OutgoingMessage& message : coordinator_->TakeOutgoing()) {
    tally_.asked_back += message.envelope.has_give_back_task() ? 1 : 0;
    const std::string payload = SerializeEnvelope(std::move(message.envelope));
    const std::string host = HostOf(message.peer);
    Trace(host, payload);
    Narrate("coordinator -> " + message.peer + ": ", payload);
    if (const auto submitter = submitters_.find(host); submitter != submitters_.end()) {
      network_.Send(kCoordinator, host, [to = submitter->second.get(), payload] { to->Receive(payload); });
      continue;
    }
    const auto worker = std::ranges::find(workers_, host, [](const auto& each) { return each->name(); });
    if (worker == workers_.end()) continue;
    network_.Send(kCoordinator, host,
                  [to = worker->get(), peer = message.peer, payload] { to->Receive(peer, payload); });
  }
}

void SimulatedFarm::Narrate(const std::string& what, const std::string& message) const {
  if (!options_.narrates) return;
  constexpr std::size_t kMostBytes = 200;
  const auto ms = std::chrono::duration_cast<Milliseconds>(events_.now().time_since_epoch()).count();
  std::string line = std::to_string(ms) + " ms: " + what;
  if (!message.empty()) line += ParseEnvelope(message).value().ShortDebugString().substr(0, kMostBytes);
  std::fprintf(stderr, "%s\n", line.c_str());
}

void SimulatedFarm::Trace(const std::string& to, const std::string& payload) {
  const auto add = [this](std::uint64_t value) { trace_ = (trace_ ^ value) * 0x100000001b3ULL; };
  add(static_cast<std::uint64_t>(events_.now().time_since_epoch().count()));
  for (const std::string* text : {&to, &payload}) {
    for (const char c : *text) add(static_cast<unsigned char>(c));
  }
}

// ---- faults ----

void SimulatedFarm::PlanFault(Milliseconds mean, void (SimulatedFarm::*fault)()) {
  if (mean.count() == 0) return;
  events_.After(Milliseconds(random_.Int(1, 2 * static_cast<int>(mean.count()))), [this, mean, fault] {
    if (calm_) return;
    (this->*fault)();
    PlanFault(mean, fault);
  });
}

SimulatedWorker& SimulatedFarm::AnyWorker() {
  return *workers_[static_cast<std::size_t>(random_.Int(0, static_cast<int>(workers_.size()) - 1))];
}

void SimulatedFarm::CrashWorker() {
  SimulatedWorker& worker = AnyWorker();
  if (!worker.alive()) return;
  ++tally_.worker_crashes;
  Narrate(worker.name() + " crashes");
  worker.Crash();
}

void SimulatedFarm::HangWorker() {
  SimulatedWorker& worker = AnyWorker();
  if (!worker.alive()) return;
  ++tally_.standstills;
  const Milliseconds time(random_.Int(100, 3 * static_cast<int>(Lease().count())));
  Narrate(worker.name() + " stands still for " + std::to_string(time.count()) + " ms");
  worker.Hang(time);
}

void SimulatedFarm::SlowWorker() { AnyWorker().SetSlowness(random_.Chance(50) ? 1 : random_.Int(2, 10)); }

void SimulatedFarm::CutNetwork() {
  SimulatedWorker& worker = AnyWorker();
  const std::string other = random_.Chance(60) ? kCoordinator : AnyWorker().name();
  if (other == worker.name()) return;
  ++tally_.cuts;
  const TimePoint until = events_.now() + Milliseconds(random_.Int(100, 3 * static_cast<int>(Lease().count())));
  const int ways = random_.Int(1, 3);
  Narrate(worker.name() + " and " + other + " are cut off for " +
          std::to_string(std::chrono::duration_cast<Milliseconds>(until - events_.now()).count()) + " ms, ways " +
          std::to_string(ways));
  if (ways != 1) network_.Cut(worker.name(), other, until);
  if (ways != 2) network_.Cut(other, worker.name(), until);
  if (other == kCoordinator && random_.Chance(50)) events_.At(until, [&worker] { worker.Reconnect(); });
}

void SimulatedFarm::LoseArtifacts() {
  ++tally_.store_losses;
  if (random_.Chance(30)) {
    AnyWorker().ForgetStore();
  } else {
    AnyWorker().DamageArtifacts(random_.Int(1, 100));
  }
}

void SimulatedFarm::ReplaceWorker() { AnyWorker().Stop(); }

void SimulatedFarm::CrashCoordinatorNow() {
  if (coordinator_) {
    CrashCoordinator(options_.faults.power_fails ? SimulatedDisk::Loss::kPower : SimulatedDisk::Loss::kProcess);
  }
}

void SimulatedFarm::CrashCoordinatorInWrite() {
  if (coordinator_) disk_.DieAtWrite(random_.Int(1, 30));
}

void SimulatedFarm::RestartDeadWorkers() {
  if (!restarting_) return;
  for (const auto& worker : workers_) {
    if (!worker->alive() && random_.Chance(30)) worker->Start();
  }
  events_.After(Milliseconds(1000), [this] { RestartDeadWorkers(); });
}

void SimulatedFarm::BeCalm() {
  if (calm_) return;
  calm_ = true;
  network_.Calm();
  task_faults_ = {};
  disk_.DieAtWrite(0);
  for (const auto& worker : workers_) worker->SetSlowness(1);
}

// ---- the run ----

void SimulatedFarm::Run() {
  const TimePoint begin = events_.now();
  StartCoordinator();
  TickCoordinator();
  for (const auto& worker : workers_) worker->Start();
  RestartDeadWorkers();
  const FaultPlan& faults = options_.faults;
  PlanFault(faults.crashes, &SimulatedFarm::CrashWorker);
  PlanFault(faults.standstills, &SimulatedFarm::HangWorker);
  PlanFault(faults.slowdowns, &SimulatedFarm::SlowWorker);
  PlanFault(faults.cuts, &SimulatedFarm::CutNetwork);
  PlanFault(faults.losses, &SimulatedFarm::LoseArtifacts);
  PlanFault(faults.leaves, &SimulatedFarm::ReplaceWorker);
  PlanFault(faults.coordinator_crashes, &SimulatedFarm::CrashCoordinatorNow);
  PlanFault(faults.journal_crashes, &SimulatedFarm::CrashCoordinatorInWrite);
  events_.After(faults.chaos, [this] { BeCalm(); });

  const auto all_ended = [this] {
    return std::ranges::all_of(submitters_, [](const auto& entry) { return entry.second->done(); }) && coordinator_ &&
           coordinator_->scheduler().Jobs().empty();
  };
  const TimePoint end = begin + faults.chaos + kPatience;
  while (problems_.empty() && !all_ended()) {
    if (events_.RunNext(end)) continue;
    for (const auto& [name, submitter] : submitters_) {
      if (!submitter->done()) Problem(name + ": its job does not end");
    }
    Problem("the farm does not come to an end");
  }
  BeCalm();
  tally_.longest_end = std::chrono::duration<double, std::ratio<60>>(events_.now() - begin - faults.chaos).count();
  const TimePoint settled = events_.now() + kSettle;
  while (problems_.empty() && events_.RunNext(settled)) {
  }
  if (problems_.empty() && !coordinator_) Problem("the coordinator is gone");
  if (problems_.empty()) {
    CheckJobList();
    CheckAttempts();
    for (const auto& [name, submitter] : submitters_) {
      // The last that has the folder.
      const auto last = std::ranges::find_if(submitter->ends().rbegin(), submitter->ends().rend(),
                                             [](const JobEnd& job) { return !job.wish.kind.keeps_results; });
      if (last != submitter->ends().rend()) CheckFolder(*submitter, *last, true);
    }
  }
  if (problems_.empty()) CheckNothingIsLeft();
  tally_.runs = 1;
  tally_.hours = std::chrono::duration<double, std::ratio<3600>>(events_.now() - begin).count();
}

Tally SimulatedFarm::tally() const {
  Tally tally = tally_;
  for (const auto& worker : workers_) {
    tally.attempts += worker->tasks_begun();
    tally.given_back += worker->tasks_given_back();
  }
  tally.messages = network_.num_sent();
  tally.messages_lost = network_.num_lost();
  if (coordinator_) tally.late_results += coordinator_->scheduler().late_results();
  return tally;
}

// ---- what must hold ----

void SimulatedFarm::Problem(const std::string& text) {
  const auto ms = std::chrono::duration_cast<Milliseconds>(events_.now().time_since_epoch()).count();
  problems_.push_back("at " + std::to_string(ms) + " ms: " + text);
}

void SimulatedFarm::OnBegun(const SimulatedWorker& worker, LeaseId lease, const TaskSpec& spec) {
  first_tasks_.try_emplace(spec.id.job, events_.now());
  // That a lease is one worker's rests on the order that a connection keeps (PROTOCOL.md, 4).
  if (options_.faults.network.reorders) return;
  for (const auto& other : workers_) {
    if (other->BelievesIn(spec.id, lease)) {
      Problem(TaskName(spec.id) + " is " + worker.name() + "'s and " + other->name() + "'s at the same time");
    }
  }
}

void SimulatedFarm::OnEnd(const Submitter& submitter, const JobEnd& end) {
  const std::string name = submitter.name() + ", job " + std::to_string(end.id);
  const v1::JobStatus& status = end.status;
  if (status.determinism_violations() > 0) Problem(name + ": determinism was violated");
  if (status.state() == v1::JOB_STATE_DONE) {
    ++tally_.jobs_done;
    if (status.frames_done() != status.frames_total()) Problem(name + ": is done without all of its frames");
    if (end.cancelled && !end.retried) Problem(name + ": was cancelled, and is done");
    if (end.wish.kind.sequence != "line") Problem(name + ": can't be done, and is");
  } else {
    ++tally_.jobs_ended_otherwise;
    const bool patient = options_.coordinator.max_attempts >= kPatientAttempts;
    if (status.state() == v1::JOB_STATE_FAILED && patient && end.wish.kind.sequence == "line")
      Problem(name + ": failed: " + status.error().message());
    if (status.state() == v1::JOB_STATE_CANCELLED && !end.wish.cancel_after) Problem(name + ": nobody cancelled it");
    if (status.state() == v1::JOB_STATE_FAILED && status.error().message().empty())
      Problem(name + ": failed without a reason");
  }
  if (!calm_) ended_in_chaos_.insert(end.id);
  CheckFolder(submitter, end, false);
}

void SimulatedFarm::CheckFolder(const Submitter& submitter, const JobEnd& end, bool last_look) {
  const std::string name = submitter.name() + ", job " + std::to_string(end.id) + (last_look ? ", at last" : "");
  if (end.wish.kind.keeps_results || !options_.checks_files) return;  // results: CheckJobList
  const FolderContent content = ReadFolder(submitter.folder());
  const FolderContent& expected = ExpectedFiles(end.wish.kind, options_.scratch);
  if (end.status.state() == v1::JOB_STATE_DONE) {
    for (const auto& [path, bytes] : content) {
      if (!expected.contains(path)) Problem(name + ": " + path + " should not be there");
    }
    for (const auto& [path, bytes] : expected) {
      const auto found = content.find(path);
      if (found == content.end()) {
        Problem(name + ": " + path + " is missing");
      } else if (found->second != bytes) {
        Problem(name + ": " + path + " is not what it should be");
      }
    }
    return;
  }
  // Files of one job alone: of this one, in part, or of one before.
  std::set<std::string> files;
  for (const auto& [path, bytes] : content) {
    // A Cleanup that no worker could do in time is not waited for.
    if (path.starts_with(".depthfarm-staging/") && last_look &&
        (!ended_in_chaos_.contains(end.id) || cleaned_up_.contains(end.id)))
      Problem(name + ": " + path + " was left behind");
    if (!path.starts_with(".")) files.insert(path);
  }
  const bool finished = content.contains("depth.json");
  const auto all_of = [&](const FolderContent& whole) {
    return (!finished || files.size() == whole.size()) && std::ranges::all_of(files, [&](const std::string& path) {
             const auto found = whole.find(path);
             return found != whole.end() && found->second == content.at(path);
           });
  };
  bool known = all_of(expected);
  for (const JobEnd& before : submitter.ends())
    known = known || all_of(ExpectedFiles(before.wish.kind, options_.scratch));
  if (!known) Problem(name + ": its folder holds what no job made");
}

namespace {

// Asks the coordinator, without a network.
v1::Envelope Call(Coordinator& coordinator, v1::Envelope request, TimePoint now) {
  request.set_request_id(1);
  (void)coordinator.TakeOutgoing();
  coordinator.Handle({"checks", "", SerializeEnvelope(std::move(request))}, now);
  std::vector<OutgoingMessage> answers = coordinator.TakeOutgoing();
  return answers.empty() ? v1::Envelope() : std::move(answers.front().envelope);
}

}  // namespace

void SimulatedFarm::CheckJobList() {
  v1::Envelope request;
  request.mutable_list_jobs();
  const v1::Envelope list = Call(*coordinator_, request, events_.now());
  std::map<std::uint64_t, v1::JobStatus> jobs;
  for (const v1::JobStatus& job : list.job_list().jobs()) jobs[job.job_id()] = job;
  for (const auto& [name, submitter] : submitters_) {
    for (const JobEnd& end : submitter->ends()) {
      const std::string job = name + ", job " + std::to_string(end.id);
      const auto listed = jobs.find(end.id);
      if (listed == jobs.end()) {
        Problem(job + ": was forgotten");
      } else if (listed->second.state() != end.status.state()) {
        Problem(job + ": ended in one way and is listed in another");
      }
      if (!options_.checks_files || !end.wish.kind.keeps_results || end.status.state() != v1::JOB_STATE_DONE) continue;
      JobKind with_folder = end.wish.kind;
      with_folder.keeps_results = false;
      std::set<std::string> wanted;
      for (const auto& [path, bytes] : ExpectedFiles(with_folder, options_.scratch)) {
        if (path.starts_with("depth/") || path.starts_with("confidence/")) wanted.insert(DigestBytes(Sha256(bytes)));
      }
      v1::Envelope ask;
      ask.mutable_get_results()->set_job_id(end.id);
      const v1::Envelope results = Call(*coordinator_, ask, events_.now());
      std::set<std::string> there;
      for (const v1::FrameResult& frame : results.results().frames()) {
        for (const v1::FileDigest& file : frame.files()) there.insert(file.sha256());
      }
      if (there != wanted) Problem(job + ": its results are not what they should be");
    }
  }
}

void SimulatedFarm::CheckAttempts() {
  v1::Envelope request;
  request.mutable_list_jobs();
  const v1::Envelope list = Call(*coordinator_, request, events_.now());
  for (const v1::JobStatus& job : list.job_list().jobs()) {
    const std::string name = "job " + std::to_string(job.job_id());
    if (job.state() == v1::JOB_STATE_RUNNING) Problem(name + ": is still running");
    std::set<std::pair<int, int>> committed;
    for (std::uint64_t after = 0;;) {
      v1::Envelope ask;
      ask.mutable_get_job_logs()->set_job_id(job.job_id());
      ask.mutable_get_job_logs()->set_after(after);
      const v1::Envelope logs = Call(*coordinator_, ask, events_.now());
      for (const v1::TaskAttempt& attempt : logs.job_logs().attempts()) {
        const TaskId task = FromProto(attempt.task()).value();
        if (attempt.outcome() == v1::ATTEMPT_OUTCOME_RUNNING) Problem(TaskName(task) + ": is never over");
        if (static_cast<int>(attempt.attempt()) > options_.coordinator.max_attempts)
          Problem(TaskName(task) + ": was tried too often");
        if (task.kind == TaskKind::kCleanup && attempt.outcome() == v1::ATTEMPT_OUTCOME_DONE)
          cleaned_up_.insert(job.job_id());
        const bool once = task.kind == TaskKind::kCommit || task.kind == TaskKind::kManifest;
        if (attempt.outcome() != v1::ATTEMPT_OUTCOME_DONE || !once) continue;
        if (!committed.emplace(static_cast<int>(task.kind), task.frame).second)
          Problem(TaskName(task) + ": was done twice");
      }
      after = logs.job_logs().next();
      if (after == 0) break;
    }
  }
}

void SimulatedFarm::CheckNothingIsLeft() {
  restarting_ = false;
  for (const auto& worker : workers_) worker->Stop();
  const TimePoint end = events_.now() + 4 * Lease();
  while (events_.RunNext(end)) {
  }
  if (!coordinator_->scheduler().empty()) Problem("the coordinator keeps something of a farm that is no more");
}

FolderContent ReadFolder(const std::string& folder) {
  FolderContent content;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, error)) {
    if (entry.is_directory() && fs::is_empty(entry.path())) content[fs::relative(entry.path(), folder).string() + "/"];
    if (!entry.is_regular_file()) continue;
    std::ifstream stream(entry.path(), std::ios::binary);
    std::ostringstream bytes;
    bytes << stream.rdbuf();
    content[fs::relative(entry.path(), folder).string()] = bytes.str();
  }
  return content;
}

const FolderContent& ExpectedFiles(const JobKind& kind, const std::string& scratch) {
  static std::map<JobKind, FolderContent> known;
  if (kind.sequence != "line") {
    static const FolderContent nothing;
    return nothing;
  }
  const auto found = known.find(kind);
  if (found != known.end()) return found->second;
  SimulatedFarm::Options options;
  options.scratch = scratch + "/expected";
  fs::remove_all(options.scratch);
  options.workers.resize(1);
  options.checks_files = false;
  SimulatedFarm farm(1, options);
  farm.AddSubmitter("only", {Wish{kind}}, Milliseconds(0));
  farm.Run();
  if (!farm.problems().empty()) throw std::logic_error("without faults: " + farm.problems().front());
  known[kind] = ReadFolder(options.scratch + "/only");
  fs::remove_all(options.scratch);
  return known[kind];
}

}  // namespace depthfarm::simulation
