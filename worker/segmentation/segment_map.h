#ifndef DEPTHFARM_WORKER_SEGMENTATION_SEGMENT_MAP_H_
#define DEPTHFARM_WORKER_SEGMENTATION_SEGMENT_MAP_H_

#include <cstdint>
#include <cstdlib>
#include <vector>

#include "common/image/grid.h"
#include "common/image/picture.h"

namespace depthfarm {

// Index of a segment within its view: 0 .. num_segments - 1, in row-major order of the seeds.
using SegmentIndex = std::uint32_t;

struct PixelPosition {
  std::int32_t x = 0;
  std::int32_t y = 0;
  bool operator==(const PixelPosition&) const = default;
};

// [Y^ Cb^ Cr^] of eq. (3) and III-E: mean colour in 1/64 grey level (rounded to nearest), so that all that follows is
// integer arithmetic. 0..255*64 each. Where there is a mask the matte is a fourth component.
struct MeanColor {
  std::int32_t y = 0;
  std::int32_t cb = 0;
  std::int32_t cr = 0;
  std::int32_t matte = 0;
  bool operator==(const MeanColor&) const = default;
};
inline constexpr int kMeanColorScale = 64;

// Sum of the differences of all components, 1/64 grey level.
[[nodiscard]] inline std::int32_t L1Distance(const MeanColor& a, const MeanColor& b) {
  return std::abs(a.y - b.y) + std::abs(a.cb - b.cb) + std::abs(a.cr - b.cr) + std::abs(a.matte - b.matte);
}

// Segments of one view and all that the energy needs of them (paper III-B, IV-C). Everything but `labels` follows from
// `labels` and the picture (see DescribeSegments), so only these two are stored and sent.
struct SegmentMap {
  Grid<SegmentIndex> labels;           // H x W: each pixel's segment
  std::vector<PixelPosition> centers;  // mu_s: the pixel of s nearest to its centroid; lies inside s
  std::vector<MeanColor> means;
  // Adjacent segments (sharing a pixel edge: 4-neighbours), each pair once with first < second, sorted. The sum over
  // t in T of eq. (1) counts each pair once here.
  struct Adjacency {
    SegmentIndex first = 0;
    SegmentIndex second = 0;
    bool operator==(const Adjacency&) const = default;
  };
  std::vector<Adjacency> adjacency;

  [[nodiscard]] int num_segments() const { return static_cast<int>(centers.size()); }
  bool operator==(const SegmentMap&) const = default;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_SEGMENT_MAP_H_
