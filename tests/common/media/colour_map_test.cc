#include "common/media/colour_map.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/media/picture_reader.h"

namespace depthfarm {
namespace {

TEST(ColourMap, NearIsWarmFarIsColdNothingIsBlack) {
  DepthMap depth(3, 1);
  depth.values() = {1, 10, 0};
  const auto picture = ColourMapped(depth, *DepthCode::Create(1, 10));
  ASSERT_TRUE(picture.ok()) << picture.status().message();
  const Rgb8 near = (*picture)(0, 0);
  const Rgb8 far = (*picture)(1, 0);
  EXPECT_GT(near.r, near.b + 50);
  EXPECT_GT(far.b, far.r);
  EXPECT_EQ((*picture)(2, 0), Rgb8());
}

TEST(ColourMap, ContactSheetPlacesPicturesInRowsOnWhite) {
  const Rgb8 red = {255, 0, 0};
  const Rgb8 blue = {0, 0, 255};
  const Rgb8 white = {255, 255, 255};
  const auto sheet = ContactSheet({RgbImage(2, 2, red), RgbImage(3, 1, blue), RgbImage(1, 1, red)}, 2, 1);
  ASSERT_TRUE(sheet.ok()) << sheet.status().message();
  ASSERT_EQ(sheet->width(), 3 + 1 + 3);
  ASSERT_EQ(sheet->height(), 2 + 1 + 2);
  EXPECT_EQ((*sheet)(1, 1), red);
  EXPECT_EQ((*sheet)(2, 0), white);
  EXPECT_EQ((*sheet)(3, 0), white);
  EXPECT_EQ((*sheet)(6, 0), blue);
  EXPECT_EQ((*sheet)(6, 1), white);
  EXPECT_EQ((*sheet)(0, 2), white);
  EXPECT_EQ((*sheet)(0, 3), red);
}

TEST(ColourMap, ContactSheetOfNothingIsAnError) {
  EXPECT_FALSE(ContactSheet({}, 2, 1).ok());
  EXPECT_FALSE(ContactSheet({RgbImage(1, 1)}, 0, 1).ok());
  EXPECT_FALSE(ContactSheet({RgbImage(1, 1)}, 1, -1).ok());
}

TEST(ColourMap, ShrinkingAverages) {
  RgbImage picture(5, 2, {10, 20, 30});
  picture(0, 0) = {14, 20, 30};
  const RgbImage small = Shrunk(picture, 2);
  ASSERT_EQ(small.width(), 2);
  ASSERT_EQ(small.height(), 1);
  EXPECT_EQ(small(0, 0), (Rgb8{11, 20, 30}));
  EXPECT_EQ(small(1, 0), (Rgb8{10, 20, 30}));
}

TEST(ColourMap, PngKeepsTheOrderOfTheChannels) {
  const auto png = EncodeRgbPng(RgbImage(2, 1, {255, 0, 0}));
  ASSERT_TRUE(png.ok()) << png.status().message();
  const auto picture = DecodePicture(*png, PictureFormat(), 2, 1, 1);
  ASSERT_TRUE(picture.ok());
  EXPECT_EQ((*picture)(0, 0).cr, 255);  // red
}

}  // namespace
}  // namespace depthfarm
