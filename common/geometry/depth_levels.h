#ifndef DEPTHFARM_COMMON_GEOMETRY_DEPTH_LEVELS_H_
#define DEPTHFARM_COMMON_GEOMETRY_DEPTH_LEVELS_H_

#include <Eigen/Core>
#include <cstdint>

#include "common/geometry/camera.h"

namespace depthfarm {

// Index of a depth level plane: 0 is the farthest, count - 1 the nearest, so that a larger level is a larger disparity.
using Level = std::uint16_t;

inline constexpr int kMaxLevels = 65534;

// The L planes on which depth is estimated: parallel to the image plane of the reference (centre) camera, "the depth of
// a point has to be defined as the distance from the plane of the center camera" (paper III-B). The paper is silent on
// their spacing; they are uniform in inverse depth, which is uniform in disparity for a parallel pair. Units: the
// sequence's unit of length.
class DepthLevels {
 public:
  // Errors (kInvalidArgument): not 0 < z_near < z_far finite, count outside 2..kMaxLevels.
  [[nodiscard]] static Result<DepthLevels> Create(const Camera& reference, double z_near, double z_far, int count);

  [[nodiscard]] int count() const { return count_; }
  [[nodiscard]] double z_near() const { return z_near_; }
  [[nodiscard]] double z_far() const { return z_far_; }
  // Distance of plane `level` from the reference camera's centre along its axis, in [z_near, z_far] up to rounding.
  [[nodiscard]] double DepthInRef(int level) const;
  // The planes' common normal: the reference camera's optical axis in the world.
  [[nodiscard]] const Eigen::Vector3d& axis_in_world() const { return axis_; }
  // Depth of a world point in the reference camera.
  [[nodiscard]] double DepthInRefOf(const Eigen::Vector3d& point_in_world) const {
    return OrderedDot(axis_, point_in_world) + offset_;
  }

 private:
  DepthLevels() = default;
  int count_ = 0;
  double z_near_ = 0;
  double z_far_ = 0;
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();
  double offset_ = 0;
};

// How one view sees the level planes. A pixel's ray is X = C + z * D(x, y), D = R^T K^-1 (x, y, 1), z its own depth; on
// plane `level` the ray has z = (DepthInRef(level) - center_depth) / (axis . D).
class LevelsInView {
 public:
  LevelsInView(const Camera& view, const DepthLevels& levels);

  // axis . D of pixel (x, y): by how much depth in the reference grows along its ray; <= 0: it looks back.
  [[nodiscard]] double Slope(double x, double y) const { return slope_x_ * x + slope_y_ * y + slope_1_; }
  // 1/z along the view's own axis where the ray of pixel (x, y) meets the plane at `depth_in_ref`; a result <= 0 (or
  // not finite) means that the ray does not meet it in front of the view.
  [[nodiscard]] double InverseDepth(double x, double y, double depth_in_ref) const {
    return Slope(x, y) / (depth_in_ref - center_depth_);
  }
  // The same by the plane's inverse depth, which may be 0 or negative: planes beyond infinity continue the ray's image
  // in other views. For planes with PlaneInFront only.
  [[nodiscard]] double InverseDepthOnPlane(double x, double y, double inverse_depth_in_ref) const {
    return Slope(x, y) * InversePerSlope(inverse_depth_in_ref);
  }
  // Its factor that is the plane's alone.
  [[nodiscard]] double InversePerSlope(double inverse_depth_in_ref) const {
    return inverse_depth_in_ref / (1.0 - inverse_depth_in_ref * center_depth_);
  }
  [[nodiscard]] bool PlaneInFront(double inverse_depth_in_ref) const {
    return inverse_depth_in_ref * center_depth_ < 1.0;
  }
  // depth_in_ref - center_depth: > 0 where the view's centre is in front of the plane.
  [[nodiscard]] double center_depth() const { return center_depth_; }
  // Depth in the reference camera of the point at own depth z on the ray of (x, y).
  [[nodiscard]] double DepthInRef(double x, double y, double z) const { return center_depth_ + z * Slope(x, y); }

 private:
  double slope_x_ = 0;  // axis . D(x, y) = slope_x x + slope_y y + slope_1
  double slope_y_ = 0;
  double slope_1_ = 0;
  double center_depth_ = 0;
};

// Own depth range of a view over all level planes: the smallest and largest z of the rays of its corner and edge pixels
// that meet a plane in front of it (on each plane the extremes lie there, z being the inverse of an affine function of
// the pixel). A view may stand between the planes: those behind it do not count, and those it nearly touches are cut
// off at 1/20 of the reference's z_near, nearer than which nothing is expected; the depth files clamp there.
// kInvalidArgument, naming the view, if it looks back (its axis at 90 degrees or more to the reference's: it would see
// the planes from behind) or no ray meets a plane in front of it.
struct DepthRange {
  double z_near = 0;
  double z_far = 0;
};
[[nodiscard]] Result<DepthRange> OwnDepthRange(const Camera& view, const DepthLevels& levels);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_GEOMETRY_DEPTH_LEVELS_H_
