#include "common/media/raw_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/image/colour_conversion.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;
using Kind = PictureFormat::Kind;

// Samples as a file holds them.
std::string Bytes(const std::vector<int>& samples, int bits) {
  std::string bytes;
  for (const int sample : samples) {
    bytes.push_back(static_cast<char>(sample & 0xff));
    if (bits > 8) bytes.push_back(static_cast<char>(sample >> 8));
  }
  return bytes;
}

// The colour of a 2x2 picture all of one colour.
Ycbcr Uniform(int y, int cb, int cr, const PictureFormat& format) {
  const auto picture = DecodeRawPicture(Bytes({y, y, y, y, cb, cr}, format.bits), format, 2, 2, 1);
  EXPECT_TRUE(picture.ok()) << picture.status().message();
  if (!picture.ok()) return {};
  for (const Ycbcr& pixel : picture->values()) EXPECT_EQ(pixel, (*picture)(0, 0));
  return (*picture)(0, 0);
}

TEST(RawPicture, LimitedRangeSpansBlackToWhiteAtAnyDepth) {
  for (const int bits : {8, 10, 12, 16}) {
    const int unit = 1 << (bits - 8);
    const PictureFormat format = {Kind::kYuv420, bits, false, false};
    EXPECT_EQ(Uniform(16 * unit, 128 * unit, 128 * unit, format), (Ycbcr{0, 128, 128, 0})) << bits;
    EXPECT_EQ(Uniform(235 * unit, 128 * unit, 128 * unit, format), (Ycbcr{255, 128, 128, 0})) << bits;
    // Full chroma: 128 + 127.5, rounded half up and clamped; 128 - 127.5 = 0.5 becomes 1.
    EXPECT_EQ(Uniform(126 * unit, 240 * unit, 16 * unit, format), (Ycbcr{128, 255, 1, 0})) << bits;
  }
}

TEST(RawPicture, BelowBlackAndAboveWhiteAreClamped) {
  const PictureFormat format = {Kind::kYuv420, 8, false, false};
  EXPECT_EQ(Uniform(0, 0, 255, format), (Ycbcr{0, 0, 255, 0}));
  EXPECT_EQ(Uniform(255, 128, 128, format), (Ycbcr{255, 128, 128, 0}));
}

TEST(RawPicture, FullRangeOfEightBitsIsKeptAsItIs) {
  const PictureFormat format = {Kind::kYuv420, 8, true, false};
  for (int value = 0; value < 256; ++value) {
    const auto byte = static_cast<std::uint8_t>(value);
    EXPECT_EQ(Uniform(value, 255 - value, value, format),
              (Ycbcr{byte, static_cast<std::uint8_t>(255 - value), byte, 0}));
  }
}

TEST(RawPicture, FullRangeOfMoreBitsSpansTheSameUnits) {
  for (const int bits : {9, 10, 14, 16}) {
    const int max = (1 << bits) - 1;
    const int zero = 1 << (bits - 1);
    const PictureFormat format = {Kind::kYuv420, bits, true, false};
    EXPECT_EQ(Uniform(0, zero, zero, format), (Ycbcr{0, 128, 128, 0})) << bits;
    EXPECT_EQ(Uniform(max, zero, zero, format), (Ycbcr{255, 128, 128, 0})) << bits;
  }
  // 10 bits: 600 * 255 / 1023 = 149.56; 128 + (700 - 512) * 255 / 1023 = 174.86; 128 + (400 - 512) * ... = 100.08.
  EXPECT_EQ(Uniform(600, 700, 400, {Kind::kYuv420, 10, true, false}), (Ycbcr{150, 175, 100, 0}));
}

TEST(RawPicture, LimitedRangeFollowsItsFormulas) {
  // 8 bits: (100 - 16) * 255 / 219 = 97.81; 128 + (90 - 128) * 255 / 224 = 84.74; 128 + 72 * 255 / 224 = 209.96.
  EXPECT_EQ(Uniform(100, 90, 200, {Kind::kYuv420, 8, false, false}), (Ycbcr{98, 85, 210, 0}));
}

TEST(RawPicture, GreyIsTheSameInBothMatricesAndBlueMovesToItsBt601Place) {
  EXPECT_EQ(Uniform(77, 128, 128, {Kind::kYuv420, 8, true, true}), (Ycbcr{77, 128, 128, 0}));
  // BT.709 blue (0, 0, 255): Y' = 0.0722 * 255 = 18.4, Cb = 255.5 -> 255, Cr = 128 - 0.0722 * 255 / 1.5748 = 116.3.
  // BT.601 blue: Y' = 0.114 * 255 = 29.07, Cb = 255.5, Cr = 128 - 29.07 / 1.402 = 107.27.
  const Ycbcr blue = Uniform(18, 255, 116, {Kind::kYuv420, 8, true, true});
  EXPECT_NEAR(blue.y, 29, 1);
  EXPECT_NEAR(blue.cb, 255, 1);
  EXPECT_NEAR(blue.cr, 107, 1);
}

TEST(RawPicture, ChromaLiesOnEvenColumnsAndBetweenRows) {
  // One row of chroma samples 0, 80, 160 across a picture of 5x2: odd columns are the means, the last repeats.
  const PictureFormat format = {Kind::kYuv420, 8, true, false};
  const auto picture =
      DecodeRawPicture(Bytes({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 80, 160, 128, 128, 128}, 8), format, 5, 2, 1);
  ASSERT_TRUE(picture.ok()) << picture.status().message();
  const std::vector<int> across = {0, 40, 80, 120, 160};
  for (int x = 0; x < 5; ++x) EXPECT_EQ((*picture)(x, 0).cb, across[static_cast<std::size_t>(x)]) << x;
  // One column of chroma samples 0, 80 down a picture of 2x4: 0, 1/4, 3/4 and 1 of the way.
  const auto column = DecodeRawPicture(Bytes({0, 0, 0, 0, 0, 0, 0, 0, 0, 80, 128, 128}, 8), format, 2, 4, 1);
  ASSERT_TRUE(column.ok());
  const std::vector<int> down = {0, 20, 60, 80};
  for (int y = 0; y < 4; ++y) EXPECT_EQ((*column)(0, y).cb, down[static_cast<std::size_t>(y)]) << y;
}

TEST(RawPicture, ChromaOf422LiesOnEvenColumnsOfItsOwnRow) {
  const PictureFormat format = {Kind::kYuv422, 8, true, false};
  EXPECT_EQ(RawPictureBytes(format, 5, 3), 15U + 2 * 3 * 3);
  const auto picture =
      DecodeRawPicture(Bytes({0, 0, 0, 0, 0, 0, 0, 80, 160, 9, 11, 128, 128, 128, 128}, 8), format, 3, 2, 1);
  EXPECT_EQ(picture.status().code(), ErrorCode::kInvalidArgument) << "a sample too many";
  const auto right =
      DecodeRawPicture(Bytes({0, 0, 0, 0, 0, 0, 0, 80, 160, 10, 128, 128, 128, 128}, 8), format, 3, 2, 1);
  ASSERT_TRUE(right.ok()) << right.status().message();
  const std::vector<std::vector<int>> rows = {{0, 40, 80}, {160, 85, 10}};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x)
      EXPECT_EQ((*right)(x, y).cb, rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)]);
}

TEST(RawPicture, ChromaOf444IsThatOfThePixel) {
  const PictureFormat format = {Kind::kYuv444, 10, true, false};
  EXPECT_EQ(RawPictureBytes(format, 5, 3), 15U * 3 * 2);
  const auto picture = DecodeRawPicture(Bytes({0, 1023, 0, 1023, 1023, 0}, 10), format, 2, 1, 1);
  ASSERT_TRUE(picture.ok()) << picture.status().message();
  EXPECT_EQ((*picture)(0, 0), (Ycbcr{0, 0, 255, 0}));
  EXPECT_EQ((*picture)(1, 0), (Ycbcr{255, 255, 0, 0}));
}

TEST(RawPicture, GreyFormatsHaveNeutralChroma) {
  const auto picture = DecodeRawPicture(Bytes({0, 512, 1023}, 10), {Kind::kYuv400, 10, true, false}, 3, 1, 1);
  ASSERT_TRUE(picture.ok()) << picture.status().message();
  EXPECT_EQ((*picture)(0, 0), (Ycbcr{0, 128, 128, 0}));
  EXPECT_EQ((*picture)(1, 0), (Ycbcr{128, 128, 128, 0}));
  EXPECT_EQ((*picture)(2, 0), (Ycbcr{255, 128, 128, 0}));
}

TEST(RawPicture, DownscalingAveragesBeforeTheOneRounding) {
  // Samples 1, 3, 3, 1 are 0.25, 0.75, 0.75, 0.25 in 8-bit units: rounded first they are 0, 1, 1, 0 and their mean 0.5
  // becomes 1; their own mean, 2 * 255 / 1023 = 0.4985, is 0.
  const PictureFormat format = {Kind::kYuv400, 10, true, false};
  EXPECT_EQ((*DecodeRawPicture(Bytes({1, 3, 3, 1}, 10), format, 2, 2, 2))(0, 0).y, 0);
}

TEST(RawPicture, FileSizeMustMatchExactlyAndBothNumbersAreSaid) {
  const PictureFormat format = {Kind::kYuv420, 8, false, false};
  EXPECT_EQ(RawPictureBytes(format, 5, 3), 15U + 2 * 3 * 2);
  EXPECT_EQ(RawPictureBytes({Kind::kYuv420, 10, false, false}, 4, 4), 48U);
  EXPECT_EQ(RawPictureBytes({Kind::kYuv400, 16, false, false}, 4, 4), 32U);
  for (const std::size_t size : {0U, 26U, 28U, 54U}) {
    const auto picture = DecodeRawPicture(std::string(size, 'x'), format, 5, 3, 1);
    EXPECT_EQ(picture.status().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(picture.status().message(), HasSubstr(std::to_string(size) + " bytes, expected 27"));
    EXPECT_THAT(picture.status().message(), HasSubstr("5x3 yuv420p8"));
  }
}

TEST(RawPicture, SampleBeyondItsBitsIsAnError) {
  const auto picture = DecodeRawPicture(Bytes({1024}, 10), {Kind::kYuv400, 10, true, false}, 1, 1, 1);
  EXPECT_THAT(picture.status().message(), HasSubstr("sample 1024, expected at most 1023"));
}

TEST(RawPicture, LumaIsReadAsStored) {
  const auto luma = DecodeRawLuma(Bytes({0, 1, 1022, 1023, 512, 512}, 10), {Kind::kYuv420, 10, false, false}, 2, 2);
  ASSERT_TRUE(luma.ok()) << luma.status().message();
  EXPECT_THAT(luma->values(), ::testing::ElementsAre(0, 1, 1022, 1023));
}

TEST(RawPicture, EncodingDiffersFromDecodingByRoundingsOnly) {
  // Blue rises by 4 a column, red by 4 a row: Cb and Cr by about 2 a pixel. Chroma half a pixel beside its place would
  // be 1 off everywhere; in its place an affine picture comes back as it was, but for the rows and columns that edges
  // reach.
  RgbImage rgb(61, 45);
  for (int y = 0; y < rgb.height(); ++y) {
    for (int x = 0; x < rgb.width(); ++x) {
      rgb(x, y) = {static_cast<std::uint8_t>(4 * y), 100, static_cast<std::uint8_t>(4 * x)};
    }
  }
  for (const int bits : {8, 10, 16}) {
    const std::string bytes = EncodeRawYuv420(rgb, bits);
    const auto picture = DecodeRawPicture(bytes, {Kind::kYuv420, bits, true, false}, rgb.width(), rgb.height(), 1);
    ASSERT_TRUE(picture.ok()) << picture.status().message();
    const double roundings = 0.5 + 0.5 * 255 / ((1 << bits) - 1) + 1e-9;  // of the result, of the samples
    for (int y = 0; y < rgb.height(); ++y) {
      for (int x = 0; x < rgb.width(); ++x) {
        const bool inside = x >= 2 && y >= 2 && x < rgb.width() - 2 && y < rgb.height() - 2;
        const double bound = roundings + (inside ? 0 : 1.5);
        const YcbcrReal exact = Bt601FromRgb(rgb(x, y).r, rgb(x, y).g, rgb(x, y).b);
        const Ycbcr& decoded = (*picture)(x, y);
        EXPECT_NEAR(decoded.y, exact.y, roundings) << bits << " bits at " << x << ", " << y;
        EXPECT_NEAR(decoded.cb, 128 + exact.cb, bound) << bits << " bits at " << x << ", " << y;
        EXPECT_NEAR(decoded.cr, 128 + exact.cr, bound) << bits << " bits at " << x << ", " << y;
      }
    }
  }
}

TEST(RawPicture, EncodedChromaLiesOnEvenColumnsAndBetweenRows) {
  // Blue in column 2 of 5: half of its own sample and nothing of the others.
  RgbImage column(5, 2);
  column(2, 0) = column(2, 1) = {0, 0, 255};
  const std::string across = EncodeRawYuv420(column, 8);
  ASSERT_EQ(across.size(), 10U + 3 + 3);
  EXPECT_EQ(across.substr(10, 3), Bytes({128, 192, 128}, 8));  // 128 + 127.5 / 2
  // Blue in column 1: a quarter in the samples of both its neighbours.
  column = RgbImage(5, 2);
  column(1, 0) = column(1, 1) = {0, 0, 255};
  EXPECT_EQ(EncodeRawYuv420(column, 8).substr(10, 3), Bytes({160, 160, 128}, 8));
  // Blue in row 1 of 4: half of the first sample.
  RgbImage row(2, 4);
  row(0, 1) = row(1, 1) = {0, 0, 255};
  EXPECT_EQ(EncodeRawYuv420(row, 8).substr(8, 2), Bytes({192, 128}, 8));
}

TEST(RawPicture, EncodedPlanesHaveHalfTheSizeRoundedUp) {
  const std::string red = EncodeRawYuv420(RgbImage(3, 3, {255, 0, 0}), 8);
  EXPECT_EQ(red, Bytes({76, 76, 76, 76, 76, 76, 76, 76, 76, 85, 85, 85, 85, 255, 255, 255, 255}, 8));
}

TEST(RawPicture, EncodedSamplesOfMoreBitsSpanTheFullRange) {
  EXPECT_EQ(EncodeRawYuv420(RgbImage(2, 2, {255, 255, 255}), 10), Bytes({1023, 1023, 1023, 1023, 512, 512}, 10));
}

TEST(RawPicture, LimitedRangeIsWhatPlayersExpect) {
  YcbcrImage picture(2, 2, {255, 128, 128, 0});
  picture(0, 0).y = 0;
  EXPECT_EQ(EncodeLimitedYuv420(picture), Bytes({16, 235, 235, 235, 128, 128}, 8));
  EXPECT_EQ(EncodeLimitedYuv420(YcbcrImage(1, 1, {0, 0, 255, 0})), Bytes({16, 16, 240}, 8));
}

TEST(RawPicture, LimitedRangeComesBackWithinARounding) {
  YcbcrImage picture(33, 9);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      picture(x, y) = {static_cast<std::uint8_t>(7 * x + y), static_cast<std::uint8_t>(100 + 2 * x),
                       static_cast<std::uint8_t>(150 - 3 * y), 0};
    }
  }
  const auto back = DecodeRawPicture(EncodeLimitedYuv420(picture), {Kind::kYuv420, 8, false, false}, 33, 9, 1);
  ASSERT_TRUE(back.ok());
  for (int y = 2; y < picture.height() - 2; ++y) {
    for (int x = 2; x < picture.width() - 2; ++x) {
      EXPECT_NEAR((*back)(x, y).y, picture(x, y).y, 1);
      EXPECT_NEAR((*back)(x, y).cb, picture(x, y).cb, 1);
      EXPECT_NEAR((*back)(x, y).cr, picture(x, y).cr, 1);
    }
  }
}

}  // namespace
}  // namespace depthfarm
