#ifndef DEPTHFARM_WORKER_REFINEMENT_OTHER_VIEW_H_
#define DEPTHFARM_WORKER_REFINEMENT_OTHER_VIEW_H_

#include <optional>

#include "worker/refinement/picture_samples.h"
#include "worker/refinement/view_geometry.h"

namespace depthfarm {

// A colour difference of kKappa standard deviations counts half where planes are fitted: beyond, it tells of a
// silhouette. Where a pixel chooses between planes (Misfit) it does so at four times that: a pixel at a silhouette is a
// mixture that fits neither surface well, and the better one is to be told from the worse.
inline constexpr double kKappa = 3;
inline constexpr double kChoiceKappa = 12;

// Where a pixel at u appears in another view.
struct Seen {
  double x = 0;
  double y = 0;
  double u_in_other = 0;
  double dx = 0;  // dX / du, pixels per pixel of u
  double dy = 0;
};

// What of another view a view is compared with. All must outlive it.
struct OtherView {
  const PairGeometry* pair = nullptr;
  const ColourGrid* colour = nullptr;
  const InverseDepthMap* map = nullptr;
  double sigma = 1.5;  // of the colour differences, grey levels: MeasureNoise
};

// nullopt: outside the other view, behind it, or hidden there by a surface more than a pixel of u nearer in
// `other_map`.
[[nodiscard]] std::optional<Seen> SeenIn(const PairGeometry& pair, const InverseDepthMap& other_map, double x, double y,
                                         double u);

// Squared distance of two colours over Y, Cb, Cr.
[[nodiscard]] double SquaredDistance(const Colour& a, const Colour& b);

// Robust standard deviation of the colour differences of a view against another, at least 1.5 grey levels.
[[nodiscard]] double MeasureNoise(const ColourGrid& own, const InverseDepthMap& map, const OtherView& other);

// Depth (u of the other view) at the pixel where a point appears.
[[nodiscard]] double DepthAt(const InverseDepthMap& other_map, const Seen& seen);

// Whether all 3 x 3 pixels around where a point appears show what is more than a pixel of u farther. One that does not
// is enough to believe in the point: contours of two views do not meet to the pixel.
[[nodiscard]] bool SeesThrough(const InverseDepthMap& other_map, const Seen& seen);

// rho of a pixel that appears there: 0 (its colour fits) to 1.
[[nodiscard]] double MisfitAt(const Colour& own, const OtherView& other, const Seen& seen);

// rho of a pixel at u in one other view: 0 (fits) to 1; nullopt where it is not seen.
[[nodiscard]] std::optional<double> Misfit(const Colour& own, const OtherView& other, double x, double y, double u);

// The same, but 2 rho + 0.03 (at most 1) where the other view sees through the point: between two surfaces that fit
// alike it is not the one in mid-air.
[[nodiscard]] std::optional<double> MisfitInFreeSpace(const Colour& own, const OtherView& other, double x, double y,
                                                      double u);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_OTHER_VIEW_H_
