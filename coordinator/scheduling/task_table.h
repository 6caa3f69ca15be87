#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_TASK_TABLE_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_TASK_TABLE_H_

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"

namespace depthfarm {

//   Blocked --all prerequisites there--> Ready --granted--> Leased --result--> Done
//                                          ^                  |                  |
//                                          +--failed, expired-+     its artifact was lost and is needed: Blocked again
enum class TaskState { kBlocked, kReady, kLeased, kDone };

struct Task {
  // Whether this is a lease that its result may come from.
  [[nodiscard]] bool IsLeasedBy(LeaseId id) const {
    return state == TaskState::kLeased && (lease == id || duplicate == id);
  }
  // The lease is over without a result. True if the task goes on with its other lease.
  bool GoesOnWithout(LeaseId id);

  TaskState state = TaskState::kBlocked;
  int failures = 0;                         // attempts that failed or were lost with their worker
  int deaths = 0;                           // of these, those whose worker or lease was lost
  int setbacks = 0;                         // times that inputs or the own artifact were lost
  int consumers = 0;                        // tasks that need this one and are not done
  int asked_back = 0;                       // the attempt for which a worker was asked to give it back; 0: none
  LeaseId lease;                            // of a leased task
  std::optional<LeaseId> duplicate;         // a second one of it
  bool was_duplicated = false;              // which it gets once
  std::string staging;                      // of a leased Emit: the folder it writes into
  std::optional<ArtifactKey> work;          // JobProgress::WorkOf, of a task that became ready
  std::optional<ArtifactKey> expected_key;  // of a leased Estimate, Merge, Refine or Assess
  std::set<WorkerId> failed_on;
  std::vector<TaskId> watchers;          // blocked tasks that look again when this one is done
  std::optional<ArtifactInfo> artifact;  // what it made last; names what to look for in the directory
  Status last_failure;                   // what the last of its failures said
};

// Most urgent first: what ends a frame (Prepare, Emit, Commit, Manifest, Cleanup), then earlier frames, and within a
// frame later stages.
struct ByUrgency {
  bool operator()(const TaskId& a, const TaskId& b) const;
};

// The first group of ByUrgency.
[[nodiscard]] bool EndsAFrameOrJob(TaskKind kind);

// True when policy sees no difference between two tasks of a job: the same frame and kind. Locality may choose.
[[nodiscard]] bool EquallyUrgent(const TaskId& a, const TaskId& b);

// Ready tasks, most urgent first.
class ReadyRange {
 public:
  using Iterator = std::set<TaskId, ByUrgency>::const_iterator;
  ReadyRange(Iterator begin, Iterator end) : begin_(begin), end_(end) {}
  [[nodiscard]] Iterator begin() const { return begin_; }
  [[nodiscard]] Iterator end() const { return end_; }

 private:
  Iterator begin_;
  Iterator end_;
};

// The tasks of the open GOPs of one job, with an index of the ready ones.
class TaskTable {
 public:
  Task& Add(const TaskId& id);
  // Null when the task's GOP is not open.
  [[nodiscard]] Task* Find(const TaskId& id);
  [[nodiscard]] const Task* Find(const TaskId& id) const;
  void Remove(const TaskId& id);
  void Clear();

  void SetState(const TaskId& id, TaskState state);
  [[nodiscard]] const std::set<TaskId, ByUrgency>& ready() const { return ready_; }
  // Of the frames from `begin` to before `end`, without those that end a frame or job.
  [[nodiscard]] ReadyRange ReadyOf(JobId job, int begin, int end) const;
  [[nodiscard]] const std::map<TaskId, Task>& tasks() const { return tasks_; }
  [[nodiscard]] std::size_t size() const { return tasks_.size(); }

 private:
  std::map<TaskId, Task> tasks_;
  std::set<TaskId, ByUrgency> ready_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_TASK_TABLE_H_
