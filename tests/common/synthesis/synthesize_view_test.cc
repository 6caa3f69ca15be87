#include "common/synthesis/synthesize_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/quality/masks.h"
#include "common/quality/psnr.h"
#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr double kFocal = 100;

Camera At(const std::string& name, double x) { return ForwardCamera(name, x, 0, kWidth, kHeight, kFocal); }

SourceView Source(const PlaneView& view) { return {&view.picture, &view.depth, view.camera}; }

std::vector<TexturedPlane> TwoPlanes() {
  return {{.point = {0, 0, 10}, .base = 90, .frequency = 0.5},
          {.point = {0, 0, 4}, .min_x = -0.7, .max_x = 0.9, .base = 170, .frequency = 1}};
}

double Psnr(const SynthesizedView& view, const PlaneView& real, bool without_holes) {
  const PixelMask seen = Inverted(view.holes);
  return PsnrFullRange(MeasureLumaError(view.picture, real.picture, without_holes ? &seen : nullptr));
}

TEST(SynthesizeView, AConstantPlaneIsAShiftedPicture) {
  const PlaneView source = RenderPlanes(At("a", 0), {{.point = {0, 0, 10}, .frequency = 0.5}});
  // 0.5 * 100 / 10 = 5 pixels to the left.
  const Result<SynthesizedView> view = SynthesizeView({Source(source)}, At("b", 0.5));
  ASSERT_TRUE(view.ok()) << view.status().message();
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (x < kWidth - 5) {
        ASSERT_EQ(view->picture(x, y), source.picture(x + 5, y)) << x << "," << y;
      }
      ASSERT_EQ(view->holes(x, y), x < kWidth - 5 ? 0 : 1) << x << "," << y;
      ASSERT_NEAR(view->depth(x, y), 10, 1e-4) << x << "," << y;
    }
  }
}

TEST(SynthesizeView, TheTargetItselfComesBackUnchanged) {
  const PlaneView source = RenderPlanes(At("a", 0), TwoPlanes());
  const Result<SynthesizedView> view = SynthesizeView({Source(source)}, source.camera);
  ASSERT_TRUE(view.ok());
  EXPECT_EQ(ShareSet(view->holes), 0);
  EXPECT_GT(Psnr(*view, source, false), 55);
}

TEST(SynthesizeView, ExactDepthOfTwoPlanesGivesTheMiddleView) {
  const PlaneView left = RenderPlanes(At("a", -0.33), TwoPlanes());
  const PlaneView right = RenderPlanes(At("c", 0.37), TwoPlanes());
  const PlaneView real = RenderPlanes(At("b", 0), TwoPlanes());
  const Result<SynthesizedView> view = SynthesizeView({Source(left), Source(right)}, real.camera);
  ASSERT_TRUE(view.ok());
  // Outlines are not anti-aliased here: half of the pixels on them, 80 grey levels apart, are on the wrong plane by
  // chance. That alone is about 31 dB; the next test looks at the rest.
  EXPECT_GT(Psnr(*view, real, true), 29);
  EXPECT_LT(ShareSet(view->holes), 0.01);
  int wrong_depth = 0;
  for (std::size_t i = 0; i < view->depth.size(); ++i) {
    if (std::abs(view->depth.values()[i] - real.depth.values()[i]) > 0.01F) ++wrong_depth;
  }
  EXPECT_LT(wrong_depth, 2 * 2 * kHeight);
}

TEST(SynthesizeView, AwayFromOutlinesItIsNearlyPerfect) {
  const PlaneView left = RenderPlanes(At("a", -0.33), TwoPlanes());
  const PlaneView right = RenderPlanes(At("c", 0.37), TwoPlanes());
  const PlaneView real = RenderPlanes(At("b", 0), TwoPlanes());
  const Result<SynthesizedView> view = SynthesizeView({Source(left), Source(right)}, real.camera);
  ASSERT_TRUE(view.ok());
  PixelMask outlines(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 1; x < kWidth; ++x) {
      if (real.depth(x, y) != real.depth(x - 1, y)) outlines(x, y) = 1;
    }
  }
  PixelMask counted = Inverted(Dilated(outlines, 2));
  for (std::size_t i = 0; i < counted.size(); ++i) {
    if (view->holes.values()[i] != 0) counted.values()[i] = 0;
  }
  EXPECT_GT(ShareSet(counted), 0.9);
  EXPECT_GT(PsnrFullRange(MeasureLumaError(view->picture, real.picture, &counted)), 50);
}

TEST(SynthesizeView, HolesAreFilledFromTheBackground) {
  const std::vector<TexturedPlane> planes = {{.point = {0, 0, 10}, .base = 60, .amplitude = 0},
                                             {.point = {0, 0, 4}, .max_x = 0, .base = 200, .amplitude = 0}};
  const PlaneView source = RenderPlanes(At("a", 0), planes);
  const Result<SynthesizedView> view = SynthesizeView({Source(source)}, At("b", 0.5));
  ASSERT_TRUE(view.ok());
  EXPECT_GT(ShareSet(view->holes), 0.02);
  for (int x = 0; x < kWidth; ++x) {
    const int y = view->picture(x, 60).y;
    EXPECT_TRUE(y == 60 || y == 200) << x << ": " << y;
    if (view->holes(x, 60) != 0) {
      EXPECT_EQ(y, 60) << x;
    }
  }
}

TEST(SynthesizeView, NoisierDepthGivesAWorsePicture) {
  const PlaneView left = RenderPlanes(At("a", -0.33), TwoPlanes());
  const PlaneView right = RenderPlanes(At("c", 0.37), TwoPlanes());
  const PlaneView real = RenderPlanes(At("b", 0), TwoPlanes());
  double last = 1e9;
  for (const double noise_px : {0.0, 0.5, 1.5, 4.0}) {
    std::mt19937 random(7);
    const auto noisy = [&](const DepthMap& exact) {
      DepthMap depth = exact;
      for (float& z : depth.values()) {
        const double step = static_cast<double>(random() % 2001) / 1000.0 - 1.0;
        z = static_cast<float>(1.0 / (1.0 / static_cast<double>(z) + noise_px * step / (kFocal * 0.35)));
        if (z < 0) z = 0;
      }
      return depth;
    };
    const DepthMap left_depth = noisy(left.depth);
    const DepthMap right_depth = noisy(right.depth);
    const Result<SynthesizedView> view = SynthesizeView(
        {{&left.picture, &left_depth, left.camera}, {&right.picture, &right_depth, right.camera}}, real.camera);
    ASSERT_TRUE(view.ok());
    const double psnr = Psnr(*view, real, false);
    EXPECT_LT(psnr, last) << noise_px;
    last = psnr;
  }
}

TEST(SynthesizeView, ANearerCameraCountsMore) {
  const std::vector<double> weights = NearnessWeights({At("a", -1), At("c", 3)}, At("b", 0));
  EXPECT_NEAR(weights[0], 0.75, 1e-12);
  EXPECT_NEAR(weights[1], 0.25, 1e-12);
}

TEST(SynthesizeView, RefusesADepthMapOfAnotherSize) {
  PlaneView source = RenderPlanes(At("a", 0), TwoPlanes());
  source.depth = DepthMap(10, 10, 1.0F);
  const Result<SynthesizedView> view = SynthesizeView({Source(source)}, At("b", 1));
  ASSERT_FALSE(view.ok());
  EXPECT_NE(view.status().message().find("10x10"), std::string::npos) << view.status().message();
  EXPECT_FALSE(SynthesizeView({}, At("b", 1)).ok());
}

}  // namespace
}  // namespace depthfarm
