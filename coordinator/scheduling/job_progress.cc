#include "coordinator/scheduling/job_progress.h"

#include <algorithm>
#include <utility>

namespace depthfarm {
JobProgress::JobProgress(PlannedJob job, const ArtifactDirectory& directory, int max_setbacks,
                         const CommittedFrames& committed, bool ran_before)
    : plan_(std::move(job)),
      keys_(plan_.job().config),
      costs_(plan_.resolved()),
      remaining_(plan_, costs_),
      directory_(directory),
      max_setbacks_(max_setbacks) {
  const auto frames = static_cast<std::size_t>(plan_.resolved().num_frames);
  results_.frames.resize(frames);
  results_.picture_digests.resize(frames * plan_.resolved().views.size());
  for (int kind = 0; kind < kNumTaskKinds; ++kind) {
    stages_[static_cast<std::size_t>(kind)].tasks_total = plan_.Total(static_cast<TaskKind>(kind));
  }
  if (!committed.empty()) committed_before_.resize(frames);
  for (const auto& [frame, done] : committed) AddCommitted(frame, done);
  if (plan_.keeps_results()) {
    confirmed_ = committed.empty();
    return;
  }
  prepare_was_granted_ = ran_before;  // its folder may need a Cleanup
  table_.Add(plan_.OfJob(TaskKind::kPrepare));
  Queue(plan_.OfJob(TaskKind::kPrepare));
  if (frames_done_ == plan_.resolved().num_frames) {
    AddManifest();
    OpenNextGop();  // counts the tasks of all GOPs, whose turn may not come before the end
  }
  Settle();
}

void JobProgress::AddCommitted(int frame, const CommittedFrame& committed) {
  const auto f = static_cast<std::size_t>(frame);
  results_.frames[f] = {committed.files, committed.bundle};
  committed_before_[f] = true;
  std::ranges::copy(committed.picture_digests,
                    results_.picture_digests.begin() + static_cast<std::ptrdiff_t>(f * plan_.resolved().views.size()));
  if (committed.bundle) frame_of_bundle_[committed.bundle->key] = frame;
  files_done_ += static_cast<int>(committed.files.size());
  ++frames_done_;
}

bool JobProgress::IsBehind(const TaskId& id) const {
  return !committed_before_.empty() && EndsAFrameOrJob(id.kind) &&
         committed_before_[static_cast<std::size_t>(id.frame)];
}

bool JobProgress::PassOver(int gop) {
  const bool all_committed = frames_done_ == plan_.resolved().num_frames;
  if (committed_before_.empty() || (gop == 0 && plan_.shares_i_frame() && !all_committed)) return false;
  const std::vector<TaskId> tasks = plan_.TasksOfGop(gop);
  const auto done = [&](const TaskId& id) { return committed_before_[static_cast<std::size_t>(id.frame)]; };
  if (!std::ranges::all_of(tasks, done)) return false;
  for (const TaskId& id : tasks) {
    ++Stage(id.kind).tasks_done;
    ++Stage(id.kind).reused;
    remaining_.Done(id);
  }
  remaining_.Close(gop);
  return true;
}

void JobProgress::OpenNextGop() {
  while (HasUnopenedGop()) {
    const bool passed_over = PassOver(next_gop_);
    if (!passed_over) Open(next_gop_);
    ++next_gop_;
    if (!HasUnopenedGop()) {  // all who read what GOPs share count by now
      for (const TaskId& id : plan_.SharedByGops())
        if (table_.Find(id) != nullptr) NotNeededBy(id);
      Settle();
    }
    if (!passed_over) return;
  }
}

void JobProgress::Open(int gop) {
  const std::vector<TaskId> tasks = plan_.TasksOfGop(gop);
  for (const TaskId& id : tasks) table_.Add(id);
  int frames = 0;
  for (const TaskId& id : tasks) {
    if (IsBehind(id)) {
      table_.SetState(id, TaskState::kDone);
      ++Stage(id.kind).tasks_done;
      ++Stage(id.kind).reused;
      remaining_.Done(id);
      if (plan_.keeps_results()) {
        table_.Find(id)->consumers = 1;
        SetArtifact(id, *results_.frames[static_cast<std::size_t>(id.frame)].bundle);
      }
      continue;
    }
    for (const TaskId& needed : plan_.Prerequisites(id)) ++table_.Find(needed)->consumers;
    frames += id.kind == plan_.EndOfFrame() ? 1 : 0;
    if (id.kind == TaskKind::kEmit && plan_.keeps_results()) ++table_.Find(id)->consumers;  // whoever fetches it
    Queue(id);
  }
  if (gop == 0) {
    for (const TaskId& id : plan_.SharedByGops()) ++table_.Find(id)->consumers;
  }
  if (frames > 0) open_gops_[gop] = frames;
  Settle();
  if (frames > 0) return;
  remaining_.Close(gop);
  RemoveTasks(gop, false);  // of a first GOP that is committed but for its I frame that others need
}

void JobProgress::Settle() {
  while (!to_activate_.empty()) {
    const TaskId id = to_activate_.back();
    to_activate_.pop_back();
    Activate(id);
  }
}

bool JobProgress::IsSatisfied(const TaskId& id) const {
  const Task* task = table_.Find(id);
  if (task == nullptr || task->state != TaskState::kDone) return false;
  return !plan_.MakesArtifact(id.kind) || (task->artifact && directory_.Find(task->artifact->key) != nullptr);
}

void JobProgress::Activate(const TaskId& id) {
  Task* task = table_.Find(id);
  if (task == nullptr || task->state == TaskState::kDone || task->state == TaskState::kLeased) return;
  if (plan_.MakesArtifact(id.kind) && task->consumers == 0) {  // was lost, and meanwhile nobody needs it
    MarkDone(id);
    return;
  }
  bool watching = false;
  for (const TaskId& needed : plan_.Prerequisites(id)) {
    if (IsSatisfied(needed)) continue;
    Task* other = table_.Find(needed);
    if (!watching) other->watchers.push_back(id);
    watching = true;
    if (other->state == TaskState::kDone) Reopen(needed);
  }
  if (watching) {
    table_.SetState(id, TaskState::kBlocked);
    return;
  }
  task->work = id.kind == TaskKind::kAnalyse ? AnalysisRequest(id) : OutputKey(id, BoundInputs(id));
  // Of the files in a bundle its worker tells the digests.
  if (task->work && id.kind != TaskKind::kAnalyse && id.kind != TaskKind::kEmit) {
    if (const ArtifactInfo* artifact = directory_.Find(*task->work)) {
      SetArtifact(id, *artifact);
      ++Stage(id.kind).reused;
      MarkDone(id);
      return;
    }
  }
  table_.SetState(id, TaskState::kReady);
}

void JobProgress::CountSetback(const TaskId& id) {
  Task* task = table_.Find(id);
  if (task != nullptr && ++task->setbacks > max_setbacks_) worn_out_ = id;
}

void JobProgress::Reopen(const TaskId& id) {
  table_.SetState(id, TaskState::kBlocked);
  --Stage(id.kind).tasks_done;
  remaining_.Undone(id);
  CountSetback(id);
  if (id.kind == plan_.EndOfFrame()) LoseFrame(id.frame);
  for (const TaskId& needed : plan_.Prerequisites(id)) ++table_.Find(needed)->consumers;
  Queue(id);
}

void JobProgress::MarkDone(const TaskId& id) {
  table_.SetState(id, TaskState::kDone);
  ++Stage(id.kind).tasks_done;
  remaining_.Done(id);
  for (const TaskId& needed : plan_.Prerequisites(id)) NotNeededBy(needed);
  const std::vector<TaskId> watchers = std::exchange(table_.Find(id)->watchers, {});
  for (const TaskId& watcher : watchers) Queue(watcher);
  if (id.kind == plan_.EndOfFrame()) CommitFrame(id.frame);
}

void JobProgress::NotNeededBy(const TaskId& id) {
  Task* task = table_.Find(id);
  if (--task->consumers > 0 || !plan_.MakesArtifact(id.kind)) return;
  if (task->artifact && !Needs(task->artifact->key)) released_.push_back(task->artifact->key);
  Queue(id);  // a lost one need not run again
}

void JobProgress::RemoveTasks(int gop, bool of_shared_frame) {
  for (const TaskId& id : plan_.TasksOfGop(gop)) {
    if ((plan_.shares_i_frame() && id.frame == 0) != of_shared_frame) continue;
    const Task* task = table_.Find(id);
    if (task == nullptr) continue;
    if (task->artifact) ForgetProducer(id, task->artifact->key);
    if (task->state != TaskState::kDone) {  // done before, lost, and being made again for nobody
      ++Stage(id.kind).tasks_done;
      remaining_.Done(id);
      for (const TaskId& needed : plan_.Prerequisites(id)) {
        if (table_.Find(needed) != nullptr) NotNeededBy(needed);
      }
    }
    table_.Remove(id);
  }
}

void JobProgress::CommitFrame(int frame) {
  const auto emitted = emitted_.find(frame);
  JobResults::Frame& result = results_.frames[static_cast<std::size_t>(frame)];
  for (const OutputFile& file : emitted->second.files) result.files.push_back({file.sha256, file.bytes});
  if (plan_.keeps_results()) {
    result.bundle = table_.Find(plan_.Emitted(frame))->artifact;
    frame_of_bundle_[result.bundle->key] = frame;
  }
  files_done_ += static_cast<int>(emitted->second.files.size());
  emitted_.erase(emitted);
  ++frames_done_;
  const int gop = plan_.GopOf(frame);
  if (--open_gops_.at(gop) == 0) {
    RemoveTasks(gop, false);
    remaining_.Close(gop);
    open_gops_.erase(gop);
  }
  if (frames_done_ < plan_.resolved().num_frames) return;
  if (plan_.shares_i_frame()) RemoveTasks(0, true);
  if (plan_.keeps_results()) {
    done_ = confirmed_;
  } else {
    AddManifest();
  }
}

void JobProgress::AddManifest() {
  const TaskId manifest = plan_.OfJob(TaskKind::kManifest);
  table_.Add(manifest);
  for (const TaskId& needed : plan_.Prerequisites(manifest)) ++table_.Find(needed)->consumers;
  Queue(manifest);
}

CommittedFrame JobProgress::CommittedOf(int frame) const {
  const auto views = static_cast<std::ptrdiff_t>(plan_.resolved().views.size());
  const auto first = results_.picture_digests.begin() + frame * views;
  const JobResults::Frame& done = results_.frames[static_cast<std::size_t>(frame)];
  return {done.files, {first, first + views}, done.bundle};
}

std::vector<OutputFile> JobProgress::DoneFiles() const {
  std::vector<OutputFile> all;
  for (int frame = 0; frame < plan_.resolved().num_frames; ++frame) {
    const std::vector<FileDigest>& files = results_.frames[static_cast<std::size_t>(frame)].files;
    if (files.empty()) continue;
    const std::vector<std::string> paths = plan_.OutputPaths(frame);
    for (std::size_t i = 0; i < files.size(); ++i) all.push_back({paths[i], files[i].sha256, files[i].bytes});
  }
  return all;
}

void JobProgress::SetArtifact(const TaskId& id, const ArtifactInfo& artifact) {
  Task& task = *table_.Find(id);
  if (task.artifact && task.artifact->key != artifact.key) ForgetProducer(id, task.artifact->key);
  task.artifact = artifact;
  producers_[artifact.key].insert(id);
}

void JobProgress::ForgetProducer(const TaskId& id, const ArtifactKey& key) {
  const auto producers = producers_.find(key);
  producers->second.erase(id);
  if (producers->second.empty()) producers_.erase(producers);
}

void JobProgress::PutBack(const TaskId& id) {
  Task* task = table_.Find(id);
  if (task == nullptr || task->state != TaskState::kLeased) return;
  task->duplicate.reset();
  table_.SetState(id, TaskState::kBlocked);
  Queue(id);
  Settle();
}

Result<bool> JobProgress::Finish(const TaskFinished& result) {
  const TaskId& id = result.task;
  Task& task = *table_.Find(id);
  DEPTHFARM_RETURN_IF_ERROR(CheckResult(result, task));
  task.duplicate.reset();
  bool changed_content = false;
  if (plan_.MakesArtifact(id.kind)) {
    changed_content = task.artifact && task.artifact->key == result.artifact->key && *task.artifact != *result.artifact;
    SetArtifact(id, *result.artifact);
  }
  if (id.kind == TaskKind::kAnalyse) {
    const auto position = static_cast<std::size_t>(id.frame) * plan_.resolved().views.size();
    results_.picture_digests[position + static_cast<std::size_t>(id.index)] = *result.picture_digest;
  }
  if (MakesFiles(id.kind)) emitted_[id.frame] = {task.staging, result.files};
  StageSnapshot& stage = Stage(id.kind);
  stage.cpu_seconds += result.stats.cpu_seconds;
  stage.wall_seconds += result.stats.wall_seconds;
  stage.peak_memory_bytes = std::max(stage.peak_memory_bytes, result.stats.peak_memory_bytes);
  stage.fetched_bytes += result.stats.fetched_bytes;
  stage.sweeps += result.stats.sweeps;
  stage.reused += result.stats.reused ? 1 : 0;
  if (result.stats.left_aside) {
    ++stage.left_aside;
    if (!stage.first_left_aside || id < *stage.first_left_aside) stage.first_left_aside = id;
  }
  if (!result.stats.reused) remaining_.Measured(id, result.stats.wall_seconds);
  done_ = id.kind == TaskKind::kManifest || id.kind == TaskKind::kCleanup;
  MarkDone(id);
  Settle();
  return changed_content;
}

void JobProgress::LoseArtifacts(const std::vector<ArtifactKey>& keys) {
  for (const ArtifactKey& key : keys) {
    const auto producers = producers_.find(key);
    if (producers == producers_.end()) continue;
    for (const TaskId& id : producers->second) {
      const Task* task = table_.Find(id);
      if (task->state == TaskState::kDone && task->consumers > 0) Reopen(id);
    }
  }
  for (const ArtifactKey& key : keys) {
    const auto lost = frame_of_bundle_.find(key);  // of a GOP that is closed: that of an open one was reopened above
    if (lost == frame_of_bundle_.end() || abandoned_) continue;
    if (plan_.GopOf(lost->second) < next_gop_) {
      RestoreGop(plan_.GopOf(lost->second));
    } else {  // was committed before, and its turn has not come
      committed_before_[static_cast<std::size_t>(lost->second)] = false;
      DropResult(lost->second);
    }
  }
  Settle();
}

void JobProgress::ConfirmCommitted() {
  confirmed_ = true;
  std::vector<ArtifactKey> lost;
  for (const auto& [key, frame] : frame_of_bundle_) {
    if (directory_.Find(key) == nullptr) lost.push_back(key);
  }
  LoseArtifacts(lost);
  if (frames_done_ < plan_.resolved().num_frames) return;
  OpenNextGop();  // counts the tasks of GOPs that were passed over
  done_ = true;
}

void JobProgress::DropResult(int frame) {
  lost_frames_.push_back(frame);
  JobResults::Frame& result = results_.frames[static_cast<std::size_t>(frame)];
  --frames_done_;
  files_done_ -= static_cast<int>(result.files.size());
  frame_of_bundle_.erase(result.bundle->key);
  result = {};
}

void JobProgress::LoseFrame(int frame) {
  DropResult(frame);
  if (++open_gops_[plan_.GopOf(frame)] == 1) remaining_.OpenAgain(plan_.GopOf(frame));
  if (++losses_[frame] > max_setbacks_) worn_out_ = plan_.Emitted(frame);
}

void JobProgress::RestoreGop(int gop) {
  // The I frame that GOPs share leaves with the last frame, and a job that waits to be confirmed may lose one after
  // that.
  const std::vector<TaskId> shared = plan_.SharedByGops();
  if (gop > 0 && !shared.empty() && table_.Find(shared.front()) == nullptr) RestoreGop(0);
  std::vector<TaskId> tasks = plan_.TasksOfGop(gop);
  std::erase_if(tasks, [&](const TaskId& id) { return table_.Find(id) != nullptr; });  // of the I frame that GOPs share
  remaining_.OpenAgain(gop);
  for (const TaskId& id : tasks) {
    table_.Add(id);
    --Stage(id.kind).tasks_done;
    remaining_.Undone(id);
  }
  for (const TaskId& id : tasks) {
    if (id.kind == TaskKind::kEmit) {
      table_.Find(id)->consumers = 1;
      const std::optional<ArtifactInfo> bundle = results_.frames[static_cast<std::size_t>(id.frame)].bundle;
      if (directory_.Find(bundle->key) != nullptr) {
        SetArtifact(id, *bundle);
        table_.SetState(id, TaskState::kDone);
        ++Stage(id.kind).tasks_done;
        remaining_.Done(id);
        continue;  // it reads nothing: what only this frame needed is found to be needed by nobody
      }
      LoseFrame(id.frame);
    }
    for (const TaskId& needed : plan_.Prerequisites(id)) ++table_.Find(needed)->consumers;
    Queue(id);
  }
}

bool JobProgress::Needs(const ArtifactKey& key) const {
  if (frame_of_bundle_.contains(key)) return true;
  const auto producers = producers_.find(key);
  return producers != producers_.end() && std::any_of(producers->second.begin(), producers->second.end(),
                                                      [&](const TaskId& id) { return table_.Find(id)->consumers > 0; });
}

std::vector<ArtifactKey> JobProgress::TakeReleased() { return std::exchange(released_, {}); }

void JobProgress::Abandon() {
  for (const auto& [key, producers] : producers_) released_.push_back(key);
  producers_.clear();
  table_.Clear();
  emitted_.clear();
  open_gops_.clear();
  worn_out_.reset();
  next_gop_ = plan_.num_gops();
  abandoned_ = true;
}

void JobProgress::StartCleanup() {
  table_.Add(plan_.OfJob(TaskKind::kCleanup));
  Stage(TaskKind::kCleanup).tasks_total = 1;
  Queue(plan_.OfJob(TaskKind::kCleanup));
  Settle();
}

}  // namespace depthfarm
