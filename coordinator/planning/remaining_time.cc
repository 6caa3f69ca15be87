#include "coordinator/planning/remaining_time.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace depthfarm {
namespace {

constexpr std::uint64_t kLeastMeasured = 3;
// So many measured tasks count as much as what is believed without them.
constexpr double kTasksToBelieve = 3;
constexpr double kGrantSeconds = 2e-3;  // from a result to the next grant, 2 to 4 ms on one host
constexpr std::size_t kPFrame = 0;
constexpr std::size_t kIFrame = 1;

double Blend(double ratio, std::uint64_t tasks, double without) {
  const double weight = static_cast<double>(tasks) / (static_cast<double>(tasks) + kTasksToBelieve);
  return weight * ratio + (1 - weight) * without;
}

constexpr std::size_t kAnalyses = 0;
constexpr std::size_t kLabels = 1;
constexpr std::size_t kDepth = 2;
constexpr std::size_t kFiles = 3;

std::size_t LinkOf(TaskKind kind) {
  if (kind == TaskKind::kAnalyse) return kAnalyses;
  if (kind == TaskKind::kEstimate || kind == TaskKind::kMerge) return kLabels;
  return kind == TaskKind::kRefine ? kDepth : kFiles;
}

// Tasks of a frame that follow each other are told apart by this; those alike in it run side by side.
int StepOf(const TaskId& id) { return id.kind == TaskKind::kMerge || id.kind == TaskKind::kRefine ? id.index : 0; }

}  // namespace

RemainingTime::RemainingTime(const JobPlan& plan, const CostModel& costs) : plan_(plan), costs_(costs) {
  const ResolvedJob& job = plan.resolved();
  // Frames of a type cost the same: the first of each stands for all.
  std::array<std::map<std::pair<TaskKind, int>, double>, 2> longest;
  Classes of_frame;
  std::vector<TaskId> samples = plan.TasksOfGop(0);
  if (job.params.gop == 1 && job.HasPFrames()) {  // all GOPs share an I frame
    const std::vector<TaskId> next = plan.TasksOfGop(1);
    samples.insert(samples.end(), next.begin(), next.end());
  }
  for (const TaskId& id : samples) {
    const double cost = Cost(id);
    const std::size_t type = job.IsIFrame(id.frame) ? kIFrame : kPFrame;
    if (id.frame != (type == kIFrame ? 0 : 1)) continue;
    of_frame[type][static_cast<std::size_t>(id.kind)].total += cost;
    of_frame_[type][LinkOf(id.kind)] += cost;
    double& step = longest[type][{id.kind, StepOf(id)}];
    step = std::max(step, cost);
  }
  int i_frames = 0;
  for (int gop = 0; gop < plan.num_gops(); ++gop) i_frames += job.IsIFrame(gop * job.params.gop) ? 1 : 0;
  for (const std::size_t type : {kPFrame, kIFrame}) {
    const int frames = type == kIFrame ? i_frames : job.num_frames - i_frames;
    for (std::size_t kind = 0; kind < kNumTaskKinds; ++kind)
      classes_[type][kind].total = of_frame[type][kind].total * frames;
    for (const auto& [step, cost] : longest[type])
      classes_[type][static_cast<std::size_t>(step.first)].of_chain += cost;
  }
  for (const TaskKind kind : {TaskKind::kPrepare, TaskKind::kManifest}) {
    const TaskId id = plan.OfJob(kind);
    ClassOf(id).total = Cost(id);
  }
}

int RemainingTime::FramesOfGop(int gop) const {
  const int frames = plan_.resolved().params.gop;
  return std::min(frames, plan_.resolved().num_frames - gop * frames);
}

RemainingTime::LinksOfTypes RemainingTime::LinksOfGop(int gop) const {
  const int i_frames = plan_.resolved().IsIFrame(gop * plan_.resolved().params.gop) ? 1 : 0;
  LinksOfTypes seconds = of_frame_;
  for (double& link : seconds[kIFrame]) link *= i_frames;
  for (double& link : seconds[kPFrame]) link *= FramesOfGop(gop) - i_frames;
  return seconds;
}

double RemainingTime::SecondsLeftOf(int gop) const {
  const auto sum = [](const LinksOfTypes& types) {
    double seconds = 0;
    for (const Links& links : types) seconds = std::accumulate(links.begin(), links.end(), seconds);
    return seconds;
  };
  const auto done = open_gops_.find(gop);
  return std::max(0.0, sum(LinksOfGop(gop)) - (done == open_gops_.end() ? 0 : sum(done->second)));
}

double RemainingTime::Cost(const TaskId& id) const { return costs_.Of(id).seconds + kGrantSeconds; }

RemainingTime::Class& RemainingTime::ClassOf(const TaskId& id) {
  return classes_[plan_.resolved().IsIFrame(id.frame) ? kIFrame : kPFrame][static_cast<std::size_t>(id.kind)];
}

const RemainingTime::Class& RemainingTime::ClassOf(const TaskId& id) const {
  return classes_[plan_.resolved().IsIFrame(id.frame) ? kIFrame : kPFrame][static_cast<std::size_t>(id.kind)];
}

std::optional<double> RemainingTime::SecondsOf(const TaskId& id) const {
  const Class& of = ClassOf(id);
  if (of.tasks_measured < kLeastMeasured) return std::nullopt;
  return Cost(id) * RatioOf(of, RatioOfAll());
}

void RemainingTime::AddToGop(const TaskId& id, double seconds) {
  const bool of_job = id.kind == TaskKind::kPrepare || id.kind == TaskKind::kManifest || id.kind == TaskKind::kCleanup;
  // Of a GOP that is over only what other GOPs need of it is done again.
  if (of_job || closed_gops_.contains(plan_.GopOf(id.frame))) return;
  const std::size_t type = plan_.resolved().IsIFrame(id.frame) ? kIFrame : kPFrame;
  open_gops_[plan_.GopOf(id.frame)][type][LinkOf(id.kind)] += seconds;
}

void RemainingTime::Done(const TaskId& id) {
  const double cost = Cost(id);
  ClassOf(id).done += cost;
  AddToGop(id, cost);
}

void RemainingTime::Undone(const TaskId& id) {
  const double cost = Cost(id);
  ClassOf(id).done -= cost;
  AddToGop(id, -cost);
}

void RemainingTime::Measured(const TaskId& id, double seconds) {
  Class& of = ClassOf(id);
  of.predicted += Cost(id);
  of.measured += seconds + kGrantSeconds;
  ++of.tasks_measured;
}

void RemainingTime::Close(int gop) {
  open_gops_.erase(gop);
  closed_gops_.insert(gop);
}

void RemainingTime::OpenAgain(int gop) {
  closed_gops_.erase(gop);
  open_gops_.emplace(gop, LinksOfGop(gop));
}

double RemainingTime::RatioOfAll() const {
  double predicted = 0;
  double measured = 0;
  std::uint64_t tasks = 0;
  for (const auto& type : classes_) {
    for (const Class& of : type) {
      predicted += of.predicted;
      measured += of.measured;
      tasks += of.tasks_measured;
    }
  }
  return predicted > 0 ? Blend(measured / predicted, tasks, 1) : 1;
}

double RemainingTime::RatioOf(const Class& of, double of_all) const {
  return of.predicted > 0 ? Blend(of.measured / of.predicted, of.tasks_measured, of_all) : of_all;
}

RemainingTime::LinksOfTypes RemainingTime::ChainOfFrame(double of_all) const {
  LinksOfTypes chain{};
  for (const std::size_t type : {kPFrame, kIFrame}) {
    for (std::size_t kind = 0; kind < kNumTaskKinds; ++kind) {
      const Class& of = classes_[type][kind];
      chain[type][LinkOf(static_cast<TaskKind>(kind))] += of.of_chain * RatioOf(of, of_all);
    }
  }
  return chain;
}

double RemainingTime::ChainLeft(int gop, const LinksOfTypes& done, const LinksOfTypes& chain) const {
  const LinksOfTypes all = LinksOfGop(gop);
  const auto left = [&](std::size_t type, std::size_t link) {
    return all[type][link] > 0 ? std::clamp(1 - done[type][link] / all[type][link], 0.0, 1.0) : 0;
  };
  const int p_frames = FramesOfGop(gop) - (plan_.resolved().IsIFrame(gop * plan_.resolved().params.gop) ? 1 : 0);
  double longest = 0;
  double i_frame = 0;
  for (std::size_t link = 0; link < kLinks; ++link) {
    i_frame += left(kIFrame, link) * chain[kIFrame][link];
    // All P frames' tasks of this link, or the last one's files, then the last one's of the others.
    double p_links = left(kPFrame, link) * chain[kPFrame][link] * (link == kFiles ? 1 : p_frames);
    if (p_links > 0)
      for (std::size_t next = link + 1; next < kLinks; ++next) p_links += chain[kPFrame][next];
    longest = std::max(longest, i_frame + p_links);
  }
  return longest;
}

std::optional<double> RemainingTime::Seconds(double slots, std::span<const TaskId> computing) const {
  std::uint64_t tasks = 0;
  for (const auto& type : classes_)
    for (const Class& of : type) tasks += of.tasks_measured;
  if (tasks < kLeastMeasured || slots <= 0) return std::nullopt;
  const double of_all = RatioOfAll();
  double left = 0;
  for (const auto& type : classes_)
    for (const Class& of : type) left += std::max(0.0, of.total - of.done) * RatioOf(of, of_all);
  for (const TaskId& id : computing) {
    left -= 0.5 * Cost(id) * RatioOf(ClassOf(id), of_all);
  }
  const LinksOfTypes chain = ChainOfFrame(of_all);
  double longest = 0;
  // Of GOPs that have not begun the first is the longest, or as long.
  if (static_cast<int>(closed_gops_.size() + open_gops_.size()) < plan_.num_gops()) longest = ChainLeft(0, {}, chain);
  for (const auto& [gop, done] : open_gops_) longest = std::max(longest, ChainLeft(gop, done, chain));
  return std::max(left / slots, longest);
}

}  // namespace depthfarm
