#include "worker/segmentation/still_segments.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace depthfarm {
namespace {

constexpr std::size_t kComponents = 4;
constexpr int kWindow = 9;  // pixels

using Sums = std::vector<std::int16_t>;  // the components of each pixel of a row, at most 9 * 255

// Change of each pixel of a row.
void Changes(const YcbcrImage& before, const YcbcrImage& now, int y, Sums& changes) {
  const Ycbcr* const a = before.row(y);
  const Ycbcr* const b = now.row(y);
  for (std::size_t x = 0; x < static_cast<std::size_t>(now.width()); ++x) {
    changes[kComponents * x] = static_cast<std::int16_t>(b[x].y - a[x].y);
    changes[kComponents * x + 1] = static_cast<std::int16_t>(b[x].cb - a[x].cb);
    changes[kComponents * x + 2] = static_cast<std::int16_t>(b[x].cr - a[x].cr);
    changes[kComponents * x + 3] = static_cast<std::int16_t>(b[x].matte - a[x].matte);
  }
}

// One a segment: 1 where none of its own pixels changed.
std::vector<std::uint8_t> Unchanged(const SegmentMap& segments, const YcbcrImage& before, const YcbcrImage& now,
                                    int threshold) {
  std::vector<std::uint8_t> still(segments.centers.size(), 1);
  const int height = now.height();
  const auto width = static_cast<std::size_t>(now.width());
  const std::size_t size = kComponents * width;
  std::array<Sums, 3> rows;  // each where its y modulo 3 says
  for (Sums& row : rows) row.resize(size);
  const auto row_of = [&](int y) -> Sums& { return rows[static_cast<std::size_t>(std::clamp(y, 0, height - 1)) % 3]; };
  Sums columns(size + 2 * kComponents);     // of three rows, with a pixel more at either end
  std::vector<std::uint8_t> changed(size);  // each component of a row
  Changes(before, now, 0, row_of(0));
  const auto bound = static_cast<std::int16_t>(std::min(threshold, 256) * kWindow);  // no change is larger than 255
  for (int y = 0; y < height; ++y) {
    if (y + 1 < height) Changes(before, now, y + 1, row_of(y + 1));
    const Sums& above = row_of(y - 1);
    const Sums& here = row_of(y);
    const Sums& below = row_of(y + 1);
    for (std::size_t i = 0; i < size; ++i)
      columns[kComponents + i] = static_cast<std::int16_t>(above[i] + here[i] + below[i]);
    for (std::size_t i = 0; i < kComponents; ++i) {
      columns[i] = columns[kComponents + i];
      columns[kComponents + size + i] = columns[size + i];
    }
    for (std::size_t i = 0; i < size; ++i) {
      const auto sum = static_cast<std::int16_t>(columns[i] + columns[i + kComponents] + columns[i + 2 * kComponents]);
      changed[i] = ((sum >= bound) | (sum <= -bound)) ? 1 : 0;
    }
    const SegmentIndex* const label = segments.labels.row(y);
    for (std::size_t x = 0; x < width; ++x) {
      std::uint32_t of_pixel = 0;
      static_assert(sizeof(of_pixel) == kComponents);
      std::memcpy(&of_pixel, &changed[kComponents * x], kComponents);
      if (of_pixel != 0) still[label[x]] = 0;
    }
  }
  return still;
}

}  // namespace

std::vector<std::uint8_t> StillSegments(const SegmentMap& segments, const YcbcrImage& before, const YcbcrImage& now,
                                        int threshold) {
  const std::vector<std::uint8_t> unchanged = Unchanged(segments, before, now, threshold);
  std::vector<std::uint8_t> still = unchanged;
  for (const auto& [first, second] : segments.adjacency) {
    if (unchanged[first] == 0) still[second] = 0;
    if (unchanged[second] == 0) still[first] = 0;
  }
  return still;
}

}  // namespace depthfarm
