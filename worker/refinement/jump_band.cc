#include "worker/refinement/jump_band.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include "common/base/parallel.h"

namespace depthfarm {
namespace {

constexpr float kJump = 0.5;             // pixels of u between neighbours: a depth jump
constexpr float kHighestJump = 8;        // the bound is raised to find fewer, but not beyond
constexpr double kMostOfPicture = 0.25;  // before the bound is raised
constexpr std::size_t kRadius = 4;       // pixels to either side of a jump
constexpr std::size_t kRowsAtOnce = 32;

// Marks what is at most kRadius columns from the jumps of row y to the right and down. `jumps`: as long as a row.
void MarkNearInRow(const InverseDepthMap& map, float jump, int y, std::vector<std::uint8_t>& jumps,
                   std::uint8_t* near) {
  const auto width = static_cast<std::size_t>(map.width());
  const float* const here = map.row(y);
  const float* const below = y + 1 < map.height() ? map.row(y + 1) : here;
  for (std::size_t x = 0; x + 1 < width; ++x) {
    const bool across = std::abs(here[x] - here[x + 1]) > jump;
    const bool down = std::abs(here[x] - below[x]) > jump;
    jumps[x] = (across | down) ? 1 : 0;
  }
  jumps[width - 1] = std::abs(here[width - 1] - below[width - 1]) > jump ? 1 : 0;
  // There are few: the next one is looked for.
  for (std::size_t x = 0; x < width; ++x) {
    const void* const found = std::memchr(jumps.data() + x, 1, width - x);
    if (found == nullptr) return;
    x = static_cast<std::size_t>(static_cast<const std::uint8_t*>(found) - jumps.data());
    const std::size_t begin = x - std::min(x, kRadius);
    std::fill(near + begin, near + std::min(x + kRadius + 1, width), std::uint8_t{1});
  }
}

void AddMarks(const std::uint8_t* from, std::size_t width, std::uint8_t* to) {
  for (std::size_t x = 0; x < width; ++x) to[x] = std::max(to[x], from[x]);
}

Grid<std::uint8_t> PixelsNearJumps(const InverseDepthMap& map, float jump, int threads) {
  Grid<std::uint8_t> near_in_row(map.width(), map.height());
  Grid<std::uint8_t> band(map.width(), map.height());
  const auto width = static_cast<std::size_t>(map.width());
  const auto height = static_cast<std::size_t>(map.height());
  ParallelForPieces(height, kRowsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint8_t> jumps(static_cast<std::size_t>(map.width()));
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
      MarkNearInRow(map, jump, y, jumps, near_in_row.row(y));
  });
  ParallelForPieces(height, kRowsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const int radius = static_cast<int>(kRadius);
      for (int from = std::max(0, y - radius); from <= std::min(map.height() - 1, y + radius); ++from)
        AddMarks(near_in_row.row(from), width, band.row(y));
    }
  });
  return band;
}

}  // namespace

Grid<std::uint8_t> JumpBand(const InverseDepthMap& map, int threads) {
  for (float jump = kJump;; jump *= 2) {
    Grid<std::uint8_t> band = PixelsNearJumps(map, jump, threads);
    const auto marked = std::count(band.values().begin(), band.values().end(), 1);
    if (2 * jump > kHighestJump || static_cast<double>(marked) <= kMostOfPicture * static_cast<double>(band.size()))
      return band;
  }
}

}  // namespace depthfarm
