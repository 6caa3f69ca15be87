#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_GOP_HOMES_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_GOP_HOMES_H_

#include <map>
#include <optional>
#include <vector>

#include "common/job/task.h"

namespace depthfarm {

// Which worker each GOP of one job is at home with: the one that got its first task. Frames of a GOP read each other's
// artifacts, those of two GOPs nothing, so that workers with a GOP each move the least. Others help only when they find
// no GOP of their own.
class GopHomes {
 public:
  // Nothing for a GOP that has a home.
  void Claim(int gop, WorkerId worker) { homes_.emplace(gop, worker); }
  void End(int gop) { homes_.erase(gop); }
  // Its GOPs are free for others.
  void Forget(WorkerId worker);

  [[nodiscard]] std::optional<WorkerId> HomeOf(int gop) const;
  // Ascending.
  [[nodiscard]] std::vector<int> Of(WorkerId worker) const;

 private:
  std::map<int, WorkerId> homes_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_GOP_HOMES_H_
