#ifndef DEPTHFARM_COORDINATOR_PLANNING_REMAINING_TIME_H_
#define DEPTHFARM_COORDINATOR_PLANNING_REMAINING_TIME_H_

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>

#include "coordinator/planning/cost_model.h"
#include "coordinator/planning/job_plan.h"

namespace depthfarm {

// How long a job will still take: what its tasks are predicted to (CostModel), corrected by how long those that ended
// took. Tasks are told apart by kind and, of P frames, from those of I frames; as long as few of such tasks have ended,
// what was seen of all others counts, and as long as few have ended at all, the prediction.
//
// Keeps sums alone: the work per task and per question grows with the GOPs that are open, never with the job.
class RemainingTime {
 public:
  // Both must outlive it. Work: the tasks of one GOP, and the number of GOPs.
  RemainingTime(const JobPlan& plan, const CostModel& costs);

  // A task was done, by computing or because its result was there.
  void Done(const TaskId& id);
  // Its result was lost: it will be done again.
  void Undone(const TaskId& id);
  // The slot of a worker was taken for so long by a task that was computed.
  void Measured(const TaskId& id, double seconds);
  // All tasks of a GOP are done for good; some are not after all, and Undone will say which.
  void Close(int gop);
  void OpenAgain(int gop);

  // Predicted seconds of what is left of a GOP that is open, of one slot.
  [[nodiscard]] double SecondsLeftOf(int gop) const;

  // How long such a task is expected to take a slot; nothing while fewer than three of its kind and type of frame were
  // measured.
  [[nodiscard]] std::optional<double> SecondsOf(const TaskId& id) const;

  // From now on, if the job has `slots` slots (of a share of the farm: also less than one) as long as it has work for
  // them: the tasks that are left, of those that compute now half, spread over the slots; no less than what is left
  // of the longest chain of tasks in a GOP takes. Nothing while fewer than three tasks were measured, or without slots.
  [[nodiscard]] std::optional<double> Seconds(double slots, std::span<const TaskId> computing) const;

 private:
  // Of a kind, and of I or P frames.
  struct Class {
    double total = 0;      // predicted seconds of all its tasks
    double done = 0;       // of those that are done
    double of_chain = 0;   // of those of one frame that must follow each other
    double predicted = 0;  // of those that were measured
    double measured = 0;
    std::uint64_t tasks_measured = 0;
  };
  using Classes = std::array<std::array<Class, kNumTaskKinds>, 2>;  // P frames, I frames

  // What a frame is made of, each waiting for the one before it: analyses, labels, depth, files. All but files also
  // wait for their like of the frame before.
  static constexpr std::size_t kLinks = 4;
  using Links = std::array<double, kLinks>;   // seconds
  using LinksOfTypes = std::array<Links, 2>;  // P frames, I frames

  [[nodiscard]] double Cost(const TaskId& id) const;
  [[nodiscard]] Class& ClassOf(const TaskId& id);
  [[nodiscard]] const Class& ClassOf(const TaskId& id) const;
  void AddToGop(const TaskId& id, double seconds);
  // Measured to predicted.
  [[nodiscard]] double RatioOfAll() const;
  [[nodiscard]] double RatioOf(const Class& of, double of_all) const;
  [[nodiscard]] int FramesOfGop(int gop) const;
  // Predicted seconds of a GOP's frames.
  [[nodiscard]] LinksOfTypes LinksOfGop(int gop) const;
  // Corrected seconds of tasks of a frame that must follow each other.
  [[nodiscard]] LinksOfTypes ChainOfFrame(double of_all) const;
  // Of the longest chain in a GOP in which so much is done. `chain`: of a frame.
  [[nodiscard]] double ChainLeft(int gop, const LinksOfTypes& done, const LinksOfTypes& chain) const;

  const JobPlan& plan_;
  const CostModel& costs_;
  Classes classes_;
  LinksOfTypes of_frame_{};                // predicted seconds of a frame
  std::map<int, LinksOfTypes> open_gops_;  // of what is done there
  std::set<int> closed_gops_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_PLANNING_REMAINING_TIME_H_
