#include <filesystem>
#include <iterator>
#include <ranges>
#include <utility>

#include "common/digest/sha256.h"
#include "common/job/job_manifest.h"
#include "coordinator/planning/job_plan.h"
#include "tests/simulation/simulated_worker.h"
#include "tests/simulation/task_model.h"
#include "worker/execution/output_folder.h"
#include "worker/execution/views_manifest.h"

// What a simulated worker computes.

namespace depthfarm::simulation {
namespace {

namespace event = lifecycle_event;

// Of jobs that go wrong in a way of their own: named so by who submits them.
constexpr const char* kPoison = "poison";
constexpr const char* kUnreadable = "unreadable";

bool NeedsFolder(TaskKind kind) {
  return kind == TaskKind::kPrepare || kind == TaskKind::kCommit || kind == TaskKind::kManifest ||
         kind == TaskKind::kCleanup;
}

}  // namespace

void SimulatedWorker::BeginTasks() {
  for (Running& task : tasks_) {
    if (std::ranges::count_if(tasks_, &Running::computing) >= shape_.slots) return;
    if (task.computing || task.stopping) continue;
    task.computing = true;
    task.begun = around_.events.now();
    const std::optional<TimePoint> expiry = lifecycle_->ExpiryOf(task.lease);
    if (!expiry || *expiry <= around_.events.now()) {
      TaskOutcome outcome;
      outcome.status = {ErrorCode::kLeaseExpired, "the lease ran out before the task was begun"};
      After(Milliseconds(0), Thread::kCompute, [this, lease = task.lease, outcome] { EndTask(lease, outcome); });
      continue;
    }
    ++tasks_begun_;
    around_.begun(*this, task.lease, task.spec);
    int missing = 0;
    for (const TaskInput& input : task.spec.inputs) missing += store_.contains(input.artifact.key) ? 0 : 1;
    After(Slowly(5, 30 + 100 * missing), Thread::kCompute, [this, lease = task.lease] { FetchInputs(lease); });
  }
}

bool SimulatedWorker::Fetch(const TaskInput& input) {
  if (Read(input.artifact.key) != nullptr) return true;
  return std::ranges::any_of(input.locations, [&](const ArtifactLocation& location) {
    const SimulatedWorker* holder = around_.find(location.endpoint);
    if (holder == nullptr || holder == this || around_.network.IsCut(name_, holder->name()) ||
        around_.network.IsCut(holder->name(), name_)) {
      return false;
    }
    if (holder->Serve(input.artifact.key) != input.artifact.content_digest) return false;
    Store(input.artifact);
    return true;
  });
}

void SimulatedWorker::FetchInputs(LeaseId lease) {
  const auto task = Find(lease);
  if (task == tasks_.end()) return;
  TaskOutcome outcome;
  for (const TaskInput& input : task->spec.inputs) {
    if (!Fetch(input)) outcome.missing_inputs.push_back(input.artifact.key);
  }
  if (!outcome.missing_inputs.empty()) {
    outcome.status = Unavailable("inputs can be had nowhere");
    After(Slowly(100, 2000), Thread::kCompute, [this, lease, outcome] { EndTask(lease, outcome); });
    return;
  }
  const int usual = NeedsFolder(task->spec.id.kind) ? 100 : 2000 * shape_.task_length;
  After(Slowly(usual / 10, usual), Thread::kCompute, [this, lease] { Compute(lease); });
}

// Half way.
void SimulatedWorker::Compute(LeaseId lease) {
  const auto task = Find(lease);
  if (task == tasks_.end()) return;
  const TaskId& id = task->spec.id;
  const bool poison =
      task->config->sequence_name == kPoison && (id.kind == TaskKind::kEstimate || id.kind == TaskKind::kRender);
  if (poison) around_.poisoned(id);
  if (poison || around_.random.Chance(around_.faults.runs_out_of_memory)) {
    Die();
    return;
  }
  if (MakesFiles(id.kind) && !task->config->keeps_results) (void)StageFiles(*task, 1);
  After(Slowly(10, 1000 * shape_.task_length), Thread::kCompute, [this, lease] { FinishTask(lease); });
}

void SimulatedWorker::FinishTask(LeaseId lease) {
  const auto task = Find(lease);
  if (task != tasks_.end()) EndTask(lease, Execute(*task));
}

TaskOutcome SimulatedWorker::Execute(const Running& task) {
  TaskOutcome outcome;
  const TaskSpec& spec = task.spec;
  outcome.stats.wall_seconds = outcome.stats.cpu_seconds =
      std::chrono::duration<double>(around_.events.now() - task.begun).count();
  if (around_.random.Chance(around_.faults.fails)) {
    outcome.status = Internal("by chance");
    return outcome;
  }
  const bool reads_pictures = spec.id.kind == TaskKind::kAnalyse || spec.id.kind == TaskKind::kRender;
  if (reads_pictures && task.config->sequence_name == kUnreadable) {
    outcome.status = InvalidArgument(spec.picture + ": is no picture");
    return outcome;
  }
  std::optional<ArtifactKey> key = spec.output_key;
  if (spec.id.kind == TaskKind::kAnalyse) {
    key = AnalysisKeyOf(spec);
    outcome.output_key = key;
    outcome.picture_digest = PictureDigestOf(spec);
    if (spec.known && spec.known->artifact.key == *key) (void)Fetch(*spec.known);
  }
  if (MakesFiles(spec.id.kind)) outcome.files = Describe(FilesOf(spec, *task.config));
  if (key) {
    if (const Stored* stored = Read(*key)) {
      outcome.artifact = stored->info;
      outcome.stats.reused = true;
      return outcome;
    }
    if (around_.random.Chance(around_.faults.disk_is_full)) {
      outcome.status = Unavailable("no space left on the device");
      return outcome;
    }
    outcome.artifact = ArtifactOf(spec, *key);
    Store(*outcome.artifact);
    return outcome;
  }
  outcome.status = WorkInFolder(task, outcome);
  return outcome;
}

Result<OutputFolder> SimulatedWorker::FolderOf(const Running& task) const {
  const StillLeased still_leased = [this, lease = task.lease] {
    const std::optional<TimePoint> expiry = lifecycle_->ExpiryOf(lease);
    return expiry && around_.events.now() < *expiry;
  };
  return OutputFolder::At(task.config->output_dir, task.config->render ? OutputContent::kViews : OutputContent::kDepth,
                          {task.config->claim, still_leased});
}

Status SimulatedWorker::StageFiles(const Running& task, std::size_t count) const {
  DEPTHFARM_ASSIGN_OR_RETURN(const OutputFolder folder, FolderOf(task));
  for (const MadeFile& file : FilesOf(task.spec, *task.config) | std::views::take(count))
    DEPTHFARM_RETURN_IF_ERROR(folder.Stage(task.spec.staging, file.path, file.bytes));
  return {};
}

Status SimulatedWorker::WorkInFolder(const Running& task, TaskOutcome& outcome) const {
  const TaskSpec& spec = task.spec;
  DEPTHFARM_ASSIGN_OR_RETURN(const OutputFolder folder, FolderOf(task));
  switch (spec.id.kind) {
    case TaskKind::kPrepare:
      return spec.files.empty() ? folder.Prepare() : folder.Resume(spec.files);
    case TaskKind::kEmit:
    case TaskKind::kRender:
      return StageFiles(task, outcome.files.size());
    case TaskKind::kCommit:
      return folder.Commit(spec.staging, spec.files);
    case TaskKind::kManifest: {
      if (task.config->render) {
        DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, FormatViewsManifest(*task.config, spec.views, spec.files));
        return folder.Finish(text);
      }
      DEPTHFARM_ASSIGN_OR_RETURN(const DepthManifest manifest,
                                 ManifestOf(*task.config, spec.files, spec.picture_digests));
      DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, FormatDepthManifest(manifest));
      return folder.Finish(text);
    }
    case TaskKind::kCleanup:
      return folder.RemoveStaging();
    default:
      return Internal(TaskName(spec.id) + ": is not simulated");
  }
}

void SimulatedWorker::StopTask(LeaseId lease) {
  const auto task = Find(lease);
  if (task == tasks_.end() || task->stopping) return;
  task->stopping = true;
  TaskOutcome outcome;
  outcome.status = Cancelled();
  // A task looks now and then whether it is stopped.
  const Milliseconds notice(task->computing ? around_.random.Int(0, 1000) : 0);
  After(notice, Thread::kCompute, [this, lease, outcome] { EndTask(lease, outcome); });
}

void SimulatedWorker::EndTask(LeaseId lease, TaskOutcome outcome) {
  const auto task = Find(lease);
  if (task == tasks_.end()) return;
  ended_ = LeasedOutcome{lease, task->spec.id, std::move(outcome)};
  tasks_.erase(task);
  Handle(event::TaskEnded{lease});
  ended_.reset();
  BeginTasks();
}

}  // namespace depthfarm::simulation
