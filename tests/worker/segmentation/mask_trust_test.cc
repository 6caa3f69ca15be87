#include "worker/segmentation/mask_trust.h"

#include <gtest/gtest.h>

#include "tests/worker/segmentation/test_pictures.h"

namespace depthfarm {
namespace {

constexpr int kSide = 60;

// A bright square on a textured ground, and a mask of it, `grown` by as many pixels and moved `off` to the right and
// down.
YcbcrImage Square(int grown, int off) {
  YcbcrImage picture = ScenePicture(kSide, kSide, 3);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const auto inside = [&](int margin, int shift) {
        return x >= 20 - margin + shift && x < 40 + margin + shift && y >= 20 - margin + shift &&
               y < 40 + margin + shift;
      };
      if (inside(0, 0)) picture(x, y) = {static_cast<std::uint8_t>(230 + (x + y) % 3), 60, 200};
      if (inside(grown, off)) picture(x, y).matte = kForegroundMatte;
    }
  }
  return picture;
}

int HighestMatte(const YcbcrImage& picture) {
  int highest = 0;
  for (const Ycbcr& pixel : picture.values()) highest = std::max<int>(highest, pixel.matte);
  return highest;
}

TEST(WeighMask, KeepsAMaskThatFollowsThePicture) {
  YcbcrImage picture = Square(0, 0);
  const YcbcrImage before = picture;
  EXPECT_GT(ContrastAlongMask(picture), 3);
  EXPECT_EQ(WeighMask(picture), 1);
  EXPECT_EQ(picture, before);
}

TEST(WeighMask, DropsOneThatIsGrownOrShifted) {
  for (const auto& [grown, off] : {std::pair{3, 0}, std::pair{-3, 0}, std::pair{0, 12}}) {
    YcbcrImage picture = Square(grown, off);
    EXPECT_LT(ContrastAlongMask(picture), 1.3) << grown << " " << off;
    EXPECT_EQ(WeighMask(picture), 0);
    EXPECT_EQ(HighestMatte(picture), 0);
  }
}

TEST(WeighMask, OneWithoutContoursIsOfNoUse) {
  YcbcrImage picture = ScenePicture(kSide, kSide, 3);
  EXPECT_EQ(ContrastAlongMask(picture), 0);
  for (Ycbcr& pixel : picture.values()) pixel.matte = kForegroundMatte;
  EXPECT_EQ(ContrastAlongMask(picture), 0);
  EXPECT_EQ(WeighMask(picture), 1) << "nothing of it is left aside that would have said something";
}

}  // namespace
}  // namespace depthfarm
