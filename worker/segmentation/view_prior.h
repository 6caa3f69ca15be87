#ifndef DEPTHFARM_WORKER_SEGMENTATION_VIEW_PRIOR_H_
#define DEPTHFARM_WORKER_SEGMENTATION_VIEW_PRIOR_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "common/image/grid.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// What a prior says of one segment: a plane of inverse depth (or of what stands for it, PriorFormat), v(x, y) = a x +
// b y + c, as planes of the world are.
struct SegmentPrior {
  float a = 0;
  float b = 0;
  float c = 0;
  float weight = 0;  // 0: nothing; to 1: every pixel, all of them certain
  bool operator==(const SegmentPrior&) const = default;
};

inline constexpr float kMostPriorValue = 1e18F;  // beyond it is no depth, and its square no float

// A prior of a view in one frame: pixel by pixel in 16 bits, and what follows from that for each segment.
struct ViewPrior {
  float lowest = 0;               // of the values; they span at most kMostPriorValue from it
  float step = 0;                 // between codes
  Grid<std::uint16_t> codes;      // W x H; 0: not known, else value = lowest + (code - 1) * step
  Grid<std::uint8_t> confidence;  // W x H, 255 is certain; empty: all are
  std::vector<SegmentPrior> segments;

  [[nodiscard]] bool empty() const { return codes.size() == 0; }
  // nullopt: not known.
  [[nodiscard]] std::optional<double> At(int x, int y) const {
    const std::uint16_t code = codes(x, y);
    if (code == 0) return std::nullopt;
    return lowest + (code - 1) * static_cast<double>(step);
  }
  bool operator==(const ViewPrior&) const = default;
};

// From values (W x H, > 0; 0 = unknown) and their confidence (0..1; empty: all certain). No `segments` yet. Of more
// than a thousand, a few values that are far from all others count as unknown.
[[nodiscard]] ViewPrior MakePrior(const Grid<float>& values, const Grid<float>& confidence);

// A robust plane through the values of each segment's pixels: pixels of another surface, at the segment's rim or by an
// error of the prior, do not count. Work O(pixels).
[[nodiscard]] std::vector<SegmentPrior> DescribePrior(const SegmentMap& segments, const ViewPrior& prior);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_VIEW_PRIOR_H_
