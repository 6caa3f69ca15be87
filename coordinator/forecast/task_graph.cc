#include "coordinator/forecast/task_graph.h"

#include <algorithm>
#include <map>

namespace depthfarm {

TaskGraph::TaskGraph(const JobPlan& plan, const CostModel& model) {
  const auto add = [&](const TaskId& id) {
    tasks_.push_back(id);
    costs_.push_back(model.Of(id));
    needs_begin_.push_back(needs_.size());
  };
  add(plan.OfJob(TaskKind::kPrepare));
  std::map<TaskId, Index> of_all = {{plan.OfJob(TaskKind::kPrepare), 0}};  // else GOPs need nothing of each other
  for (int gop = 0; gop < plan.num_gops(); ++gop) {
    gop_begin_.push_back(static_cast<Index>(tasks_.size()));
    std::map<TaskId, Index> index_of = of_all;
    for (const TaskId& id : plan.TasksOfGop(gop)) {
      index_of[id] = static_cast<Index>(tasks_.size());
      add(id);
      for (const TaskId& needed : plan.Prerequisites(id)) needs_.push_back(index_of.at(needed));
      std::sort(needs_.begin() + static_cast<std::ptrdiff_t>(needs_begin_.back()), needs_.end());
    }
    if (gop > 0) continue;
    for (const TaskId& id : plan.SharedByGops()) of_all[id] = index_of.at(id);
  }
  gop_begin_.push_back(static_cast<Index>(tasks_.size()));
  add(plan.OfJob(TaskKind::kManifest));
  for (Index index = 0; index + 1 < tasks_.size(); ++index)
    if (tasks_[index].kind == TaskKind::kCommit) needs_.push_back(index);
  needs_begin_.push_back(needs_.size());

  needed_by_begin_.assign(tasks_.size() + 1, 0);
  for (const Index needed : needs_) ++needed_by_begin_[needed + 1];
  for (std::size_t i = 0; i < tasks_.size(); ++i) needed_by_begin_[i + 1] += needed_by_begin_[i];
  std::vector<std::size_t> next(needed_by_begin_.begin(), needed_by_begin_.end() - 1);
  needed_by_.resize(needs_.size());
  for (Index index = 0; index < tasks_.size(); ++index)
    for (const Index needed : Needs(index)) needed_by_[next[needed]++] = index;
}

std::uint64_t TaskGraph::BytesRead(Index index) const {
  std::uint64_t bytes = 0;
  for (const Index needed : Needs(index))
    if (MakesArtifact(tasks_[needed].kind)) bytes += costs_[needed].result_bytes;
  return bytes;
}

}  // namespace depthfarm
