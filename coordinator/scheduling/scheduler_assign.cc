// Who gets which task: the job whose turn it is, its most urgent ready task, and the worker for it.
#include <algorithm>
#include <utility>

#include "coordinator/scheduling/fair_share.h"
#include "coordinator/scheduling/placement.h"
#include "coordinator/scheduling/scheduler.h"

namespace depthfarm {

std::vector<WorkerId> Scheduler::WorkersWith(WorkerTable::Room room) const {
  std::vector<std::pair<TimePoint, WorkerId>> free;
  for (const auto& [id, worker] : workers_.workers()) {
    // A worker refuses a grant for an ask older than half a lease.
    if (workers_.RoomOf(worker, now_, options_.lease / 2) == room) free.emplace_back(worker.ask->received, id);
  }
  std::sort(free.begin(), free.end());
  std::vector<WorkerId> ids;
  ids.reserve(free.size());
  for (const auto& [received, id] : free) ids.push_back(id);
  return ids;
}

void Scheduler::Assign() {
  EndHolds();
  std::vector<WorkerId> free_workers = WorkersWith(WorkerTable::Room::kSlot);
  while (!free_workers.empty() && AssignNext(false, free_workers)) {
  }
  if (!free_workers.empty()) Rebalance(std::move(free_workers));
  // Ahead only while enough is left for whoever is free next: a task that waits behind another one would end later than
  // on a worker that idles meanwhile.
  std::vector<WorkerId> fetching = WorkersWith(WorkerTable::Room::kAhead);
  const std::size_t reserve = workers_.num_slots();
  while (!fetching.empty() && NumReady() > reserve && AssignNext(true, fetching)) {
  }
}

std::size_t Scheduler::NumReady() const {
  std::size_t ready = 0;
  for (const auto& [id, job] : jobs_) ready += job.taken ? job.progress->table().ready().size() : 0;
  return ready;
}

bool Scheduler::AssignNext(bool ahead, std::vector<WorkerId>& free_workers) {
  const std::vector<JobId> order = JobsInFairOrder();
  return std::ranges::any_of(order, [&](JobId id) { return AssignOneOf(jobs_.at(id), ahead, free_workers); });
}

std::vector<JobId> Scheduler::JobsInFairOrder() const {
  std::vector<JobShare> shares;
  shares.reserve(jobs_.size());
  for (const auto& [id, job] : jobs_) {
    shares.push_back({id, job.priority, workers_.LeasesOf(id), job.last_grant, job.ending != JobState::kRunning});
  }
  return FairOrder(std::move(shares));
}

std::optional<ArtifactInfo> Scheduler::KnownOf(const JobRecord& job, const TaskId& task) const {
  if (task.kind != TaskKind::kAnalyse) return std::nullopt;
  const std::optional<ArtifactKey>& work = job.progress->WorkOf(task);
  const std::optional<ArtifactKey> made = work ? analyses_.Find(*work) : std::nullopt;
  const ArtifactInfo* artifact = made ? directory_.Find(*made) : nullptr;
  return artifact == nullptr ? std::nullopt : std::optional(*artifact);
}

// Local bytes of free workers alone: of few holders and many free workers, or the other way round.
void Scheduler::AddHolders(const ArtifactInfo& artifact, const std::vector<WorkerId>& free_workers,
                           TaskCandidate& candidate) const {
  const std::set<WorkerId>& holders = directory_.Holders(artifact.key);
  if (holders.size() > free_workers.size()) {
    for (const WorkerId worker : free_workers) {
      if (holders.contains(worker)) candidate.local_bytes[worker] += artifact.stored_bytes;
    }
  } else {
    for (const WorkerId worker : holders) candidate.local_bytes[worker] += artifact.stored_bytes;
  }
}

TaskCandidate Scheduler::CandidateOf(JobRecord& job, const TaskId& task,
                                     const std::vector<WorkerId>& free_workers) const {
  TaskCandidate candidate{.task = task, .local_bytes = {}};
  for (const ArtifactInfo& input : job.progress->InputsOf(task)) {
    AddHolders(input, free_workers, candidate);
    candidate.input_bytes += input.stored_bytes;
  }
  if (const std::optional<ArtifactInfo> known = KnownOf(job, task)) AddHolders(*known, free_workers, candidate);
  const std::set<WorkerId>& failed_on = job.progress->Find(task)->failed_on;
  const bool alone = IsTriedAlone(*job.progress->Find(task));
  const std::uint64_t memory = job.progress->MemoryOf(task);
  const auto any_other = [&](auto&& is_one) {
    return std::ranges::any_of(
        workers_.workers(), [&](const auto& entry) { return entry.second.Takes(job.needs) && is_one(entry.second); });
  };
  // Asked of all workers, but only where a free one is too small or the task failed before.
  std::optional<bool> large_exist;
  const auto is_able = [&](const Worker& worker) {
    if (worker.IsLarge(memory)) return true;
    if (!large_exist) large_exist = any_other([&](const Worker& other) { return other.IsLarge(memory); });
    return !*large_exist;
  };
  const bool others = !failed_on.empty() &&
                      any_other([&](const Worker& other) { return !failed_on.contains(other.id) && is_able(other); });
  for (const WorkerId id : free_workers) {
    const Worker& worker = *workers_.Find(id);
    const auto held = held_.find(id);
    // Other jobs that were offered this worker go before the one it is held for (WhoTakes).
    const bool spared = held != held_.end() && held->second.job == task.job && held->second != task;
    if (!is_able(worker) || (others && failed_on.contains(id)) || spared) {
      candidate.avoid.insert(id);
    } else if (worker.IsLarge(memory) && !alone ? !worker.HasMemory(memory) : !worker.leases.empty()) {
      candidate.full.insert(id);
    }
  }
  return candidate;
}

void Scheduler::LeaveToHome(const JobRecord& job, const std::vector<WorkerId>& free_workers,
                            TaskCandidate& candidate) const {
  const TaskId& task = candidate.task;
  if (EndsAFrameOrJob(task.kind)) return;
  const int gop = job.progress->plan().GopOf(task.frame);
  const std::optional<WorkerId> home = job.homes.HomeOf(gop);
  const Worker* const at_home = home ? workers_.Find(*home) : nullptr;
  // One that does something else meanwhile would let the GOP wait.
  const auto is_of_gop = [&](LeaseId id) {
    const TaskId& leased = workers_.leases().at(id).task;
    return leased.job == task.job && job.progress->plan().GopOf(leased.frame) == gop;
  };
  if (at_home == nullptr || std::ranges::none_of(at_home->leases, is_of_gop)) return;
  const double left = job.progress->remaining().SecondsLeftOf(gop);
  for (const WorkerId worker : free_workers) {
    if (worker == *home) continue;
    const auto held = candidate.local_bytes.find(worker);
    const std::uint64_t there = held == candidate.local_bytes.end() ? 0 : held->second;
    // More may be there: what such a task made when it was done before.
    const std::uint64_t missing = candidate.input_bytes - std::min(candidate.input_bytes, there);
    if (!IsHelpWorthReading(missing, left)) candidate.avoid.insert(worker);
  }
}

std::vector<WorkerId> Scheduler::WhoTakes(const JobRecord& job, const std::vector<WorkerId>& free_workers) const {
  std::vector<WorkerId> takers;
  for (const WorkerId id : free_workers) {
    if (!workers_.Find(id)->Takes(job.needs)) continue;
    // Held for a task of a job that this one does not go before; within the job CandidateOf decides.
    const auto held = held_.find(id);
    const bool spared = held != held_.end() && held->second.job != job.progress->plan().job().config.job &&
                        jobs_.at(held->second.job).priority >= job.priority;
    if (!spared) takers.push_back(id);
  }
  return takers;
}

bool Scheduler::AssignOneOf(JobRecord& job, bool ahead, std::vector<WorkerId>& free_workers) {
  std::vector<WorkerId> takers = WhoTakes(job, free_workers);
  if (takers.empty()) return false;
  const auto& ready = job.progress->table().ready();
  const auto first = std::ranges::find_if_not(ready, [](const TaskId& id) { return EndsAFrameOrJob(id.kind); });
  if (AssignAmong(job, {ready.begin(), first}, takers, true, free_workers)) return true;
  if (first == ready.end()) return false;

  const ResolvedJob& resolved = job.progress->plan().resolved();
  const auto ready_of = [&](int gop) {
    return job.progress->table().ReadyOf(first->job, gop * resolved.params.gop, (gop + 1) * resolved.params.gop);
  };
  for (const WorkerId worker : takers) {
    for (const int gop : job.homes.Of(worker)) {
      if (AssignAmong(job, ready_of(gop), {worker}, false, free_workers)) return true;
    }
  }
  for (const auto& [gop, frames] : job.progress->open_gops()) {
    if (job.homes.HomeOf(gop)) continue;
    if (AssignAmong(job, ready_of(gop), takers, false, free_workers)) return true;
  }
  if (ahead) std::erase_if(takers, [&](WorkerId worker) { return !job.homes.Of(worker).empty(); });
  return AssignAmong(job, {first, ready.end()}, takers, true, free_workers);
}

bool Scheduler::AssignAmong(JobRecord& job, const ReadyRange& tasks, const std::vector<WorkerId>& takers, bool hold,
                            std::vector<WorkerId>& free_workers) {
  for (auto first = tasks.begin(); first != tasks.end();) {
    std::vector<TaskCandidate> candidates;
    auto next = first;
    for (; next != tasks.end() && EquallyUrgent(*next, *first); ++next) {
      if (candidates.size() == kMaxCandidates) continue;
      // What another task makes just now is not made twice: when that one is done, this one finds it there.
      const std::optional<ArtifactKey>& work = job.progress->WorkOf(*next);
      if (work && workers_.IsUnderWay(*work)) continue;
      const auto resting = job.resting.find(*next);
      if (resting != job.resting.end() && resting->second > now_) continue;
      candidates.push_back(CandidateOf(job, *next, takers));
      LeaveToHome(job, takers, candidates.back());
    }
    if (const std::optional<Placement> placement = ChoosePlacement(candidates, takers)) {
      const std::size_t leases = workers_.leases().size();
      MakeGrant(job, *placement);
      if (workers_.leases().size() > leases) std::erase(free_workers, placement->worker);
      return true;
    }
    if (hold) {
      for (const TaskCandidate& candidate : candidates) HoldFor(candidate, takers);
    }
    first = next;
  }
  return false;
}

void Scheduler::HoldFor(const TaskCandidate& candidate, const std::vector<WorkerId>& takers) {
  const auto holds = [&](const auto& entry) { return entry.second == candidate.task; };
  if (candidate.full.empty() || std::ranges::any_of(held_, holds)) return;
  const auto full = std::ranges::find_if(takers, [&](WorkerId id) { return candidate.full.contains(id); });
  held_.emplace(*full, candidate.task);
}

void Scheduler::EndHolds() {
  std::erase_if(held_, [&](const auto& entry) {
    const auto& [id, task] = entry;
    const Worker* worker = workers_.Find(id);
    const JobRecord* job = FindJob(task.job);
    const Task* waiting = job == nullptr ? nullptr : job->progress->Find(task);
    return worker == nullptr || waiting == nullptr || !worker->Takes(job->needs) || waiting->state != TaskState::kReady;
  });
}

void Scheduler::MakeGrant(JobRecord& job, const Placement& placement) {
  const LeaseId lease_id(next_lease_);
  std::optional<GrantedTask> task = job.progress->Take(placement.task, lease_id);
  if (!task) return;  // its inputs are gone, or its artifact is there already
  job.resting.erase(placement.task);
  if (!EndsAFrameOrJob(placement.task.kind)) {
    job.homes.Claim(job.progress->plan().GopOf(placement.task.frame), placement.worker);
  }
  Hand(job, placement, lease_id, std::move(*task), false);
}

void Scheduler::Hand(JobRecord& job, const Placement& placement, LeaseId lease_id, GrantedTask task, bool duplicate) {
  ++next_lease_;
  job.last_grant = lease_id.value();
  Worker& worker = *workers_.Find(placement.worker);
  if (const std::optional<ArtifactInfo> known = KnownOf(job, placement.task)) {
    task.spec.known = TaskInput{*known, InputRole::kAnalysis, placement.task.index, {}};
    task.holders_of_known = HoldersToTell(directory_, known->key, lease_id);
  }
  const Task& state = *job.progress->Find(placement.task);
  Lease& lease = workers_.AddLease(lease_id, {.task = placement.task,
                                              .worker = worker.id,
                                              .expires = now_ + options_.lease,
                                              .told = {},
                                              .work = job.progress->WorkOf(placement.task),
                                              .memory_bytes = job.progress->MemoryOf(placement.task),
                                              .duplicate = duplicate,
                                              .alone = IsTriedAlone(state)});
  for (std::size_t i = 0; i < task.spec.inputs.size(); ++i) {
    lease.told.emplace_back(task.spec.inputs[i].artifact.key, task.holders[i]);
  }
  const int attempt = state.failures + 1;
  const bool first_of_job = !std::exchange(worker.told_jobs[placement.task.job], true);
  AddNote(Note::Severity::kInfo, duplicate ? "task_duplicated" : "task_granted",
          {{"task", TaskName(placement.task)},
           {"lease", std::to_string(lease_id.value())},
           {"worker", worker.name},
           {"attempt", std::to_string(attempt)}});
  Add(Grant{worker.id, lease_id, worker.ask->id, attempt, first_of_job, duplicate, std::move(task)});
  worker.ask.reset();
}

}  // namespace depthfarm
