#include "coordinator/scheduling/task_table.h"

#include <tuple>

namespace depthfarm {

bool EndsAFrameOrJob(TaskKind kind) {
  return kind != TaskKind::kAnalyse && kind != TaskKind::kEstimate && kind != TaskKind::kMerge &&
         kind != TaskKind::kRefine && kind != TaskKind::kAssess;
}

bool ByUrgency::operator()(const TaskId& a, const TaskId& b) const {
  const auto rank = [](const TaskId& id) {
    return std::tuple(EndsAFrameOrJob(id.kind) ? 0 : 1, id.frame, -static_cast<int>(id.kind), id.index, id.pair);
  };
  return rank(a) < rank(b);
}

bool EquallyUrgent(const TaskId& a, const TaskId& b) { return a.frame == b.frame && a.kind == b.kind; }

bool Task::GoesOnWithout(LeaseId id) {
  if (!duplicate || !IsLeasedBy(id)) return false;
  if (lease == id) lease = *duplicate;
  duplicate.reset();
  return true;
}

Task& TaskTable::Add(const TaskId& id) { return tasks_[id]; }

Task* TaskTable::Find(const TaskId& id) {
  const auto task = tasks_.find(id);
  return task == tasks_.end() ? nullptr : &task->second;
}

const Task* TaskTable::Find(const TaskId& id) const {
  const auto task = tasks_.find(id);
  return task == tasks_.end() ? nullptr : &task->second;
}

void TaskTable::Remove(const TaskId& id) {
  ready_.erase(id);
  tasks_.erase(id);
}

void TaskTable::Clear() {
  ready_.clear();
  tasks_.clear();
}

void TaskTable::SetState(const TaskId& id, TaskState state) {
  tasks_.at(id).state = state;
  if (state == TaskState::kReady) {
    ready_.insert(id);
  } else {
    ready_.erase(id);
  }
}

ReadyRange TaskTable::ReadyOf(JobId job, int begin, int end) const {
  // The last stage is the most urgent one of a frame.
  const auto first = [&](int frame) { return ready_.lower_bound({job, frame, TaskKind::kAssess, 0, 0}); };
  return {first(begin), first(end)};
}

}  // namespace depthfarm
