#include "coordinator/planning/cost_correction.h"

#include <algorithm>
#include <cmath>

namespace depthfarm {

void CostCorrection::Learn(TaskKind kind, bool i_frame, double predicted_seconds, double measured_seconds) {
  const auto counts = [](double seconds) { return std::isfinite(seconds) && seconds > 0; };
  if (!counts(predicted_seconds) || !counts(measured_seconds)) return;
  Ratio& ratio = ratios_[IndexOf(kind, i_frame)];
  ratio.measurements = std::min(ratio.measurements + 1, kMostRemembered);
  const double factor = std::clamp(measured_seconds / predicted_seconds, 1 / kMostFactor, kMostFactor);
  ratio.log_mean += (std::log(factor) - ratio.log_mean) / ratio.measurements;
}

double CostCorrection::Factor(TaskKind kind, bool i_frame) const {
  return std::exp(ratios_[IndexOf(kind, i_frame)].log_mean);
}

TaskCost CostCorrection::Corrected(TaskKind kind, bool i_frame, TaskCost cost) const {
  cost.seconds *= Factor(kind, i_frame);
  return cost;
}

}  // namespace depthfarm
