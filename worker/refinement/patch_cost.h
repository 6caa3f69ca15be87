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

// How well planes fit the other views around a pixel. Patches overlap, so the last misfits of a plane are kept: ask for
// all pixels of a plane before the next one, row by row.
class PatchCost {
 public:
  // Both must outlive this. Of the other views the first kMostCompared count.
  PatchCost(const YcbcrImage& own, std::span<const OtherView> others);

  // Mean misfit of the 3 x 3 pixels around (x, y), those alike in colour counting most, over the better half of the
  // other views: an occluder hides a pixel from some. 0 (fits) to 1; 0.5 where no other view sees it.
  [[nodiscard]] double At(int x, int y, PlaneIndex index, const SlantedPlane& plane);

 private:
  struct Misfits {  // of one pixel on the plane of a turn
    std::uint32_t turn = 0;
    int x = 0;
    int y = 0;
    std::array<double, kMostCompared> rho{};  // kNotSeen where that view does not see it
  };
  [[nodiscard]] const Misfits& MisfitsAt(int x, int y, const SlantedPlane& plane);

  const YcbcrImage& own_;
  std::vector<ColourFit> others_;
  std::vector<Misfits> recent_;  // kRows x kColumns, each pixel where its position modulo these says
  std::uint32_t turn_ = 0;       // counts changes of plane
  PlaneIndex current_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PATCH_COST_H_
