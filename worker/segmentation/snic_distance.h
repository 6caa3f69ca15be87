#ifndef DEPTHFARM_WORKER_SEGMENTATION_SNIC_DISTANCE_H_
#define DEPTHFARM_WORKER_SEGMENTATION_SNIC_DISTANCE_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "common/base/double_pair.h"
#include "common/image/picture.h"

namespace depthfarm {

// Sums over a segment's pixels. Integers, so exact in double. One line of the cache.
struct alignas(64) SnicCluster {
  double x = 0;
  double y = 0;
  double luma = 0;
  double cb = 0;
  double cr = 0;
  double matte = 0;
  double pixels = 0;

  void Add(int px, int py, const Ycbcr& color) {
    x += px;
    y += py;
    luma += color.y;
    cb += color.cb;
    cr += color.cr;
    matte += color.matte;
    pixels += 1;
  }
};

// A pixel's neighbours in the order they are met: row by row.
inline constexpr std::size_t kNeighbours = 8;
struct PixelStep {
  int x;
  int y;
};
inline constexpr std::array<PixelStep, kNeighbours> kNeighbourSteps = {
    {{-1, -1}, {0, -1}, {1, -1}, {-1, 0}, {1, 0}, {-1, 1}, {0, 1}, {1, 1}}};

// Distances (see SegmentSnic) of the neighbours of pixel (x, y), of the given colours, from the mean of `cluster`,
// which has pixels. In this order of operations, whatever is done side by side:
//   ((dl^2 + db^2) + dr^2) + dm^2 + (dx^2 + dy^2) * spatial_weight
inline std::array<double, kNeighbours> NeighbourDistances(int x, int y,
                                                          const std::array<const Ycbcr*, kNeighbours>& colors,
                                                          const SnicCluster& cluster, double spatial_weight) {
  const DoublePair pixels = {cluster.pixels, cluster.pixels};
  const DoublePair centroid = DoublePair{cluster.x, cluster.y} / pixels;
  const DoublePair mean_luma_cb = DoublePair{cluster.luma, cluster.cb} / pixels;
  const DoublePair mean_cr_matte = DoublePair{cluster.cr, cluster.matte} / pixels;
  const DoublePair weight = {spatial_weight, spatial_weight};

  std::array<double, 3> dx2;  // of the columns left, here, right
  std::array<double, 3> dy2;
  for (int i = 0; i < 3; ++i) {
    const DoublePair difference = DoublePair{static_cast<double>(x - 1 + i), static_cast<double>(y - 1 + i)} - centroid;
    const DoublePair square = difference * difference;
    dx2[static_cast<std::size_t>(i)] = square[0];
    dy2[static_cast<std::size_t>(i)] = square[1];
  }
  const auto square_of_position = [&](std::size_t i) {
    return dx2[static_cast<std::size_t>(kNeighbourSteps[i].x + 1)] +
           dy2[static_cast<std::size_t>(kNeighbourSteps[i].y + 1)];
  };

  std::array<double, kNeighbours> distances;
  for (std::size_t i = 0; i < kNeighbours; i += 2) {
    const Ycbcr& a = *colors[i];
    const Ycbcr& b = *colors[i + 1];
    DoublePair luma_cb_a = DoublePair{static_cast<double>(a.y), static_cast<double>(a.cb)} - mean_luma_cb;
    DoublePair luma_cb_b = DoublePair{static_cast<double>(b.y), static_cast<double>(b.cb)} - mean_luma_cb;
    DoublePair cr_matte_a = DoublePair{static_cast<double>(a.cr), static_cast<double>(a.matte)} - mean_cr_matte;
    DoublePair cr_matte_b = DoublePair{static_cast<double>(b.cr), static_cast<double>(b.matte)} - mean_cr_matte;
    luma_cb_a *= luma_cb_a;
    luma_cb_b *= luma_cb_b;
    cr_matte_a *= cr_matte_a;
    cr_matte_b *= cr_matte_b;
    const DoublePair color =
        __builtin_shufflevector(luma_cb_a, luma_cb_b, 0, 2) + __builtin_shufflevector(luma_cb_a, luma_cb_b, 1, 3) +
        __builtin_shufflevector(cr_matte_a, cr_matte_b, 0, 2) + __builtin_shufflevector(cr_matte_a, cr_matte_b, 1, 3);
    const DoublePair distance = color + DoublePair{square_of_position(i), square_of_position(i + 1)} * weight;
    distances[i] = distance[0];
    distances[i + 1] = distance[1];
  }
  return distances;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_SNIC_DISTANCE_H_
