#include "tests/coordinator/scheduling/fake_farm.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <variant>

#include "common/digest/sha256.h"
#include "common/sequence/depth_manifest.h"

namespace depthfarm {
namespace {

std::string Text(const ArtifactKey& key) { return {key.begin(), key.end()}; }

}  // namespace

void FakeFarm::Submit(const PlannedJob& job, int priority, const std::set<std::string>& tags) {
  Send(JobSubmitted{job, "job", priority, tags});
}

void FakeFarm::Send(const Event& event) {
  Apply(scheduler.Handle(event, now));
  ReportStopped();
  if (!answers_late) AnswerAskedBack();
  while (!to_ask_.empty()) {
    const std::vector<WorkerId> asking = std::exchange(to_ask_, {});
    for (const WorkerId id : asking) {
      const auto worker = workers.find(id);
      if (worker != workers.end() && worker->second.alive && worker->second.HasRoom()) Ask(id);
    }
  }
}

WorkerId FakeFarm::Join(int slots, int ahead) {
  const WorkerId id(++last_worker_);
  workers[id].id = id;
  workers[id].slots = slots;
  workers[id].ahead = ahead;
  Rejoin(id);
  return id;
}

WorkerId FakeFarm::JoinAndAsk(int slots, int ahead) {
  const WorkerId id = Join(slots, ahead);
  Ask(id);
  return id;
}

void FakeFarm::Rejoin(WorkerId worker) {
  const FakeWorker& fake = At(worker);
  WorkerJoined event{.worker = worker,
                     .name = "w" + std::to_string(worker.value()),
                     .slots = fake.slots,
                     .ahead = fake.ahead,
                     .memory_bytes = fake.memory_bytes,
                     .tags = fake.tags,
                     .algorithm_version = fake.algorithm_version};
  for (const auto& [key, artifact] : fake.store) event.artifacts.push_back(artifact);
  for (const auto& [lease, grant] : fake.running) event.running.push_back(lease);
  Send(event);
}

void FakeFarm::Ask(WorkerId worker) {
  WorkerAsked event{worker, ++At(worker).asks, {}};
  for (const auto& [lease, grant] : At(worker).running) event.running.push_back(lease);
  Send(event);
}

void FakeFarm::Beat(WorkerId worker) {
  WorkerHeard event{worker, ++At(worker).beats, {}};
  for (const auto& [lease, grant] : At(worker).running) event.running.push_back(lease);
  Send(event);
}

void FakeFarm::Leave(WorkerId worker) {
  workers.erase(worker);
  Send(WorkerLeft{worker});
}

void FakeFarm::Drop(WorkerId worker, const ArtifactKey& key) {
  At(worker).store.erase(key);
  Send(ArtifactsDropped{worker, {key}});
}

std::vector<ArtifactKey> FakeFarm::MissingInputs(const FakeWorker& worker, const Grant& grant) const {
  std::vector<ArtifactKey> missing;
  for (std::size_t i = 0; i < grant.task.spec.inputs.size(); ++i) {
    const ArtifactKey& key = grant.task.spec.inputs[i].artifact.key;
    const auto has = [&](WorkerId id) {
      const auto holder = workers.find(id);
      return holder != workers.end() && holder->second.alive && holder->second.store.contains(key);
    };
    const auto& holders = grant.task.holders[i];
    if (!has(worker.id) && std::none_of(holders.begin(), holders.end(), has)) missing.push_back(key);
  }
  return missing;
}

TaskFinished FakeFarm::ResultOf(FakeWorker& worker, const Grant& grant) {
  const TaskSpec& spec = grant.task.spec;
  TaskFinished result{worker.id, grant.lease, spec.id, {}, {}, {}, {}};
  for (const TaskInput& input : spec.inputs) worker.store[input.artifact.key] = input.artifact;
  const bool is_result = spec.id.kind == TaskKind::kEmit && spec.output_key;
  if (MakesArtifact(spec.id.kind) || is_result) {
    const ArtifactKey key = spec.id.kind == TaskKind::kAnalyse ? Sha256(spec.picture) : spec.output_key.value();
    result.artifact = ArtifactInfo{key, artifact_bytes + key[0], Sha256(Text(key))};
    worker.store[key] = *result.artifact;
  }
  if (spec.id.kind == TaskKind::kAnalyse) result.picture_digest = Sha256("picture " + spec.picture);
  if (spec.id.kind == TaskKind::kEmit) {
    if (is_result) {
      EXPECT_EQ(spec.staging, "");
    } else {
      EXPECT_TRUE(emitted.emplace(spec.id.job, spec.staging).second) << "two attempts share " << spec.staging;
    }
    for (const TaskInput& input : spec.inputs) {
      const std::string camera = "cam" + std::to_string(input.view);
      if (input.role == InputRole::kAnalysis || input.role == InputRole::kRefined)
        result.files.push_back({DepthFileName(camera, spec.id.frame), Sha256(spec.staging), 5});
      if (input.role == InputRole::kConfidence)
        result.files.push_back({ConfidenceFileName(camera, spec.id.frame), Sha256(spec.staging), 5});
    }
  }
  if (spec.id.kind == TaskKind::kRender) {
    EXPECT_TRUE(emitted.emplace(spec.id.job, spec.staging).second) << "two attempts share " << spec.staging;
    for (const VirtualPicture& view : spec.views) {
      result.files.push_back({ViewFileName(view.number), Sha256(spec.staging), 5});
    }
  }
  if (spec.id.kind == TaskKind::kCommit) {
    EXPECT_TRUE(emitted.contains({spec.id.job, spec.staging})) << spec.staging;
    EXPECT_EQ(spec.files.at(0).sha256, Sha256(spec.staging));
  }
  result.stats = {.wall_seconds = 2,
                  .cpu_seconds = 1,
                  .peak_memory_bytes = 1000,
                  .fetched_bytes = 10,
                  .sweeps = 3,
                  .left_aside = left_aside.contains(spec.id)};
  return result;
}

void FakeFarm::AnswerAskedBack() {
  BeginTasks();
  for (const AskBack& ask : std::exchange(to_answer_, {})) {
    const auto worker = workers.find(ask.worker);
    if (worker == workers.end() || !worker->second.alive || begun.contains(ask.lease)) continue;
    const auto running = worker->second.running.find(ask.lease);
    if (running == worker->second.running.end()) continue;
    const TaskId task = running->second.task.spec.id;
    worker->second.running.erase(running);
    Send(TaskFailed{ask.worker, ask.lease, task, Cancelled(), {}});
    Ask(ask.worker);
  }
}

void FakeFarm::ReportStopped() {
  for (const TaskFailed& stopped : std::exchange(to_report_, {})) Send(stopped);
}

void FakeFarm::BeginTasks() {
  for (const auto& [id, worker] : workers) {
    int slots = worker.slots;
    for (const auto& [lease, grant] : worker.running) {
      if (slots-- > 0) begun.insert(lease);
    }
  }
}

void FakeFarm::Finish(WorkerId worker, LeaseId lease) {
  FakeWorker& fake = At(worker);
  const Grant grant = fake.running.at(lease);
  fake.running.erase(grant.lease);
  const std::vector<ArtifactKey> missing = MissingInputs(fake, grant);
  if (missing.empty()) {
    Send(ResultOf(fake, grant));
  } else {
    Send(TaskFailed{worker, grant.lease, grant.task.spec.id, Unavailable("inputs are gone"), missing});
  }
  Ask(worker);
}

void FakeFarm::Fail(WorkerId worker, const Status& error) {
  FakeWorker& fake = At(worker);
  const Grant grant = fake.running.begin()->second;
  fake.running.erase(grant.lease);
  Send(TaskFailed{worker, grant.lease, grant.task.spec.id, error, {}});
  Ask(worker);
}

void FakeFarm::Pass(Milliseconds time) {
  now += time;
  Apply(scheduler.Tick(now));
  ReportStopped();
}

void FakeFarm::PassWithBeats(Milliseconds time) {
  for (const TimePoint end = now + time; now < end;) {
    now = std::min(end, now + lease_ / 6);
    for (auto& [id, worker] : workers) {
      if (!worker.alive) continue;
      Beat(id);
      if (worker.HasRoom()) Ask(id);
    }
    Apply(scheduler.Tick(now));
    ReportStopped();
  }
}

void FakeFarm::RunToTheEnd() {
  for (int step = 0; step < 100'000 && !scheduler.Jobs().empty(); ++step) {
    bool worked = false;
    for (auto& [id, worker] : workers) {
      if (!worker.alive || worker.running.empty()) continue;
      Finish(id);
      worked = true;
    }
    if (!worked) PassWithBeats(lease_ / 6);
  }
  EXPECT_TRUE(scheduler.Jobs().empty()) << "the farm does not come to an end";
}

int FakeFarm::CountNotes(const std::string& event) const {
  return static_cast<int>(
      std::count_if(notes.begin(), notes.end(), [&](const Note& note) { return note.event == event; }));
}

int FakeFarm::CountGrants(TaskKind kind, int frame) const {
  return static_cast<int>(std::count_if(grants.begin(), grants.end(), [&](const Grant& grant) {
    return grant.task.spec.id.kind == kind && grant.task.spec.id.frame == frame;
  }));
}

void FakeFarm::Apply(const std::vector<Action>& actions) {
  for (const Action& action : actions) std::visit([this](const auto& typed) { Apply(typed); }, action);
  BeginTasks();
}

void FakeFarm::Apply(const Grant& grant) {
  grants.push_back(grant);
  const auto found = workers.find(grant.worker);
  if (found == workers.end() || !found->second.alive) return;  // the scheduler cannot know yet
  FakeWorker& worker = found->second;
  EXPECT_EQ(grant.ask_id, worker.asks) << "an ask is answered once";
  for (const auto& holders : grant.task.holders) EXPECT_FALSE(holders.empty());
  EXPECT_TRUE(worker.HasRoom()) << "a worker is given no more than it takes";
  worker.running.emplace(grant.lease, grant);
  if (worker.HasRoom()) to_ask_.push_back(grant.worker);
}

void FakeFarm::Apply(const AcknowledgeHeartbeat& answer) {
  for (const LeaseId lease : answer.unknown) Stop(answer.worker, lease);
}

void FakeFarm::Apply(const Revoke& revoke) {
  revokes.push_back(revoke);
  const auto worker = workers.find(revoke.worker);
  if (worker != workers.end() && worker->second.alive) Stop(revoke.worker, revoke.lease);
}

void FakeFarm::Stop(WorkerId worker, LeaseId lease) {
  auto& running = At(worker).running;
  const auto task = running.find(lease);
  if (stops_late || task == running.end()) return;
  to_report_.push_back({worker, lease, task->second.task.spec.id, Cancelled(), {}});
  running.erase(task);
}

void FakeFarm::Apply(const AskBack& ask) {
  asked_back.push_back(ask);
  to_answer_.push_back(ask);
}

void FakeFarm::Apply(const AttemptEnded& end) {
  EXPECT_TRUE(std::ranges::any_of(grants, [&](const Grant& grant) { return grant.lease == end.lease; }));
  EXPECT_TRUE(attempts_ended.emplace(end.lease, end).second) << "ended twice: " << TaskName(end.task);
}

void FakeFarm::Apply(const JobEnded& event) {
  EXPECT_TRUE(ended.emplace(event.job.id, event.job).second) << "a job ends once";
}

const Grant& RunUntil(FakeFarm& farm, WorkerId worker, TaskKind kind) {
  for (int i = 0; i < 1000 && farm.Running(worker).task.spec.id.kind != kind; ++i) farm.Finish(worker);
  EXPECT_EQ(farm.Running(worker).task.spec.id.kind, kind);
  return farm.Running(worker);
}

}  // namespace depthfarm
