#include "common/quality/depth_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/reprojection.h"
#include "common/quality/pixel_error.h"
#include "common/quality/visibility.h"

namespace depthfarm {
namespace {

constexpr int kEdgeReachPx = 4;
constexpr double kEdgeJumpPx = 1;
constexpr int kBorderPx = 8;

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
  DEPTHFARM_RETURN_IF_ERROR(CheckErrorInput(input));
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
