// What a task is told when it is granted, and what it must bring back.
#include <algorithm>
#include <utility>

#include "coordinator/scheduling/job_progress.h"

namespace depthfarm {
namespace {

// Where a worker is told to look for an input; more would only make messages longer.
constexpr std::size_t kMaxHolders = 8;

// Unique to the attempt: what an orphan of an older one still writes is never taken for the accepted one's.
std::string StagingName(int frame, int attempt, LeaseId lease) {
  return "f" + std::to_string(frame) + "-a" + std::to_string(attempt) + "-l" + std::to_string(lease.value());
}

// Digests in place of paths, which mean something on the submitter's machine alone.
std::pair<std::string, GuideFiles> NamesOf(const SourceDigests& files) {
  const auto name = [](const std::optional<UploadedFile>& upload) {
    return upload ? std::string(upload->file.sha256.begin(), upload->file.sha256.end()) : std::string();
  };
  return {name(files.picture), {name(files.mask), name(files.prior), name(files.prior_confidence)}};
}

}  // namespace

std::vector<WorkerId> HoldersToTell(const ArtifactDirectory& directory, const ArtifactKey& key, LeaseId lease) {
  const std::set<WorkerId>& all = directory.Holders(key);
  std::vector<WorkerId> holders(all.begin(), all.end());
  if (holders.empty()) return holders;
  // Different tasks begin with different holders, so that one worker does not serve them all.
  const std::size_t shift = static_cast<std::size_t>(lease.value() % holders.size());
  std::rotate(holders.begin(), holders.begin() + static_cast<std::ptrdiff_t>(shift), holders.end());
  if (holders.size() > kMaxHolders) holders.resize(kMaxHolders);
  return holders;
}

std::vector<TaskInput> JobProgress::BoundInputs(const TaskId& id) const {
  std::vector<TaskInput> inputs;
  for (const PlannedInput& planned : plan_.Inputs(id)) {
    const Task* producer = table_.Find(planned.producer);
    if (producer == nullptr || !producer->artifact) continue;
    const ArtifactInfo* artifact = directory_.Find(producer->artifact->key);
    if (artifact != nullptr) inputs.push_back({*artifact, planned.role, planned.view, {}});
  }
  return inputs;
}

std::vector<ArtifactInfo> JobProgress::InputsOf(const TaskId& id) const {
  std::vector<ArtifactInfo> artifacts;
  for (const TaskInput& input : BoundInputs(id)) artifacts.push_back(input.artifact);
  return artifacts;
}

std::optional<ArtifactKey> JobProgress::OutputKey(const TaskId& id, const std::vector<TaskInput>& inputs) const {
  if (!plan_.MakesArtifact(id.kind) || id.kind == TaskKind::kAnalyse) return std::nullopt;  // its worker finds the name
  std::vector<ArtifactKeys::Input> keys;
  keys.reserve(inputs.size());
  for (const TaskInput& input : inputs) keys.push_back({input.role, input.artifact.key});
  if (id.kind == TaskKind::kMerge) return keys_.Merge(keys);
  if (id.kind == TaskKind::kRefine) return keys_.Refine(id.index, id.pair, keys);
  if (id.kind == TaskKind::kAssess) return keys_.Assess(id.index, keys);
  if (id.kind == TaskKind::kEmit) return keys_.Emit(plan_.resolved().params.first_frame + id.frame, keys);
  return keys_.Estimate(plan_.resolved().NumBlocks(id.frame), id.index, keys);
}

ArtifactKey JobProgress::AnalysisRequest(const TaskId& id) const {
  const PlannedJob& job = plan_.job();
  const auto view = static_cast<std::size_t>(id.index);
  const auto frame = static_cast<std::size_t>(id.frame);
  std::vector<ArtifactKeys::Input> inputs;
  for (const TaskInput& input : BoundInputs(id)) inputs.push_back({input.role, input.artifact.key});
  if (!job.uploads.empty()) {
    const auto [picture, guides] = NamesOf(job.uploads[view][frame]);
    return ArtifactKeys::AnalysisRequest(job.config, id.index, picture, guides, inputs);
  }
  return ArtifactKeys::AnalysisRequest(job.config, id.index, job.pictures[view][frame],
                                       job.guides.empty() ? GuideFiles{} : job.guides[view][frame], inputs);
}

TaskSpec JobProgress::Spec(const TaskId& id) const {
  TaskSpec spec;
  spec.id = id;
  spec.inputs = BoundInputs(id);
  spec.output_key = OutputKey(id, spec.inputs);
  if (id.kind == TaskKind::kAnalyse) {
    const PlannedJob& job = plan_.job();
    const auto view = static_cast<std::size_t>(id.index);
    const auto frame = static_cast<std::size_t>(id.frame);
    spec.picture = job.pictures[view][frame];
    if (!job.guides.empty()) spec.guides = job.guides[view][frame];
    if (!job.uploads.empty()) spec.uploads = UploadedSources{job.uploads[view][frame], job.uploads_from};
  }
  if (id.kind == TaskKind::kPrepare) spec.files = DoneFiles();
  if (id.kind == TaskKind::kCommit) {
    spec.staging = emitted_.at(id.frame).staging;
    spec.files = emitted_.at(id.frame).files;
  }
  if (id.kind == TaskKind::kManifest) {
    spec.files = DoneFiles();
    spec.picture_digests = results_.picture_digests;
    spec.views = plan_.job().views;
  }
  if (id.kind == TaskKind::kRender) {
    const std::span<const VirtualPicture> views = plan_.ViewsOf(id.frame);
    spec.views.assign(views.begin(), views.end());
  }
  return spec;
}

std::optional<GrantedTask> JobProgress::Take(const TaskId& id, LeaseId lease) {
  Queue(id);  // what was there when it became ready may be lost or made by now
  Settle();
  Task* task = table_.Find(id);
  if (task == nullptr || task->state != TaskState::kReady) return std::nullopt;
  GrantedTask granted{Spec(id), {}, {}};
  if (plan_.StagesFiles(id.kind)) granted.spec.staging = StagingName(id.frame, task->failures + 1, lease);
  for (const TaskInput& input : granted.spec.inputs)
    granted.holders.push_back(HoldersToTell(directory_, input.artifact.key, lease));
  table_.SetState(id, TaskState::kLeased);
  task->lease = lease;
  task->duplicate.reset();
  task->staging = granted.spec.staging;
  task->expected_key = granted.spec.output_key;
  if (id.kind == TaskKind::kPrepare) prepare_was_granted_ = true;
  return granted;
}

std::optional<GrantedTask> JobProgress::TakeAgain(const TaskId& id, LeaseId lease) {
  Task* task = table_.Find(id);
  const bool once = task != nullptr && task->state == TaskState::kLeased && !task->was_duplicated;
  // Two attempts that both name an artifact name the same one. Two that write files could meet in the output folder
  // after the job has given it up.
  if (!once || !plan_.MakesArtifact(id.kind)) return std::nullopt;
  GrantedTask granted{Spec(id), {}, {}};
  if (granted.spec.inputs.size() != plan_.Inputs(id).size() || granted.spec.output_key != task->expected_key)
    return std::nullopt;
  for (const TaskInput& input : granted.spec.inputs)
    granted.holders.push_back(HoldersToTell(directory_, input.artifact.key, lease));
  task->duplicate = lease;
  task->was_duplicated = true;
  return granted;
}

Status JobProgress::CheckResult(const TaskFinished& result, const Task& task) const {
  const TaskId& id = result.task;
  if (plan_.MakesArtifact(id.kind) && !result.artifact) return Internal(TaskName(id) + " ended without an artifact");
  if (task.expected_key && result.artifact->key != *task.expected_key) {
    return Internal(TaskName(id) + " ended with an artifact of another name than its output key");
  }
  if (id.kind == TaskKind::kAnalyse && !result.picture_digest) {
    return Internal(TaskName(id) + " ended without the digest of its picture");
  }
  if (!MakesFiles(id.kind)) return {};
  const std::vector<std::string> expected = plan_.OutputPaths(id.frame);
  if (result.files.size() != expected.size()) {
    return Internal(TaskName(id) + " wrote " + std::to_string(result.files.size()) + " files, expected " +
                    std::to_string(expected.size()));
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const std::string& path = result.files[i].path;
    if (path != expected[i]) return Internal(TaskName(id) + " wrote '" + path + "', expected '" + expected[i] + "'");
  }
  return {};
}

}  // namespace depthfarm
