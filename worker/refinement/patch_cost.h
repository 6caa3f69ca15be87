#ifndef DEPTHFARM_WORKER_REFINEMENT_PATCH_COST_H_
#define DEPTHFARM_WORKER_REFINEMENT_PATCH_COST_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/job/resolved_job.h"
#include "worker/refinement/other_view.h"
#include "worker/refinement/patch_sums.h"
#include "worker/refinement/plane_field.h"
#include "worker/refinement/sight_kernels.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// How well planes fit the other views around pixels.
class PatchCost {
 public:
  // Both must outlive this. Of the other views, none of them smoothed, the first kMostCompared count.
  PatchCost(const YcbcrImage& own, std::span<const OtherView> others);

  // Sets the cost of the plane at each pixel: the mean misfit (MisfitInFreeSpace) of the 3 x 3 pixels around, those
  // alike in colour counting most, over the better half of the other views: an occluder hides a pixel from some. 0
  // (fits) to 1; 0.5 where no other view sees it. Patches overlap, so the misfit of a pixel is looked for once: ask for
  // all pixels of a plane at a time, row by row.
  void Costs(const SlantedPlane& plane, std::span<const PixelPosition> pixels, std::span<double> costs);

 private:
  // Patches are summed in windows of so many pixels: one word of bits tells which misfits of a row are needed, and
  // misfits stay in the nearer caches.
  static constexpr int kColumns = 62;
  static constexpr int kRows = 30;
  static constexpr std::size_t kStride = kColumns + 2;  // of a row of misfits: a pixel more to either side

  // Of the patches of `places_`, in the window from (left, top) on.
  void FindMisfits(const SlantedPlane& plane, int left, int top);
  void StoreMisfits();
  [[nodiscard]] PatchSums SumsAtBorder(const PatchPlace& place) const;
  void SumWindow(const SlantedPlane& plane, int left, int top, std::span<double> costs);

  const YcbcrImage& own_;
  std::vector<OtherView> others_;
  // Of the window.
  std::vector<PatchPlace> places_;
  std::vector<std::size_t> numbers_;  // of the places among the pixels that are asked for
  std::vector<PatchSums> sums_;
  std::vector<PixelMisfits> misfits_;
  // Pixels whose misfits are looked for, and where these go.
  PixelList list_;
  std::array<std::size_t, kListPixels> cells_{};
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PATCH_COST_H_
