#ifndef DEPTHFARM_WORKER_REFINEMENT_PATCH_COST_H_
#define DEPTHFARM_WORKER_REFINEMENT_PATCH_COST_H_

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "common/job/resolved_job.h"
#include "worker/refinement/other_view.h"
#include "worker/refinement/plane_field.h"

namespace depthfarm {

// How alike two colours are, 1 to 0. About exp(-d / 10) of the summed difference d of all components, without the
// library's exp, whose last bits differ between machines: (1 + d / 40)^-4.
[[nodiscard]] double ColourWeight(const Colour& a, const Colour& b);

// How well planes fit the other views around a pixel. Patches overlap, so the misfits of a plane are kept from pixel to
// pixel: ask for all pixels of a plane before the next one.
class PatchCost {
 public:
  // Both must outlive this. Of the other views the first kMostCompared count.
  PatchCost(const ColourGrid& own, std::span<const OtherView> others);

  // Mean misfit of the 3 x 3 pixels around (x, y), those alike in colour counting most, over the better half of the
  // other views: an occluder hides a pixel from some. 0 (fits) to 1; 0.5 where no other view sees it.
  [[nodiscard]] double At(int x, int y, PlaneIndex index, const SlantedPlane& plane);

 private:
  struct Misfits {  // of one pixel on the current plane
    std::uint32_t turn = 0;
    std::array<double, kMostCompared> rho{};  // kNotSeen where that view does not see it
  };
  [[nodiscard]] const Misfits& MisfitsAt(int x, int y, const SlantedPlane& plane);

  const ColourGrid& own_;
  std::span<const OtherView> others_;
  Grid<std::uint32_t> slot_;      // of a pixel in misfits_, 0: none yet
  std::vector<Misfits> misfits_;  // [0] is nobody's
  std::uint32_t turn_ = 0;        // counts changes of plane
  PlaneIndex current_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PATCH_COST_H_
