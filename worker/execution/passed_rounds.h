#ifndef DEPTHFARM_WORKER_EXECUTION_PASSED_ROUNDS_H_
#define DEPTHFARM_WORKER_EXECUTION_PASSED_ROUNDS_H_

#include <cstddef>
#include <deque>
#include <vector>

#include "common/job/task_spec.h"

namespace depthfarm {

// Which refined views of earlier rounds a worker need not keep in memory: a round reads the one before it alone. What
// is dropped too early (other views may be a round behind) comes back from the store. Not thread-safe.
class PassedRounds {
 public:
  // A task that is to be done, of any kind. Returns the keys of the refined views that were read or made by tasks
  // before and that it shows to have passed:
  //   Refine of a view: of that view before the last round but one, of those it is compared with one round more;
  //   Assess, Emit: of all views of the frame before the last round, which is what they read.
  [[nodiscard]] std::vector<ArtifactKey> PassedBy(const TaskSpec& spec);

 private:
  static constexpr std::size_t kMostRemembered = 4096;  // of several frames with many views

  struct Round {
    JobId job;
    int frame = 0;
    int view = 0;
    int round = 0;
    ArtifactKey key{};
  };
  void Remember(const Round& round);
  // Forgets the rounds of a view that are less than `round`; their keys are added to `passed`.
  void Take(const TaskId& of, int view, int round, std::vector<ArtifactKey>& passed);

  std::deque<Round> rounds_;  // in the order of their tasks
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_EXECUTION_PASSED_ROUNDS_H_
