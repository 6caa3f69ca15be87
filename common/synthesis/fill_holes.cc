#include "common/synthesis/fill_holes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace depthfarm {
namespace {

// Depths within this share of each other count as one background.
constexpr float kSameDepth = 0.05F;

struct Direction {
  int dx;
  int dy;
};
constexpr std::array<Direction, 8> kDirections = {
    {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};

struct Hole {
  std::size_t index = 0;
  int x = 0;
  int y = 0;
  std::array<int, 8> nearest = {-1, -1, -1, -1, -1, -1, -1, -1};  // index of the pixel met first, -1 = none
};

// For each hole, the first pixel that may fill it, walking in `direction`: the next pixel, or what that one has found
// if it is a hole itself. Holes are in raster order, so a walk to the left or upwards is known when the holes are taken
// in their order, the others when they are taken backwards.
void FindNearest(std::size_t direction_index, const Grid<int>& hole_of, std::vector<Hole>& holes) {
  const auto [dx, dy] = kDirections[direction_index];
  const bool backwards = dy > 0 || (dy == 0 && dx > 0);
  for (std::size_t i = 0; i < holes.size(); ++i) {
    Hole& hole = holes[backwards ? holes.size() - 1 - i : i];
    const int x = hole.x + dx;
    const int y = hole.y + dy;
    if (!hole_of.Contains(x, y)) continue;
    const int next = hole_of(x, y);
    hole.nearest[direction_index] = next < 0 ? static_cast<int>(hole_of.Index(x, y))
                                             : holes[static_cast<std::size_t>(next)].nearest[direction_index];
  }
}

// Whether something is known on both sides of the hole, in some direction and its opposite: then it lies between two
// surfaces, of which the farther one was uncovered. Else it lies outside of what the sources saw.
bool LiesBetween(const Hole& hole) {
  constexpr std::array<std::array<std::size_t, 2>, 4> kOpposite = {{{0, 1}, {2, 3}, {4, 7}, {5, 6}}};
  return std::any_of(kOpposite.begin(), kOpposite.end(), [&](const std::array<std::size_t, 2>& pair) {
    return hole.nearest[pair[0]] >= 0 && hole.nearest[pair[1]] >= 0;
  });
}

void FillOne(const Hole& hole, YcbcrImage& picture, DepthMap& depth) {
  float farthest = 0;
  for (const int index : hole.nearest) {
    if (index >= 0) farthest = std::max(farthest, depth.values()[static_cast<std::size_t>(index)]);
  }
  if (!(farthest > 0)) return;
  const float nearest_used = LiesBetween(hole) ? farthest * (1.0F - kSameDepth) : 0.0F;
  float weights = 0;
  std::array<float, 4> sum = {};
  for (const int index : hole.nearest) {
    if (index < 0) continue;
    const float z = depth.values()[static_cast<std::size_t>(index)];
    if (z < nearest_used) continue;
    const int dx = index % picture.width() - hole.x;
    const int dy = index / picture.width() - hole.y;
    const float weight = 1.0F / static_cast<float>(dx * dx + dy * dy);
    const Ycbcr& colour = picture.values()[static_cast<std::size_t>(index)];
    weights += weight;
    sum[0] += weight * static_cast<float>(colour.y);
    sum[1] += weight * static_cast<float>(colour.cb);
    sum[2] += weight * static_cast<float>(colour.cr);
    sum[3] += weight * z;
  }
  const auto rounded = [&](float value) { return static_cast<std::uint8_t>(std::lround(value / weights)); };
  picture.values()[hole.index] = {rounded(sum[0]), rounded(sum[1]), rounded(sum[2]), 0};
  depth.values()[hole.index] = sum[3] / weights;
}

}  // namespace

void FillHoles(const Grid<Known>& kinds, YcbcrImage& picture, DepthMap& depth) {
  const std::vector<Known>& values = kinds.values();
  const bool any_clean = std::find(values.begin(), values.end(), Known::kClean) != values.end();
  const Known filling = any_clean ? Known::kClean : Known::kDoubtful;
  Grid<int> hole_of(kinds.width(), kinds.height(), -1);
  std::vector<Hole> holes;
  for (int y = 0; y < kinds.height(); ++y) {
    for (int x = 0; x < kinds.width(); ++x) {
      if (kinds(x, y) >= filling) continue;
      Hole hole;
      hole.index = kinds.Index(x, y);
      hole.x = x;
      hole.y = y;
      hole_of(x, y) = static_cast<int>(holes.size());
      holes.push_back(hole);
    }
  }
  if (holes.empty()) return;
  for (std::size_t direction = 0; direction < kDirections.size(); ++direction) {
    FindNearest(direction, hole_of, holes);
  }
  // Only kept pixels are read, so the order of the holes doesn't matter.
  for (const Hole& hole : holes) FillOne(hole, picture, depth);
}

}  // namespace depthfarm
