#ifndef DEPTHFARM_COORDINATOR_SERVICE_TASK_FILTER_H_
#define DEPTHFARM_COORDINATOR_SERVICE_TASK_FILTER_H_

#include <set>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/job/task.h"

namespace depthfarm {

// Which tasks a user means: those whose name (TaskName) has all parts of the text, in any order. "frame 3 estimate
// block 0" and "estimate frame 3 block 0" name one task, "frame 3" all of a frame, "merge" all of a kind, "" all.
class TaskFilter {
 public:
  // kInvalidArgument: a word that no name has, or a number where none belongs.
  [[nodiscard]] static Result<TaskFilter> Parse(std::string_view text);

  [[nodiscard]] bool Matches(const TaskId& task) const;

 private:
  std::set<std::string> parts_;  // "frame 3", "estimate"
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_TASK_FILTER_H_
