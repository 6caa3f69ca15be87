#ifndef DEPTHFARM_WORKER_COST_MATCHING_H_
#define DEPTHFARM_WORKER_COST_MATCHING_H_

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "common/geometry/depth_levels.h"
#include "common/geometry/reprojection.h"
#include "common/image/picture.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// m of eq. (4), times the number of samples: sum over the window of the L1 difference of Y, Cb, Cr between `view`
// around `center` and `neighbour` around `target`. Open in the paper: a window that leaves a picture. Its samples
// outside are left out and the mean is over the rest (a border is no evidence for or against); `samples` tells how many
// were inside both, at least 1 as both centres are.
struct WindowDifference {
  std::int32_t sum = 0;
  std::int32_t samples = 0;
};
[[nodiscard]] WindowDifference WindowColorDifference(const YcbcrImage& view, const YcbcrImage& neighbour,
                                                     PixelPosition center, PixelPosition target, int window);

// -M of eq. (5) for a pair of segments on one level: max(0, K - m) in match steps (1/9 grey level), rounded up from the
// exact mean, so at most 9 * 765.
[[nodiscard]] std::uint16_t MatchReward(const WindowDifference& difference, std::int32_t offset_steps);

// The rewards of one segment against many places of a neighbour's picture, the same integers as MatchReward of
// WindowColorDifference, on vectors for the paper's 3x3 window; 0 where a target is kNoTarget. Targets that repeat the
// one before cost nothing. rewards: as many as targets.
inline constexpr PixelPosition kNoTarget{-1, -1};
void MatchRewards(const YcbcrImage& view, const YcbcrImage& neighbour, PixelPosition center,
                  std::span<const PixelPosition> targets, int window, std::int32_t offset_steps,
                  std::span<std::uint16_t> rewards);

// K of eq. (5) in match steps.
[[nodiscard]] std::int32_t MatchOffsetSteps(double matching_offset);

// T[mu_s] of eq. (4) for one view and one of its neighbours.
class MatchGeometry {
 public:
  MatchGeometry(const Camera& view, const Camera& neighbour, const DepthLevels& levels);

  // The neighbour's pixel nearest to where the centre of a segment appears on `level`; none where the ray does not meet
  // the plane in front of both cameras or the point leaves the neighbour's picture (no reward, no link: open in the
  // paper). Nearest pixel, as the window of eq. (4) is of whole pixels.
  [[nodiscard]] std::optional<PixelPosition> Target(PixelPosition center, Level level) const;

  // The same on any plane parallel to the levels, also one beyond infinity: where else along its epipolar line the
  // segment could be. none also where the plane is behind the view.
  [[nodiscard]] std::optional<PixelPosition> TargetOnPlane(PixelPosition center, double inverse_depth_in_ref) const;

  // Planes as this view sees them: for each its inverse depth at a pixel over the pixel's slope (LevelsInView); not a
  // number where it is behind the view.
  using Planes = std::vector<double>;
  [[nodiscard]] Planes PlanesOfLevels(std::span<const Level> levels) const;
  [[nodiscard]] Planes PlanesAt(std::span<const double> inverse_depths_in_ref) const;
  // Target or TargetOnPlane on each of many planes (the same pixels, on vectors); kNoTarget for none. targets: as many
  // as planes.
  void Targets(PixelPosition center, std::span<const double> planes, std::span<PixelPosition> targets) const;

 private:
  [[nodiscard]] std::optional<PixelPosition> TargetAt(PixelPosition center, double inverse_depth) const;

  LevelsInView in_view_;
  Reprojection neighbour_from_view_;
  Planes per_slope_;  // per level
  int neighbour_width_;
  int neighbour_height_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_COST_MATCHING_H_
