#include <gtest/gtest.h>

#include <cmath>

#include "common/quality/psnr.h"
#include "common/quality/ssim.h"
#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

// +-amplitude in a checkerboard: the mean squared error is amplitude^2 exactly.
YcbcrImage Checkered(const YcbcrImage& picture, int amplitude) {
  YcbcrImage result = picture;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const int value = picture(x, y).y + ((x + y) % 2 == 0 ? amplitude : -amplitude);
      result(x, y).y = static_cast<std::uint8_t>(value);
    }
  }
  return result;
}

YcbcrImage Textured() {
  return RenderPlanes(ForwardCamera("a", 0, 0, 64, 48, 60), {{.point = {0, 0, 5}, .amplitude = 50}}).picture;
}

TEST(Psnr, OfKnownNoise) {
  const YcbcrImage picture = Textured();
  const LumaError error = MeasureLumaError(picture, Checkered(picture, 5));
  EXPECT_EQ(error.pixels, 64 * 48);
  EXPECT_NEAR(PsnrFullRange(error), 10 * std::log10(255.0 * 255.0 / 25.0), 1e-9);
  const double scaled = 5 * 219.0 / 255.0;
  EXPECT_NEAR(PsnrVideoRange(error), 10 * std::log10(255.0 * 255.0 / (scaled * scaled)), 1e-9);
}

TEST(Psnr, IsInfiniteForEqualPicturesAndNotANumberForNone) {
  const YcbcrImage picture = Textured();
  EXPECT_TRUE(std::isinf(PsnrVideoRange(MeasureLumaError(picture, picture))));
  const PixelMask nothing(64, 48, 0);
  EXPECT_TRUE(std::isnan(PsnrVideoRange(MeasureLumaError(picture, picture, &nothing))));
}

TEST(Psnr, CountsOnlyTheMask) {
  const YcbcrImage picture = Textured();
  YcbcrImage other = picture;
  other(3, 4).y = static_cast<std::uint8_t>(picture(3, 4).y + 20);
  PixelMask mask(64, 48, 1);
  EXPECT_DOUBLE_EQ(MeasureLumaError(picture, other, &mask).squared_sum, 400);
  mask(3, 4) = 0;
  EXPECT_DOUBLE_EQ(MeasureLumaError(picture, other, &mask).squared_sum, 0);
  EXPECT_EQ(MeasureLumaError(picture, other, &mask).pixels, 64 * 48 - 1);
}

TEST(Ssim, IsOneForEqualPicturesAndFallsWithNoise) {
  const YcbcrImage picture = Textured();
  EXPECT_NEAR(Ssim(picture, picture), 1.0, 1e-9);
  const double little = Ssim(picture, Checkered(picture, 3));
  const double much = Ssim(picture, Checkered(picture, 12));
  EXPECT_LT(little, 1.0);
  EXPECT_LT(much, little);
}

TEST(Ssim, OfTwoFlatPicturesIsTheLuminanceTerm) {
  const YcbcrImage a(32, 32, Ycbcr{100, 128, 128, 0});
  const YcbcrImage b(32, 32, Ycbcr{120, 128, 128, 0});
  const double c1 = 2.55 * 2.55;
  EXPECT_NEAR(Ssim(a, b), (2 * 100.0 * 120.0 + c1) / (100.0 * 100.0 + 120.0 * 120.0 + c1), 1e-6);
}

TEST(Ssim, NeedsAWindow) { EXPECT_TRUE(std::isnan(Ssim(YcbcrImage(10, 40), YcbcrImage(10, 40)))); }

}  // namespace
}  // namespace depthfarm
