#ifndef DEPTHFARM_COORDINATOR_FORECAST_LIST_SCHEDULE_H_
#define DEPTHFARM_COORDINATOR_FORECAST_LIST_SCHEDULE_H_

#include <cstdint>

#include "coordinator/forecast/task_graph.h"

namespace depthfarm {

// How a job would run on a farm of equal workers.
struct ListSchedule {
  double wall_seconds = 0;        // from the first grant to the last result
  double cpu_seconds = 0;         // of all workers, with reading what others made
  std::uint64_t moved_bytes = 0;  // inputs that a worker fetched from another one
};

// Plays the job through on `workers` (at least 1) workers that do nothing else and never fail: whenever one is free, a
// task of the GOP it is at home with goes to it, else of one without a home, else of any (GopHomes), the most urgent
// ready one (ByUrgency), of equally urgent ones the one whose inputs it holds most of; GOPs are opened as the scheduler
// opens them. A worker has one slot, takes nothing ahead and is never short of memory. What a worker has made or read
// it keeps. A task takes its predicted seconds, those to decode what it must fetch (CostModel::SecondsToRead) and
// kGrantSeconds; networks, disks and the coordinator are taken to keep up. Deterministic.
inline constexpr double kGrantSeconds = 2e-3;  // from a result to the next grant, 2 to 4 ms on one host
[[nodiscard]] ListSchedule PlayThrough(const TaskGraph& graph, int workers);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_FORECAST_LIST_SCHEDULE_H_
