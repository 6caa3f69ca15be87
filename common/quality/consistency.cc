#include "common/quality/consistency.h"

#include <cmath>
#include <limits>

#include "common/geometry/reprojection.h"

namespace depthfarm {
namespace {

// One level, and what the 16-bit codes of two depth files round: of 250 levels each is 262 codes, so that maps exactly
// one level apart come out at 1 +- 0.004.
constexpr double kAgreementLevels = 1.02;

double Ratio(double part, std::int64_t whole) {
  return whole > 0 ? part / static_cast<double>(whole) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

void AgreementFigures::Add(const AgreementFigures& other) {
  in_view += other.in_view;
  in_view_agreeing += other.in_view_agreeing;
  non_occluded += other.non_occluded;
  non_occluded_agreeing += other.non_occluded_agreeing;
  level_difference_sum += other.level_difference_sum;
}

double AgreementFigures::InViewPercent() const { return 100 * Ratio(static_cast<double>(in_view_agreeing), in_view); }

double AgreementFigures::NonOccludedPercent() const {
  return 100 * Ratio(static_cast<double>(non_occluded_agreeing), non_occluded);
}

double AgreementFigures::MeanLevelDifference() const { return Ratio(level_difference_sum, non_occluded); }

AgreementFigures MeasureAgreement(const ViewDepth& view, const ViewDepth& other, const DepthLevels& levels,
                                  const PixelMask* exactly_visible) {
  const LevelsInView in_view(view.camera, levels);
  const LevelsInView in_other(other.camera, levels);
  const Reprojection other_from_view(view.camera, other.camera);
  AgreementFigures figures;
  for (int y = 0; y < view.depth->height(); ++y) {
    for (int x = 0; x < view.depth->width(); ++x) {
      const double z = static_cast<double>((*view.depth)(x, y));
      if (!(z > 0)) continue;
      const double depth_in_ref = in_view.DepthInRef(x, y, z);
      const Reprojection::Projected p = other_from_view.Project(x, y, 1.0 / z);
      if (!(depth_in_ref > 0) || !(p.depth_per_source > 0)) continue;
      if (!(p.x >= -0.5 && p.y >= -0.5 && p.x <= other.camera.width - 0.5 && p.y <= other.camera.height - 0.5))
        continue;
      const double level = LevelIndex(levels, depth_in_ref);
      const std::optional<double> surface = SurfaceLevelAt(other, in_other, levels, p.x, p.y, level);
      if (!surface) continue;
      const double behind = *surface - level;  // > 0: the other view shows something nearer
      const bool agrees = std::abs(behind) <= kAgreementLevels;
      ++figures.in_view;
      figures.in_view_agreeing += agrees ? 1 : 0;
      const bool visible = exactly_visible != nullptr ? (*exactly_visible)(x, y) != 0 : behind <= kAgreementLevels;
      if (!visible) continue;
      ++figures.non_occluded;
      figures.non_occluded_agreeing += agrees ? 1 : 0;
      figures.level_difference_sum += std::abs(behind);
    }
  }
  return figures;
}

}  // namespace depthfarm
