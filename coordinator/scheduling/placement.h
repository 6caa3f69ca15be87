#ifndef DEPTHFARM_COORDINATOR_SCHEDULING_PLACEMENT_H_
#define DEPTHFARM_COORDINATOR_SCHEDULING_PLACEMENT_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "common/job/task.h"

namespace depthfarm {

// Locality chooses among at most so many equally urgent tasks: more would cost time and gain little.
inline constexpr std::size_t kMaxCandidates = 16;

// A ready task that is as urgent as the others of its span.
struct TaskCandidate {
  TaskId task;
  std::map<WorkerId, std::uint64_t> local_bytes;  // how much of its inputs a worker holds
  // Of the free ones: not large enough, held for another task; or it failed there, if there are others.
  std::set<WorkerId> avoid = {};
  std::set<WorkerId> full = {};   // large enough, but not beside the tasks it has
  std::uint64_t input_bytes = 0;  // of all of its inputs
};

struct Placement {
  TaskId task;
  WorkerId worker;
  bool operator==(const Placement&) const = default;
};

// Which of some equally urgent tasks goes to which free worker: the pair with the most input bytes in place; ties go to
// the first task, then to the worker that has waited longest. `free_workers`: longest waiting first. None if every free
// worker is one to avoid.
[[nodiscard]] std::optional<Placement> ChoosePlacement(std::span<const TaskCandidate> tasks,
                                                       std::span<const WorkerId> free_workers);

// Whether a worker that has another GOP or none helps where one is at work on a GOP: not where it would read its task's
// missing inputs too long for what is left of that GOP (RemainingTime::SecondsLeftOf). It reads as much for other
// tasks, and what it makes is read by the one it helps.
[[nodiscard]] bool IsHelpWorthReading(std::uint64_t missing_bytes, double seconds_left_of_gop);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SCHEDULING_PLACEMENT_H_
