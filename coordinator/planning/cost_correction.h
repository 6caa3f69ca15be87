#ifndef DEPTHFARM_COORDINATOR_PLANNING_COST_CORRECTION_H_
#define DEPTHFARM_COORDINATOR_PLANNING_COST_CORRECTION_H_

#include <array>
#include <cstddef>

#include "common/job/task.h"
#include "coordinator/planning/cost_model.h"
#include "coordinator/planning/job_plan.h"

namespace depthfarm {

// Learns from finished tasks by which factor predictions are off, for each kind and frame type: the geometric mean of
// measured / predicted seconds. The prediction itself counts as one measurement, so that a single odd task does not
// decide; after kMostRemembered ones older ones fade. Factors stay within 1/kMostFactor .. kMostFactor. A function of
// what it was told, in order; tasks that found their artifact done must be left out by the caller.
class CostCorrection {
 public:
  static constexpr double kMostFactor = 16;
  static constexpr int kMostRemembered = 64;

  // Ignored unless both are finite and more than 0.
  void Learn(TaskKind kind, bool i_frame, double predicted_seconds, double measured_seconds);
  // 1 for what nothing is known of.
  [[nodiscard]] double Factor(TaskKind kind, bool i_frame) const;
  // `cost` with its seconds corrected.
  [[nodiscard]] TaskCost Corrected(TaskKind kind, bool i_frame, TaskCost cost) const;

 private:
  struct Ratio {
    double log_mean = 0;
    int measurements = 1;  // the prediction
  };
  [[nodiscard]] static std::size_t IndexOf(TaskKind kind, bool i_frame) {
    return 2 * static_cast<std::size_t>(kind) + (i_frame ? 1 : 0);
  }

  std::array<Ratio, 2 * static_cast<std::size_t>(kNumTaskKinds)> ratios_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_PLANNING_COST_CORRECTION_H_
