#include "coordinator/planning/job_plan.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "common/job/job_manifest.h"

namespace depthfarm {
namespace {

constexpr std::int64_t kMaxDepthFiles = 400'000;  // about 120 bytes each in a message of at most 64 MiB
constexpr std::int64_t kMaxTasksOfGop = 100'000;  // opened at once, which must take well less than a lease

std::uint64_t CountMerges(const std::vector<std::vector<MergePair>>& rounds) {
  std::uint64_t count = 0;
  for (const auto& pairs : rounds) {
    count += static_cast<std::uint64_t>(
        std::count_if(pairs.begin(), pairs.end(), [](const MergePair& pair) { return pair.second >= 0; }));
  }
  return count;
}

}  // namespace

bool MakesArtifact(TaskKind kind) {
  return kind == TaskKind::kAnalyse || kind == TaskKind::kEstimate || kind == TaskKind::kMerge ||
         kind == TaskKind::kRefine || kind == TaskKind::kAssess;
}

bool MakesFiles(TaskKind kind) { return kind == TaskKind::kEmit || kind == TaskKind::kRender; }

int NumParts(std::size_t num_views) { return static_cast<int>((num_views + kViewsPerPart - 1) / kViewsPerPart); }

Status CheckPlannable(const ResolvedJob& job) {
  const std::int64_t files = std::int64_t{job.num_frames} * job.num_views() * (job.params.confidence ? 2 : 1);
  if (files > kMaxDepthFiles) {
    return InvalidArgument("the job has " + std::to_string(files) + " depth and confidence files, expected at most " +
                           std::to_string(kMaxDepthFiles) + ": submit it in parts with --frames");
  }
  const std::int64_t frames = std::min(job.params.gop, job.num_frames);
  const std::int64_t tasks = frames * (std::int64_t{job.num_views()} * (2 + job.params.refine_rounds) +
                                       2 * std::int64_t{std::max(job.level_blocks_i, job.level_blocks_p)});
  if (tasks > kMaxTasksOfGop) {
    return InvalidArgument("a GOP of " + std::to_string(frames) + " frames has about " + std::to_string(tasks) +
                           " tasks, expected at most " + std::to_string(kMaxTasksOfGop) + ": choose a smaller --gop");
  }
  return {};
}

JobPlan::JobPlan(PlannedJob job)
    : job_(std::move(job)),
      rounds_i_(MergeRounds(resolved().level_blocks_i)),
      rounds_p_(MergeRounds(resolved().level_blocks_p)) {}

int JobPlan::num_gops() const { return resolved().num_gops(); }

const std::vector<std::vector<MergePair>>& JobPlan::Rounds(int frame) const {
  return resolved().IsIFrame(frame) ? rounds_i_ : rounds_p_;
}

bool JobPlan::MakesArtifact(TaskKind kind) const {
  return depthfarm::MakesArtifact(kind) || (keeps_results() && kind == TaskKind::kEmit);
}

std::vector<TaskId> JobPlan::TasksOfGop(int gop) const {
  const JobId job = job_.config.job;
  const int begin = gop * resolved().params.gop;
  const int end = std::min(begin + resolved().params.gop, resolved().num_frames);
  const int refine = resolved().params.refine_rounds;
  std::vector<TaskId> tasks;
  for (int frame = begin; frame < end; ++frame) {
    for (int view = 0; view < resolved().num_views(); ++view)
      tasks.push_back({job, frame, TaskKind::kAnalyse, view, 0});
    for (int block = 0; block < resolved().NumBlocks(frame); ++block) {
      tasks.push_back({job, frame, TaskKind::kEstimate, block, 0});
    }
    const auto& rounds = Rounds(frame);
    for (int round = 0; round < static_cast<int>(rounds.size()); ++round) {
      const auto& pairs = rounds[static_cast<std::size_t>(round)];
      for (int pair = 0; pair < static_cast<int>(pairs.size()); ++pair) {
        if (pairs[static_cast<std::size_t>(pair)].second >= 0)
          tasks.push_back({job, frame, TaskKind::kMerge, round, pair});
      }
    }
    for (int round = refine > 0 ? 0 : 1; round <= refine; round = RefineRoundAfter(frame, round)) {
      for (int view = 0; view < resolved().num_views(); ++view) tasks.push_back(Refined(frame, view, round));
    }
    for (int view = 0; resolved().params.assesses() && view < resolved().num_views(); ++view)
      tasks.push_back(Assessed(frame, view));
    tasks.push_back({job, frame, renders() ? TaskKind::kRender : TaskKind::kEmit, 0, 0});
    if (!keeps_results()) tasks.push_back({job, frame, TaskKind::kCommit, 0, 0});
  }
  return tasks;
}

TaskId JobPlan::PartialResult(int frame, int round, int index) const {
  const JobId job = job_.config.job;
  const auto& rounds = Rounds(frame);
  for (; round > 0; --round) {
    const MergePair& pair = rounds[static_cast<std::size_t>(round - 1)][static_cast<std::size_t>(index)];
    if (pair.second >= 0) return {job, frame, TaskKind::kMerge, round - 1, index};
    index = pair.first;
  }
  return {job, frame, TaskKind::kEstimate, index, 0};
}

TaskId JobPlan::FinalLabels(int frame) const { return PartialResult(frame, static_cast<int>(Rounds(frame).size()), 0); }

TaskId JobPlan::Refined(int frame, int view, int round) const {
  return {job_.config.job, frame, TaskKind::kRefine, round < 0 ? resolved().params.refine_rounds : round, view};
}

int JobPlan::RefineRoundAfter(int frame, int round) const {
  return round == 0 ? resolved().FirstRefineRound(frame) : round + 1;
}

std::vector<TaskId> JobPlan::SharedByGops() const {
  std::vector<TaskId> tasks;
  if (!shares_i_frame()) return tasks;
  for (int view = 0; view < resolved().num_views(); ++view) {
    tasks.push_back({job_.config.job, 0, TaskKind::kAnalyse, view, 0});
    if (resolved().params.refine_rounds > 0) tasks.push_back(Refined(0, view));
  }
  tasks.push_back(FinalLabels(0));
  return tasks;
}

TaskId JobPlan::Assessed(int frame, int view) const { return {job_.config.job, frame, TaskKind::kAssess, view, 0}; }

void JobPlan::AddAnalyses(int frame, InputRole role, std::vector<PlannedInput>& inputs) const {
  for (int view = 0; view < resolved().num_views(); ++view) {
    inputs.push_back({{job_.config.job, frame, TaskKind::kAnalyse, view, 0}, role, view});
  }
}

void JobPlan::AddInputsOfRefine(const TaskId& id, std::vector<PlannedInput>& inputs) const {
  const auto analysis = [&](int frame, int view) { return TaskId{id.job, frame, TaskKind::kAnalyse, view, 0}; };
  const int own = id.pair;
  if (id.index == 0) {
    const int i_frame = resolved().IFrameOf(id.frame);
    const bool refers = i_frame != id.frame;
    inputs.push_back({analysis(id.frame, own), InputRole::kAnalysis, own});
    if (refers) inputs.push_back({analysis(resolved().PreviousOf(id.frame), own), InputRole::kPreviousAnalysis, own});
    if (refers) inputs.push_back({analysis(i_frame, own), InputRole::kIAnalysis, own});
    inputs.push_back({FinalLabels(id.frame), InputRole::kLabels, 0});
    if (refers) inputs.push_back({Refined(resolved().PreviousOf(id.frame), own), InputRole::kPreviousRefined, own});
    if (refers) inputs.push_back({Refined(i_frame, own), InputRole::kIRefined, own});
    return;
  }
  AddCompared(id.frame, own, id.index == resolved().FirstRefineRound(id.frame) ? 0 : id.index - 1, inputs);
}

void JobPlan::AddCompared(int frame, int own, int round, std::vector<PlannedInput>& inputs) const {
  std::vector<int> views = resolved().views[static_cast<std::size_t>(own)].compared;
  views.push_back(own);
  std::sort(views.begin(), views.end());
  for (const int view : views)
    inputs.push_back({{job_.config.job, frame, TaskKind::kAnalyse, view, 0}, InputRole::kAnalysis, view});
  for (const int view : views) inputs.push_back({Refined(frame, view, round), InputRole::kRefined, view});
}

std::vector<PlannedInput> JobPlan::Inputs(const TaskId& id) const {
  std::vector<PlannedInput> inputs;
  switch (id.kind) {
    case TaskKind::kEstimate: {
      AddAnalyses(id.frame, InputRole::kAnalysis, inputs);
      if (resolved().IsIFrame(id.frame)) break;
      const int i_frame = resolved().IFrameOf(id.frame);
      AddAnalyses(resolved().PreviousOf(id.frame), InputRole::kPreviousAnalysis, inputs);
      inputs.push_back({FinalLabels(resolved().PreviousOf(id.frame)), InputRole::kPreviousLabels, 0});
      AddAnalyses(i_frame, InputRole::kIAnalysis, inputs);
      inputs.push_back({FinalLabels(i_frame), InputRole::kILabels, 0});
      break;
    }
    case TaskKind::kMerge: {
      AddAnalyses(id.frame, InputRole::kAnalysis, inputs);
      const MergePair& pair = Rounds(id.frame)[static_cast<std::size_t>(id.index)][static_cast<std::size_t>(id.pair)];
      inputs.push_back({PartialResult(id.frame, id.index, pair.first), InputRole::kLabels, 0});
      inputs.push_back({PartialResult(id.frame, id.index, pair.second), InputRole::kLabels, 0});
      break;
    }
    case TaskKind::kRefine:
      AddInputsOfRefine(id, inputs);
      break;
    case TaskKind::kAssess:
      AddCompared(id.frame, id.index, -1, inputs);
      break;
    case TaskKind::kEmit:
      if (resolved().params.refine_rounds > 0) {
        for (int view = 0; view < resolved().num_views(); ++view)
          inputs.push_back({Refined(id.frame, view), InputRole::kRefined, view});
        for (int view = 0; resolved().params.assesses() && view < resolved().num_views(); ++view)
          inputs.push_back({Assessed(id.frame, view), InputRole::kConfidence, view});
        break;
      }
      AddAnalyses(id.frame, InputRole::kAnalysis, inputs);
      inputs.push_back({FinalLabels(id.frame), InputRole::kLabels, 0});
      break;
    case TaskKind::kAnalyse:
      if (!resolved().IsIFrame(id.frame))
        inputs.push_back({{id.job, resolved().PreviousOf(id.frame), TaskKind::kAnalyse, id.index, 0},
                          InputRole::kPreviousAnalysis,
                          id.index});
      break;
    case TaskKind::kPrepare:
    case TaskKind::kRender:
    case TaskKind::kCommit:
    case TaskKind::kManifest:
    case TaskKind::kCleanup:
      break;
  }
  return inputs;
}

std::vector<TaskId> JobPlan::Prerequisites(const TaskId& id) const {
  std::vector<TaskId> tasks;
  for (const PlannedInput& input : Inputs(id)) tasks.push_back(input.producer);
  if (StagesFiles(id.kind) || id.kind == TaskKind::kManifest) tasks.push_back(OfJob(TaskKind::kPrepare));
  if (id.kind == TaskKind::kCommit)
    tasks.push_back({id.job, id.frame, renders() ? TaskKind::kRender : TaskKind::kEmit, 0, 0});
  std::sort(tasks.begin(), tasks.end());
  tasks.erase(std::unique(tasks.begin(), tasks.end()), tasks.end());
  return tasks;
}

std::uint64_t JobPlan::Total(TaskKind kind) const {
  const auto frames = static_cast<std::uint64_t>(resolved().num_frames);
  const std::uint64_t i_frames = shares_i_frame() ? 1 : static_cast<std::uint64_t>(num_gops());
  const std::uint64_t p_frames = frames - i_frames;
  switch (kind) {
    case TaskKind::kPrepare:
    case TaskKind::kManifest:
      return keeps_results() ? 0 : 1;
    case TaskKind::kAnalyse:
      return frames * static_cast<std::uint64_t>(resolved().num_views());
    case TaskKind::kEstimate:
      return i_frames * static_cast<std::uint64_t>(resolved().level_blocks_i) +
             p_frames * static_cast<std::uint64_t>(resolved().level_blocks_p);
    case TaskKind::kMerge:
      return i_frames * CountMerges(rounds_i_) + p_frames * CountMerges(rounds_p_);
    case TaskKind::kRefine: {
      const int refine = resolved().params.refine_rounds;
      if (refine == 0) return 0;
      // Round 0 comes besides. Frame 1 is a P frame where there are any.
      const auto rounds = [&](int frame) {
        return static_cast<std::uint64_t>(refine - resolved().FirstRefineRound(frame) + 2);
      };
      return static_cast<std::uint64_t>(resolved().num_views()) * (i_frames * rounds(0) + p_frames * rounds(1));
    }
    case TaskKind::kAssess:
      return resolved().params.assesses() ? frames * static_cast<std::uint64_t>(resolved().num_views()) : 0;
    case TaskKind::kRender:
      return renders() ? frames : 0;
    case TaskKind::kEmit:
      return renders() ? 0 : frames;
    case TaskKind::kCommit:
      return keeps_results() ? 0 : frames;
    case TaskKind::kCleanup:
      return 0;
  }
  return 0;
}

std::span<const VirtualPicture> JobPlan::ViewsOf(int part) const {
  const std::span<const VirtualPicture> all(job_.views);
  const std::size_t begin = static_cast<std::size_t>(part) * kViewsPerPart;
  return all.subspan(begin, std::min<std::size_t>(kViewsPerPart, all.size() - begin));
}

std::vector<std::string> JobPlan::OutputPaths(int frame) const {
  if (renders()) {
    std::vector<std::string> paths;
    for (const VirtualPicture& view : ViewsOf(frame)) paths.push_back(ViewFileName(view.number));
    return paths;
  }
  return FilesOfFrame(resolved(), frame);
}

}  // namespace depthfarm
