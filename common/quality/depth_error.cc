#include "common/quality/depth_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/reprojection.h"
#include "common/quality/visibility.h"

namespace depthfarm {
namespace {

constexpr int kEdgeReachPx = 4;
constexpr double kEdgeJumpPx = 1;
constexpr int kBorderPx = 8;

struct PixelError {
  bool estimated = false;
  double levels = 0;
  double px = 0;
};

double Ratio(double part, double whole) { return whole > 0 ? part / whole : std::numeric_limits<double>::quiet_NaN(); }

double Percent(std::int64_t part, std::int64_t whole) {
  return 100.0 * Ratio(static_cast<double>(part), static_cast<double>(whole));
}

void AddPixel(const PixelError& error, DepthErrorFigures& figures) {
  ++figures.pixels;
  for (std::size_t i = 0; i < DepthErrorFigures::kBadPx.size(); ++i) {
    if (!error.estimated || error.levels > DepthErrorFigures::kBadLevels[i]) ++figures.bad_levels[i];
    if (!error.estimated || error.px > DepthErrorFigures::kBadPx[i]) ++figures.bad_px[i];
  }
  if (!error.estimated) return;
  ++figures.estimated;
  figures.px_sum += error.px;
  figures.px_squared_sum += error.px * error.px;
  figures.level_sum += error.levels;
  figures.level_squared_sum += error.levels * error.levels;
}

// Error of single pixels of one view.
class PixelErrors {
 public:
  explicit PixelErrors(const DepthErrorInput& input)
      : input_(input), in_view_(input.camera, *input.levels), neighbour_from_view_(input.camera, input.neighbour) {}

  // Whether the truth is known here, in front of the reference camera and of the neighbour.
  [[nodiscard]] bool Known(int x, int y) const {
    const double z = static_cast<double>((*input_.exact)(x, y));
    return z > 0 && std::isfinite(z) && in_view_.DepthInRef(x, y, z) > 0 &&
           neighbour_from_view_.Project(x, y, 1.0 / z).depth_per_source > 0;
  }

  // Of a pixel of known truth.
  [[nodiscard]] PixelError At(int x, int y) const {
    const double exact = static_cast<double>((*input_.exact)(x, y));
    const double z = static_cast<double>((*input_.estimated)(x, y));
    if (!(z > 0) || !std::isfinite(z)) return {};
    const double depth_in_ref = in_view_.DepthInRef(x, y, z);
    const Reprojection::Projected p = neighbour_from_view_.Project(x, y, 1.0 / z);
    if (!(depth_in_ref > 0) || !(p.depth_per_source > 0)) return {};
    const Reprojection::Projected q = neighbour_from_view_.Project(x, y, 1.0 / exact);
    PixelError error;
    error.estimated = true;
    const double level = LevelIndex(*input_.levels, depth_in_ref);
    error.levels = std::abs(level - LevelIndex(*input_.levels, in_view_.DepthInRef(x, y, exact)));
    error.px = std::sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y));
    return error;
  }

 private:
  const DepthErrorInput& input_;
  LevelsInView in_view_;
  Reprojection neighbour_from_view_;
};

template <typename T>
Status CheckSize(const Grid<T>* grid, const Camera& camera, const std::string& what) {
  if (grid == nullptr || (grid->width() == camera.width && grid->height() == camera.height)) return {};
  return InvalidArgument("view '" + camera.name + "': the " + what + " is " + std::to_string(grid->width()) + "x" +
                         std::to_string(grid->height()) + ", the camera " + std::to_string(camera.width) + "x" +
                         std::to_string(camera.height));
}

}  // namespace

void DepthErrorFigures::Add(const DepthErrorFigures& other) {
  pixels += other.pixels;
  estimated += other.estimated;
  for (std::size_t i = 0; i < bad_levels.size(); ++i) {
    bad_levels[i] += other.bad_levels[i];
    bad_px[i] += other.bad_px[i];
  }
  px_sum += other.px_sum;
  px_squared_sum += other.px_squared_sum;
  level_sum += other.level_sum;
  level_squared_sum += other.level_squared_sum;
}

double DepthErrorFigures::BadLevelsPercent(std::size_t i) const { return Percent(bad_levels[i], pixels); }
double DepthErrorFigures::BadPxPercent(std::size_t i) const { return Percent(bad_px[i], pixels); }
double DepthErrorFigures::CompletenessPercent() const { return Percent(estimated, pixels); }
double DepthErrorFigures::MeanPx() const { return Ratio(px_sum, static_cast<double>(estimated)); }
double DepthErrorFigures::RmsePx() const { return std::sqrt(Ratio(px_squared_sum, static_cast<double>(estimated))); }
double DepthErrorFigures::MeanLevels() const { return Ratio(level_sum, static_cast<double>(estimated)); }
double DepthErrorFigures::RmseLevels() const {
  return std::sqrt(Ratio(level_squared_sum, static_cast<double>(estimated)));
}

PixelMask DepthEdges(const DepthMap& exact, const Camera& camera, const Camera& neighbour) {
  const Reprojection neighbour_from_view(camera, neighbour);
  PixelMask edges(exact.width(), exact.height());
  const auto mark_step = [&](int x, int y, int next_x, int next_y) {
    const double z = static_cast<double>(exact(x, y));
    const double next = static_cast<double>(exact(next_x, next_y));
    if (!(z > 0) || !(next > 0)) return;
    // Both depths on one pixel's ray: what the neighbour sees of the step alone.
    const Reprojection::Projected p = neighbour_from_view.Project(x, y, 1.0 / z);
    const Reprojection::Projected q = neighbour_from_view.Project(x, y, 1.0 / next);
    const double dx = p.x - q.x;
    const double dy = p.y - q.y;
    if (dx * dx + dy * dy > kEdgeJumpPx * kEdgeJumpPx) {
      edges(x, y) = 1;
      edges(next_x, next_y) = 1;
    }
  };
  for (int y = 0; y < exact.height(); ++y) {
    for (int x = 0; x < exact.width(); ++x) {
      if (x + 1 < exact.width()) mark_step(x, y, x + 1, y);
      if (y + 1 < exact.height()) mark_step(x, y, x, y + 1);
    }
  }
  return Dilated(edges, kEdgeReachPx);
}

Result<std::vector<DepthErrorGroup>> MeasureDepthError(const DepthErrorInput& input) {
  if (input.estimated == nullptr || input.exact == nullptr || input.levels == nullptr) {
    return InvalidArgument("view '" + input.camera.name + "': depth, exact depth and levels are needed");
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckSize(input.estimated, input.camera, "depth map"));
  DEPTHFARM_RETURN_IF_ERROR(CheckSize(input.exact, input.camera, "exact depth map"));
  DEPTHFARM_RETURN_IF_ERROR(CheckSize(input.non_occluded, input.camera, "mask of non-occluded pixels"));
  DEPTHFARM_RETURN_IF_ERROR(CheckSize(input.zones, input.camera, "zone map"));

  const PixelErrors errors(input);
  const PixelMask edges = DepthEdges(*input.exact, input.camera, input.neighbour);
  const PixelMask border = BorderPixels(input.camera.width, input.camera.height, kBorderPx);
  DepthErrorFigures all;
  DepthErrorFigures non_occluded;
  DepthErrorFigures on_edges;
  DepthErrorFigures on_border;
  std::vector<DepthErrorFigures> zones(input.zone_names.size());
  for (int y = 0; y < input.camera.height; ++y) {
    for (int x = 0; x < input.camera.width; ++x) {
      if (!errors.Known(x, y)) continue;
      const PixelError error = errors.At(x, y);
      AddPixel(error, all);
      if (input.non_occluded != nullptr && (*input.non_occluded)(x, y) != 0) AddPixel(error, non_occluded);
      if (edges(x, y) != 0) AddPixel(error, on_edges);
      if (border(x, y) != 0) AddPixel(error, on_border);
      if (input.zones != nullptr && (*input.zones)(x, y) < zones.size()) {
        AddPixel(error, zones[(*input.zones)(x, y)]);
      }
    }
  }

  std::vector<DepthErrorGroup> groups = {{"all", all}};
  if (input.non_occluded != nullptr) groups.push_back({"non-occluded", non_occluded});
  for (std::size_t zone = 0; zone < zones.size(); ++zone) {
    if (zones[zone].pixels > 0) groups.push_back({input.zone_names[zone], zones[zone]});
  }
  groups.push_back({"edge", on_edges});
  groups.push_back({"border", on_border});
  return groups;
}

void AddGroups(const std::vector<DepthErrorGroup>& groups, std::vector<DepthErrorGroup>& sum) {
  for (const DepthErrorGroup& group : groups) {
    const auto same = std::find_if(sum.begin(), sum.end(), [&](const auto& other) { return other.name == group.name; });
    if (same == sum.end()) {
      sum.push_back(group);
    } else {
      same->figures.Add(group.figures);
    }
  }
}

}  // namespace depthfarm
