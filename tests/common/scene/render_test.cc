#include "common/scene/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/reprojection.h"
#include "common/scene/array.h"

namespace depthfarm {
namespace {

constexpr RenderOptions kClean{.noise = 0, .gain = 0};

// The 2 x 2 pixels of `target` around the point that pixel (x, y) of `source` shows.
struct Landing {
  int x = 0;  // top-left of the four
  int y = 0;
  double fx = 0;  // within them
  double fy = 0;
  double depth = 0;  // of the point in the target
};
std::optional<Landing> Land(const Reprojection& target_from_source, const RenderedView& source,
                            const RenderedView& target, int x, int y) {
  const double depth = source.depth(x, y);
  const Reprojection::Projected p = target_from_source.Project(x, y, 1 / depth);
  Landing landing{.x = static_cast<int>(std::floor(p.x)), .y = static_cast<int>(std::floor(p.y))};
  if (!target.depth.Contains(landing.x, landing.y) || !target.depth.Contains(landing.x + 1, landing.y + 1)) return {};
  landing.fx = p.x - landing.x;
  landing.fy = p.y - landing.y;
  landing.depth = depth * p.depth_per_source;
  return landing;
}

template <typename Value>
double Interpolated(const Landing& at, const Value& value) {
  return (1 - at.fy) * ((1 - at.fx) * value(at.x, at.y) + at.fx * value(at.x + 1, at.y)) +
         at.fy * ((1 - at.fx) * value(at.x, at.y + 1) + at.fx * value(at.x + 1, at.y + 1));
}

bool AllOfZone(const ZoneMap& zones, const Landing& at, std::uint8_t zone) {
  return zones(at.x, at.y) == zone && zones(at.x + 1, at.y) == zone && zones(at.x, at.y + 1) == zone &&
         zones(at.x + 1, at.y + 1) == zone;
}

double Luma(const RgbImage& rgb, int x, int y) {
  const auto [r, g, b] = rgb(x, y);
  return 0.299 * r + 0.587 * g + 0.114 * b;
}

class TwoViews : public testing::TestWithParam<ArrayKind> {
 protected:
  const Scene scene_ = MakeScene(3);
  const std::vector<Camera> cameras_ = MakeArray(GetParam(), 6, 320, 240, 3);
  const RenderedView source_ = RenderView(scene_, cameras_[2], 5, kClean);
  const RenderedView target_ = RenderView(scene_, cameras_[3], 5, kClean);
  const Reprojection target_from_source_{cameras_[2], cameras_[3]};
};

TEST_P(TwoViews, AgreeOnTheDepthOfPlanes) {
  // 1/z is affine over a plane, so interpolating it is exact; only where a zone's planes meet or hide each other (edges
  // of crates, the frame on the wall, floor and curtain) may it differ. The panel is one plane.
  int compared = 0;
  int wrong = 0;
  int wrong_panel = 0;
  for (int y = 0; y < source_.depth.height(); ++y) {
    for (int x = 0; x < source_.depth.width(); ++x) {
      const std::uint8_t zone = source_.zones(x, y);
      if (zone == static_cast<int>(Zone::kPerson) || zone == static_cast<int>(Zone::kCurved)) continue;
      if (zone == static_cast<int>(Zone::kThin)) continue;
      const std::optional<Landing> at = Land(target_from_source_, source_, target_, x, y);
      if (!at || !AllOfZone(target_.zones, *at, zone)) continue;
      const double seen = 1 / Interpolated(*at, [&](int u, int v) { return 1 / target_.depth(u, v); });
      const bool differs = std::abs(seen - at->depth) > 1e-6 * seen;
      ++compared;
      wrong += static_cast<int>(differs);
      wrong_panel += static_cast<int>(differs && zone == static_cast<int>(Zone::kPanel));
    }
  }
  EXPECT_GT(compared, 0.5 * static_cast<double>(source_.depth.size()));
  EXPECT_LT(wrong, 0.04 * compared);
  EXPECT_EQ(wrong_panel, 0);
}

TEST_P(TwoViews, AgreeOnTheDepthOfPersonsAndRoundThings) {
  int compared = 0;
  int wrong = 0;
  for (int y = 0; y < source_.depth.height(); ++y) {
    for (int x = 0; x < source_.depth.width(); ++x) {
      const std::uint8_t zone = source_.zones(x, y);
      if (zone != static_cast<int>(Zone::kPerson) && zone != static_cast<int>(Zone::kCurved)) continue;
      const std::optional<Landing> at = Land(target_from_source_, source_, target_, x, y);
      if (!at || !AllOfZone(target_.zones, *at, zone)) continue;
      const double seen = Interpolated(*at, [&](int u, int v) { return target_.depth(u, v); });
      ++compared;
      wrong += static_cast<int>(std::abs(seen - at->depth) > 0.01);  // a centimetre: curvature within a pixel
    }
  }
  EXPECT_GT(compared, 2000);
  EXPECT_LT(wrong, 0.12 * compared);  // limbs before limbs, rims
}

TEST_P(TwoViews, NeverSeeThroughWhatTheOtherSees) {
  // A point seen by one view is seen by the other or hidden behind something nearer: never in front of all it sees
  // there.
  int compared = 0;
  int through = 0;
  for (int y = 0; y < source_.depth.height(); ++y) {
    for (int x = 0; x < source_.depth.width(); ++x) {
      if (source_.zones(x, y) == static_cast<int>(Zone::kThin)) continue;  // falls between pixels
      const std::optional<Landing> at = Land(target_from_source_, source_, target_, x, y);
      if (!at) continue;
      double nearest = target_.depth(at->x, at->y);
      for (int i = 1; i < 4; ++i) nearest = std::min<double>(nearest, target_.depth(at->x + i % 2, at->y + i / 2));
      ++compared;
      through += static_cast<int>(at->depth < 0.99 * nearest);
    }
  }
  EXPECT_GT(compared, 0.6 * static_cast<double>(source_.depth.size()));
  EXPECT_LT(through, 0.002 * compared);  // rims narrower than a pixel
}

TEST_P(TwoViews, AgreeOnColourOfTexturedSurfaces) {
  double sum = 0;
  double mean = 0;
  double squares = 0;
  int compared = 0;
  for (int y = 0; y < source_.depth.height(); ++y) {
    for (int x = 0; x < source_.depth.width(); ++x) {
      const std::uint8_t zone = source_.zones(x, y);
      if (zone != static_cast<int>(Zone::kTextured) && zone != static_cast<int>(Zone::kSlanted)) continue;
      const std::optional<Landing> at = Land(target_from_source_, source_, target_, x, y);
      if (!at || !AllOfZone(target_.zones, *at, zone)) continue;
      const double luma = Luma(source_.rgb, x, y);
      sum += std::abs(Interpolated(*at, [&](int u, int v) { return Luma(target_.rgb, u, v); }) - luma);
      mean += luma;
      squares += luma * luma;
      ++compared;
    }
  }
  ASSERT_GT(compared, 10000);
  mean /= compared;
  EXPECT_LT(sum / compared, 5);                                // resampling of detail of two pixels
  EXPECT_GT(std::sqrt(squares / compared - mean * mean), 12);  // there is something to match
}

INSTANTIATE_TEST_SUITE_P(Arrays, TwoViews,
                         testing::Values(ArrayKind::kArc, ArrayKind::kLine, ArrayKind::kGrid, ArrayKind::kIrregular),
                         [](const auto& kind) { return "Kind" + std::to_string(static_cast<int>(kind.param)); });

TEST(RenderView, SameSeedGivesSameBytes) {
  const Camera camera = MakeArray(ArrayKind::kArc, 3, 160, 120, 1)[1];
  const RenderedView one = RenderView(MakeScene(9), camera, 7, {});
  const RenderedView two = RenderView(MakeScene(9), camera, 7, {});
  EXPECT_EQ(one.rgb, two.rgb);
  EXPECT_EQ(one.depth, two.depth);
  EXPECT_EQ(one.zones, two.zones);
}

bool PersonWithinAPixel(const ZoneMap& zones, int x, int y) {
  for (int v = std::max(0, y - 1); v <= std::min(zones.height() - 1, y + 1); ++v) {
    for (int u = std::max(0, x - 1); u <= std::min(zones.width() - 1, x + 1); ++u) {
      if (zones(u, v) == static_cast<int>(Zone::kPerson)) return true;
    }
  }
  return false;
}

TEST(RenderView, WithoutNoiseFramesDifferOnlyAtPersons) {
  const Scene scene = MakeScene(1);
  const Camera camera = MakeArray(ArrayKind::kArc, 3, 320, 240, 1)[1];
  const RenderedView before = RenderView(scene, camera, 0, kClean);
  const RenderedView after = RenderView(scene, camera, 6, kClean);
  int changed = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      changed += static_cast<int>(before.rgb(x, y) != after.rgb(x, y));
      if (PersonWithinAPixel(before.zones, x, y) || PersonWithinAPixel(after.zones, x, y)) continue;
      EXPECT_EQ(before.rgb(x, y), after.rgb(x, y)) << x << ", " << y;
      EXPECT_EQ(before.depth(x, y), after.depth(x, y));
      EXPECT_EQ(before.zones(x, y), after.zones(x, y));
    }
  }
  EXPECT_GT(changed, 0.02 * 320 * 240);
}

TEST(RenderView, NoiseHasTheAskedDeviationAndIsFreshInEveryFrame) {
  Scene scene = MakeScene(1);
  scene.persons.clear();
  const Camera camera = MakeArray(ArrayKind::kArc, 3, 320, 240, 1)[1];
  const RenderOptions noisy{.noise = 2, .gain = 0, .samples_per_side = 1};
  const RenderedView one = RenderView(scene, camera, 0, noisy);
  const RenderedView two = RenderView(scene, camera, 1, noisy);
  EXPECT_EQ(one.depth, two.depth);
  double sum = 0;
  double squares = 0;
  for (std::size_t i = 0; i < one.rgb.size(); ++i) {
    const double difference = static_cast<double>(one.rgb.values()[i].g) - two.rgb.values()[i].g;
    sum += difference;
    squares += difference * difference;
  }
  const double count = static_cast<double>(one.rgb.size());
  EXPECT_NEAR(sum / count, 0, 0.06);
  EXPECT_NEAR(squares / count, 2 * (2 * 2 + 1.0 / 12), 0.25);  // two frames, each rounded
}

TEST(RenderView, CamerasDifferByTheirGainAlone) {
  const Scene scene = MakeScene(1);
  Camera camera = MakeArray(ArrayKind::kArc, 3, 160, 120, 1)[1];
  const RenderOptions gain_only{.noise = 0, .gain = 0.02};
  double largest = 0;
  for (const char* name : {"a", "b", "c", "d", "e", "f"}) {
    camera.name = name;
    const RenderedView plain = RenderView(scene, camera, 0, kClean);
    const RenderedView gained = RenderView(scene, camera, 0, gain_only);
    EXPECT_EQ(plain.depth, gained.depth);
    double before = 0;
    double after = 0;
    for (std::size_t i = 0; i < plain.rgb.size(); ++i) {
      before += plain.rgb.values()[i].g;
      after += gained.rgb.values()[i].g;
    }
    largest = std::max(largest, std::abs(after / before - 1));
  }
  EXPECT_GT(largest, 0.005);
  EXPECT_LT(largest, 0.08);
}

TEST(RenderView, PanelIsTextureless) {
  const Scene scene = MakeScene(1);
  const Camera camera = MakeArray(ArrayKind::kArc, 3, 320, 240, 1)[0];
  const RenderedView view = RenderView(scene, camera, 0, {.noise = 0, .gain = 0, .samples_per_side = 1});
  std::optional<Rgb8> colour;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) {
      if (view.zones(x, y) != static_cast<int>(Zone::kPanel)) continue;
      if (!colour) colour = view.rgb(x, y);
      ASSERT_EQ(view.rgb(x, y), *colour);
    }
  }
  EXPECT_TRUE(colour.has_value());
}

TEST(ToYcbcr, MatchesBt601OnPrimaries) {
  RgbImage rgb(5, 1);
  rgb(0, 0) = {0, 0, 0};
  rgb(1, 0) = {255, 255, 255};
  rgb(2, 0) = {255, 0, 0};
  rgb(3, 0) = {0, 255, 0};
  rgb(4, 0) = {0, 0, 255};
  const YcbcrImage converted = ToYcbcr(rgb);
  EXPECT_EQ(converted(0, 0), (Ycbcr{.y = 0, .cb = 128, .cr = 128}));
  EXPECT_EQ(converted(1, 0), (Ycbcr{.y = 255, .cb = 128, .cr = 128}));
  EXPECT_EQ(converted(2, 0), (Ycbcr{.y = 76, .cb = 85, .cr = 255}));
  EXPECT_EQ(converted(3, 0), (Ycbcr{.y = 150, .cb = 44, .cr = 21}));
  EXPECT_EQ(converted(4, 0), (Ycbcr{.y = 29, .cb = 255, .cr = 107}));
}

}  // namespace
}  // namespace depthfarm
