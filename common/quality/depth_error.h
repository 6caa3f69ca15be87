#ifndef DEPTHFARM_COMMON_QUALITY_DEPTH_ERROR_H_
#define DEPTHFARM_COMMON_QUALITY_DEPTH_ERROR_H_

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"
#include "common/geometry/depth_levels.h"
#include "common/image/picture.h"
#include "common/quality/masks.h"

namespace depthfarm {

// Error of estimated depth over some pixels of known truth. Raw sums, so that frames and views add up.
struct DepthErrorFigures {
  static constexpr std::array<double, 4> kBadLevels = {0.5, 1, 2, 4};
  static constexpr std::array<double, 4> kBadPx = {0.5, 1, 2, 4};

  std::int64_t pixels = 0;     // with known truth
  std::int64_t estimated = 0;  // of these, with an estimate
  // Pixels off by more than kBadLevels / kBadPx. A pixel without an estimate is bad in each.
  std::array<std::int64_t, 4> bad_levels = {};
  std::array<std::int64_t, 4> bad_px = {};
  double px_sum = 0;  // these sums run over estimated pixels
  double px_squared_sum = 0;
  double level_sum = 0;
  double level_squared_sum = 0;

  void Add(const DepthErrorFigures& other);
  // Shares in percent of `pixels`; means over `estimated`. NaN where there is nothing to divide by.
  [[nodiscard]] double BadLevelsPercent(std::size_t i) const;
  [[nodiscard]] double BadPxPercent(std::size_t i) const;
  [[nodiscard]] double CompletenessPercent() const;
  [[nodiscard]] double MeanPx() const;
  [[nodiscard]] double RmsePx() const;
  [[nodiscard]] double MeanLevels() const;
  [[nodiscard]] double RmseLevels() const;
};

// What a depth map is measured against. Pointers are borrowed; every grid has the camera's size.
struct DepthErrorInput {
  const DepthMap* estimated = nullptr;
  const DepthMap* exact = nullptr;  // 0 = unknown
  Camera camera;
  const DepthLevels* levels = nullptr;
  Camera neighbour;                         // the nearest neighbour view: errors in px are seen there
  const PixelMask* non_occluded = nullptr;  // see VisibleInAny; null = not known, no "non-occluded" group
  const ZoneMap* zones = nullptr;           // null = no zones
  std::vector<std::string> zone_names;      // name of zone value i; zones without a name aren't reported
};

struct DepthErrorGroup {
  std::string name;  // "all", "non-occluded", a zone's name, "edge", "border"
  DepthErrorFigures figures;
};

// Error of one view's depth in levels and in pixels:
//   levels  |level(estimate) - level(truth)|, fractional plane indices (LevelIndex) of the two points on the pixel's
//   ray; px      distance between the projections of the two points in `neighbour`.
// Groups, in this order: "all" pixels of known truth; "non-occluded" ones; one per zone that has pixels; "edge", within
// 4 px of a jump of the exact depth by more than 1 px in the neighbour; "border", within 8 px of the picture's border.
// Zones, edge and border count occluded pixels too.
// Errors  kInvalidArgument: missing inputs, or sizes that differ.
[[nodiscard]] Result<std::vector<DepthErrorGroup>> MeasureDepthError(const DepthErrorInput& input);

// Pixels within 4 px of a step of `exact` between two 4-neighbours that moves a point by more than 1 px in `neighbour`.
[[nodiscard]] PixelMask DepthEdges(const DepthMap& exact, const Camera& camera, const Camera& neighbour);

// Adds groups of the same name; new names go to the end.
void AddGroups(const std::vector<DepthErrorGroup>& groups, std::vector<DepthErrorGroup>& sum);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_DEPTH_ERROR_H_
