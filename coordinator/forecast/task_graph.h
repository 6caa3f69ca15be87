#ifndef DEPTHFARM_COORDINATOR_FORECAST_TASK_GRAPH_H_
#define DEPTHFARM_COORDINATOR_FORECAST_TASK_GRAPH_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "coordinator/planning/cost_model.h"
#include "coordinator/planning/job_plan.h"

namespace depthfarm {

// All tasks of a job, with what they need and cost, in flat arrays. A task is its index: Prepare first, then GOP by
// GOP, Manifest last, so that whatever a task needs comes before it.
class TaskGraph {
 public:
  using Index = std::uint32_t;

  // Time and memory grow with the number of tasks: it is for the caller to bound it.
  TaskGraph(const JobPlan& plan, const CostModel& model);

  [[nodiscard]] std::size_t size() const { return tasks_.size(); }
  [[nodiscard]] const TaskId& task(Index index) const { return tasks_[index]; }
  [[nodiscard]] const TaskCost& cost(Index index) const { return costs_[index]; }
  // The tasks that must be done before, each once, ascending.
  [[nodiscard]] std::span<const Index> Needs(Index index) const { return Row(needs_, needs_begin_, index); }
  // The tasks that wait for it.
  [[nodiscard]] std::span<const Index> NeededBy(Index index) const { return Row(needed_by_, needed_by_begin_, index); }

  [[nodiscard]] std::size_t num_gops() const { return gop_begin_.size() - 1; }
  // The tasks of GOP g: [GopBegin(g), GopBegin(g + 1)).
  [[nodiscard]] Index GopBegin(std::size_t gop) const { return gop_begin_[gop]; }

  // Stored bytes that the task reads: artifacts of others, each once.
  [[nodiscard]] std::uint64_t BytesRead(Index index) const;

 private:
  [[nodiscard]] static std::span<const Index> Row(const std::vector<Index>& values,
                                                  const std::vector<std::size_t>& begin, Index index) {
    return std::span(values).subspan(begin[index], begin[index + 1] - begin[index]);
  }

  std::vector<TaskId> tasks_;
  std::vector<TaskCost> costs_;
  std::vector<Index> gop_begin_;
  std::vector<Index> needs_;
  std::vector<std::size_t> needs_begin_;
  std::vector<Index> needed_by_;
  std::vector<std::size_t> needed_by_begin_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_FORECAST_TASK_GRAPH_H_
