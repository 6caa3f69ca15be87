#ifndef DEPTHFARM_WORKER_REFINEMENT_PLANE_FIELD_H_
#define DEPTHFARM_WORKER_REFINEMENT_PLANE_FIELD_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/image/grid.h"

namespace depthfarm {

// Inverse depth over the picture: u(x, y) = a x + b y + c, exact for planes of the world. u = S / z: pixels of motion
// in the view's nearest neighbour (ViewGeometry::pixels_per_inverse_depth), so that thresholds are pixels whatever the
// rig. Stored in 32 bits (about 1e-4 pixels of u at the far end of an HD picture).
struct SlantedPlane {
  float a = 0;
  float b = 0;
  float c = 0;
  [[nodiscard]] double At(double x, double y) const { return a * x + b * y + c; }
  bool operator==(const SlantedPlane&) const = default;
};

using PlaneIndex = std::uint32_t;
using InverseDepthMap = Grid<float>;  // u per pixel

// Refined depth of one view.
struct RefinedView {
  // The plane of each segment, then what its kept pixels have of the frames it refers to.
  std::vector<SlantedPlane> planes;
  // Per segment: 1 = unchanged (paper III-E): its pixels have the depth of a reference frame and keep it.
  std::vector<std::uint8_t> kept;
  Grid<PlaneIndex> plane_of_pixel;  // H x W; a pixel at a depth jump may have the plane of another segment

  [[nodiscard]] std::size_t num_segments() const { return kept.size(); }
  [[nodiscard]] double At(int x, int y) const { return planes[plane_of_pixel(x, y)].At(x, y); }
  [[nodiscard]] InverseDepthMap Map(int threads = 1) const;
  // True for the pixels whose plane the refinement may still move: a plane of a segment that is not kept.
  [[nodiscard]] bool IsFree(PlaneIndex plane) const { return plane < kept.size() && kept[plane] == 0; }
  bool operator==(const RefinedView&) const = default;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PLANE_FIELD_H_
