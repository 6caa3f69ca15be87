#ifndef DEPTHFARM_WORKER_REFINEMENT_DATA_TERM_H_
#define DEPTHFARM_WORKER_REFINEMENT_DATA_TERM_H_

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "worker/refinement/picture_samples.h"
#include "worker/refinement/view_geometry.h"

namespace depthfarm {

using InverseDepthMap = Grid<float>;  // u per pixel (SlantedPlane)

// Where a pixel at u appears in another view.
struct Seen {
  double x = 0;
  double y = 0;
  double u_in_other = 0;
  double dx = 0;  // dX / du, pixels per pixel of u
  double dy = 0;
};

// nullopt: outside the other view, behind it, or hidden there by a surface more than a pixel of u nearer in
// `other_map`.
[[nodiscard]] std::optional<Seen> SeenIn(const PairGeometry& pair, const InverseDepthMap& other_map, double x, double y,
                                         double u);

// Normal equations of one segment in (a, b, u at the centre), for the change of its plane: H (6: aa ab ac bb bc cc).
struct NormalEquations {
  std::array<double, 6> h{};
  std::array<double, 3> rhs{};
};

// What of other views a view is compared with.
struct OtherView {
  const PairGeometry* pair = nullptr;
  const ColourGrid* colour = nullptr;
  const InverseDepthMap* map = nullptr;
  double sigma = 1.5;  // of the residuals, grey levels; set by MeasureNoise
};

// Robust standard deviation of the colour differences, at least 1.5 grey levels.
[[nodiscard]] double MeasureNoise(const ColourGrid& own, const InverseDepthMap& map, const OtherView& other);

// Gauss-Newton on the colour differences of all pixels of each segment against each other view; an other view that does
// not fit a segment (a silhouette) counts less there.
[[nodiscard]] std::vector<NormalEquations> DataTerm(const ColourGrid& own, const InverseDepthMap& map,
                                                    const Grid<SegmentIndex>& segments,
                                                    std::span<const PixelPosition> centers,
                                                    std::span<const OtherView> others, bool blurred);

// Draws each segment's centre to the depth that the other views have where it is seen, unless that is far off (more
// than about half a pixel of u) or at a jump there.
void AddAgreement(const InverseDepthMap& map, std::span<const PixelPosition> centers, std::span<const OtherView> others,
                  std::vector<NormalEquations>& equations);

// rho of a pixel at u in one other view: 0 (fits) to 1; nullopt where it is not seen.
[[nodiscard]] std::optional<double> Misfit(const Colour& own, const OtherView& other, double x, double y, double u);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_DATA_TERM_H_
