#ifndef DEPTHFARM_WORKER_MINDING_MINDED_END_H_
#define DEPTHFARM_WORKER_MINDING_MINDED_END_H_

#include <string>

#include "common/job/task_spec.h"

namespace depthfarm {

// How a process ended that was minded.
struct MindedEnd {
  int exit_code = 0;  // valid when signal == 0
  int signal = 0;     // that killed it, 0: it exited
  TaskLog
      last_words;  // the end of what it wrote to stderr but routine (LogCollector::AddText), bounded as a task's log
};

// "was killed by signal 6 (Aborted)", "exited with code 1".
[[nodiscard]] std::string Describe(const MindedEnd& end);

// Ends this process in the same way, so that whoever waits for it sees what became of the other. Without a core dump:
// that is the other's.
[[noreturn]] void EndLike(const MindedEnd& end);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MINDING_MINDED_END_H_
