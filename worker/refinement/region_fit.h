#ifndef DEPTHFARM_WORKER_REFINEMENT_REGION_FIT_H_
#define DEPTHFARM_WORKER_REFINEMENT_REGION_FIT_H_

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "worker/refinement/other_view.h"
#include "worker/refinement/plane_field.h"
#include "worker/refinement/sight_kernels.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// How a depth of some pixels fits the other views.
struct Judgement {
  std::vector<float> misfits;  // [pixel][other view]; RegionFit::kUnseen: that view does not see it
  double cost = 0;             // of each pixel that any view sees the mean over those that see it, summed
  std::size_t seen = 0;        // pixels that any view sees
};

// Compares pixels of one view with what other views show, for surfaces that are decided as a whole.
class RegionFit {
 public:
  static constexpr float kUnseen = -1;

  // What `others` refer to must outlive this.
  RegionFit(const PictureColours& own, std::span<const OtherView> others) : own_(own), others_(others) {}

  [[nodiscard]] const PictureColours& own() const { return own_; }

  // `depth_at`(x, y): u of a pixel.
  template <typename Depth>
  [[nodiscard]] Judgement Judge(std::span<const PixelPosition> pixels, const Depth& depth_at) const {
    Judgement judgement;
    PixelList list;
    for (std::size_t next = 0; next < pixels.size();) {
      list.count = 0;
      own_.With([&](const auto& picture) {
        for (; next < pixels.size() && list.count < kListPixels; ++next) {
          const auto [x, y] = pixels[next];
          list.Add(picture, x, y, depth_at(x, y));
        }
      });
      AddTo(judgement, list);
    }
    return judgement;
  }

  // How much worse pixel i fits by `a` than by `b`: by the views that see it on both, since views differ in how well
  // they fit what is right. If none does, as at borders, where one view sees it on one and another on the other, by
  // the means.
  [[nodiscard]] double Excess(const Judgement& a, const Judgement& b, std::size_t i) const;
  // Of all pixels, summed.
  [[nodiscard]] double Excess(const Judgement& a, const Judgement& b) const;

 private:
  void AddTo(Judgement& judgement, PixelList& list) const;

  PictureColours own_;
  std::span<const OtherView> others_;
};

// A place that a plane is fitted to.
struct DepthPoint {
  double x = 0;  // pixels
  double y = 0;
  double u = 0;
};

// Robust least squares in a few rounds of weights. Slopes are drawn a little towards none, for points may nearly be a
// line; `center`: from where they count. Nothing of fewer than 4 points.
[[nodiscard]] std::optional<SlantedPlane> FitPlane(std::span<const DepthPoint> points, double center_x,
                                                   double center_y);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_REGION_FIT_H_
