#include "tests/simulation/simulated_farm.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "common/wire/envelope.h"

namespace depthfarm::simulation {
namespace {

constexpr Milliseconds kTick{200};
constexpr Milliseconds kSettle{120'000};
// After the last fault: one worker may have a dozen jobs of long tasks to do.
constexpr std::chrono::hours kPatience{4};
constexpr const char* kCoordinator = "coordinator";

std::string HostOf(const std::string& peer) { return peer.substr(0, peer.find('#')); }

}  // namespace

SimulatedFarm::SimulatedFarm(std::uint64_t seed, const Options& options)
    : options_(options),
      random_(seed),
      network_(events_, random_, options.faults.network),
      task_faults_(options.faults.tasks),
      around_{.events = events_,
              .random = random_,
              .network = network_,
              .faults = task_faults_,
              .tells_deaths = seed % 2 == 0,
              .send =
                  [this](const std::string& host, const std::string& peer, std::string payload) {
                    Trace(kCoordinator, payload);
                    const auto named = std::ranges::find(workers_, host, [](const auto& w) { return w->name(); });
                    const SimulatedWorker* const worker = named->get();
                    network_.Send(host, kCoordinator,
                                  [this, worker, life = worker->life(), peer, payload = std::move(payload)] {
                                    // What waits in a socket goes through the connection that the process has then.
                                    const bool waited = random_.Chance(50) && worker->life() == life;
                                    ToCoordinator(waited ? worker->peer() : peer, payload);
                                  });
                  },
              .send_beside =
                  [this](const std::string& host, std::string payload) {
                    Trace(kCoordinator, payload);
                    if (network_.IsCut(host, kCoordinator)) return;
                    const std::string peer = host + "'s minder";
                    network_.Send(peer, kCoordinator,
                                  [this, peer, payload = std::move(payload)] { ToCoordinator(peer, payload); });
                  },
              .find = [this](const std::string& endpoint) -> const SimulatedWorker* {
                const auto worker =
                    std::ranges::find(workers_, endpoint, [](const auto& each) { return each->endpoint(); });
                return worker == workers_.end() ? nullptr : worker->get();
              },
              .begun = [this](const SimulatedWorker& worker, LeaseId lease,
                              const TaskSpec& spec) { OnBegun(worker, lease, spec); },
              .poisoned = [this](const TaskId& task) { ++deaths_[task]; }},
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
    CheckJournal(**journal);
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
  if (calm_) NoteEndedInChaos();  // in its life before
}

void SimulatedFarm::CrashCoordinator(SimulatedDisk::Loss loss) {
  ++tally_.coordinator_crashes;
  Narrate("the coordinator crashes");
  written_.clear();
  if (coordinator_) {
    tally_.late_results += coordinator_->scheduler().late_results();
    CheckAttempts(false);
    // What it was writing when it ended, or did not sync before the power failed, may not be there.
    if (disk_.dead() || loss == SimulatedDisk::Loss::kPower) written_.clear();
  }
  disk_.Die();
  coordinator_.reset();
  granted_ = 0;
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
    if (message.envelope.has_grant_task()) {
      ++granted_;
      const LeaseId lease(message.envelope.grant_task().lease_id());
      if (coordinator_->scheduler().IsDuplicate(lease)) duplicates_.insert(lease);
      // It may fail in the chaos, and its job end soon after.
      const v1::TaskId& task = message.envelope.grant_task().task().id();
      if (!calm_ && task.kind() == v1::TASK_KIND_CLEANUP) ended_in_chaos_.insert(task.job_id());
    }
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
  worker.Die();
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
  NoteEndedInChaos();
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
    CheckAttempts(true);
    for (const auto& [name, submitter] : submitters_) {
      for (const bool renders : {false, true}) {  // the last that has each folder
        const auto last = std::ranges::find_if(
            submitter->ends().rbegin(), submitter->ends().rend(),
            [&](const auto& job) { return !job.wish.kind.keeps_results && job.wish.kind.renders == renders; });
        if (last != submitter->ends().rend()) CheckFolder(*submitter, *last, true);
      }
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
    tally.deaths_told += worker->deaths_told();
  }
  tally.duplicates = duplicates_.size();
  tally.messages = network_.num_sent();
  tally.messages_lost = network_.num_lost();
  if (coordinator_) tally.late_results += coordinator_->scheduler().late_results();
  return tally;
}

}  // namespace depthfarm::simulation
