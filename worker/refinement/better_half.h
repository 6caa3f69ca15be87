#ifndef DEPTHFARM_WORKER_REFINEMENT_BETTER_HALF_H_
#define DEPTHFARM_WORKER_REFINEMENT_BETTER_HALF_H_

#include <array>
#include <cstddef>

#include "common/job/resolved_job.h"

namespace depthfarm {

// Mean misfit over the better half of the other views that see a pixel: an occluder hides it from some.
class BetterHalf {
 public:
  static constexpr double kUnseen = 0.5;  // where no view sees it

  // At most kMostCompared times.
  void Add(double misfit) {
    std::size_t at = count_++;
    for (; at > 0 && misfits_[at - 1] > misfit; --at) misfits_[at] = misfits_[at - 1];
    misfits_[at] = misfit;
  }

  [[nodiscard]] double Mean() const {
    if (count_ == 0) return kUnseen;
    const std::size_t half = (count_ + 1) / 2;
    double sum = 0;
    for (std::size_t i = 0; i < half; ++i) sum += misfits_[i];
    return sum / static_cast<double>(half);
  }

 private:
  std::array<double, kMostCompared> misfits_{};  // ascending
  std::size_t count_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_BETTER_HALF_H_
