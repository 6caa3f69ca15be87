#include "common/quality/iv_psnr.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/quality/psnr.h"
#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

YcbcrImage Textured() {
  return RenderPlanes(ForwardCamera("a", 0, 0, 64, 48, 60), {{.point = {0, 0, 5}, .amplitude = 50}}).picture;
}

YcbcrImage Shifted(const YcbcrImage& picture, int by) {
  YcbcrImage result = picture;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) result(x, y) = picture(std::min(x + by, picture.width() - 1), y);
  }
  return result;
}

TEST(IvPsnr, OfEqualPicturesIsThatOfOneUnitOfErrorInAll) {
  const YcbcrImage picture = Textured();
  EXPECT_NEAR(IvPsnr(picture, picture), 10 * std::log10(255.0 * 255.0 * 64 * 48), 1e-9);
}

// Flat pictures: no neighbour is better, so only the part of the difference beyond 1 % (3 of 255) is left.
TEST(IvPsnr, ForgivesOnePercentOfOffset) {
  const YcbcrImage dark(32, 32, Ycbcr{100, 128, 128, 0});    // 102 in 16-235
  const YcbcrImage little(32, 32, Ycbcr{103, 128, 128, 0});  // 104
  EXPECT_NEAR(IvPsnr(dark, little), 10 * std::log10(255.0 * 255.0 * 32 * 32), 1e-9);
  const YcbcrImage much(32, 32, Ycbcr{120, 128, 128, 0});  // 119: 17 above, 14 of them count
  const double luma = 10 * std::log10(255.0 * 255.0 / (14 * 14));
  const double chroma = 10 * std::log10(255.0 * 255.0 * 32 * 32);
  EXPECT_NEAR(IvPsnr(dark, much), (4 * luma + 2 * chroma) / 6, 1e-9);
}

// PSNR falls at once, IV-PSNR only where the shift leaves the 5 x 5.
TEST(IvPsnr, ForgivesShiftsOfUpToTwoPixels) {
  const YcbcrImage picture = Textured();
  const double by_two = IvPsnr(picture, Shifted(picture, 2));
  const double by_five = IvPsnr(picture, Shifted(picture, 5));
  EXPECT_LT(PsnrVideoRange(MeasureLumaError(picture, Shifted(picture, 2))), 30);
  EXPECT_GT(by_two, 50);
  EXPECT_LT(by_five, by_two - 5);
}

TEST(IvPsnr, IsSymmetric) {
  const YcbcrImage picture = Textured();
  const YcbcrImage other = Shifted(picture, 4);
  EXPECT_DOUBLE_EQ(IvPsnr(picture, other), IvPsnr(other, picture));
}

TEST(IvPsnr, OfNothingIsNotANumber) { EXPECT_TRUE(std::isnan(IvPsnr(YcbcrImage(), YcbcrImage()))); }

}  // namespace
}  // namespace depthfarm
