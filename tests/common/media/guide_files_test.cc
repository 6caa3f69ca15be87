#include "common/media/guide_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "common/image/depth_code.h"
#include "common/media/depth_file.h"
#include "common/media/exr.h"
#include "common/media/grey_picture.h"
#include "common/media/pfm.h"

namespace depthfarm {
namespace {

using Holds = PriorFormat::Holds;
using testing::ElementsAre;
using testing::HasSubstr;

template <typename T>
Grid<T> Map(int width, int height, std::vector<T> values) {
  Grid<T> grid(width, height);
  grid.values() = std::move(values);
  return grid;
}

TEST(DecodePrior, DepthIsInvertedInItsUnitAndTheUnknownIsZero) {
  const float infinity = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::string pfm = EncodePfm(Map<float>(3, 2, {2000, 500, 0, -1, infinity, nan}));
  const auto prior = DecodePrior(pfm, {.holds = Holds::kDepth, .unit = 0.001}, 3, 2);
  ASSERT_TRUE(prior.ok()) << prior.status().message();
  EXPECT_THAT(prior->values(), ElementsAre(0.5F, 2.0F, 0.0F, 0.0F, 0.0F, 0.0F));
}

TEST(DecodePrior, InverseAndRelativeDepthAreValues) {
  const std::string pfm = EncodePfm(Map<float>(2, 1, {4, 0}));
  EXPECT_THAT(DecodePrior(pfm, {.holds = Holds::kInverseDepth, .unit = 2}, 2, 1)->values(), ElementsAre(2.0F, 0.0F));
  EXPECT_THAT(DecodePrior(pfm, {.holds = Holds::kRelativeDepth}, 2, 1)->values(), ElementsAre(4.0F, 0.0F));
  const std::string png = *EncodeGreyPng(Map<std::uint8_t>(2, 1, {0, 7}));
  EXPECT_THAT(DecodePrior(png, {.holds = Holds::kRelativeDepth}, 2, 1)->values(), ElementsAre(0.0F, 7.0F));
}

TEST(DecodePrior, CodesAreThoseOfOurOutput) {
  const DepthCode code = DepthCode::Create(2, 10).value();
  const std::string png = *EncodeGreyPng(Map<std::uint16_t>(3, 1, {0, 1, code.FromInverseDepth(0.3)}));
  const PriorFormat format{.holds = Holds::kCodes, .unit = 1, .z_near = 2, .z_far = 10};
  const auto prior = DecodePrior(png, format, 3, 1);
  ASSERT_TRUE(prior.ok()) << prior.status().message();
  EXPECT_EQ(prior->values()[0], 0);
  EXPECT_FLOAT_EQ(prior->values()[1], 0.1F);
  EXPECT_NEAR(prior->values()[2], 0.3, 1e-5);
  const std::string eight_bits = *EncodeGreyPng(Map<std::uint8_t>(3, 1, {0, 1, 2}));
  EXPECT_THAT(DecodePrior(eight_bits, format, 3, 1).status().message(), HasSubstr("16-bit"));
}

TEST(DecodePrior, RawCodesAreThoseOfAPictureOfItsSize) {
  const DepthCode code = DepthCode::Create(2, 10).value();
  const Grid<std::uint16_t> codes = Map<std::uint16_t>(3, 1, {0, 1, 65535});
  const std::string raw = *EncodeDepthFile(codes, code, DepthFormat::kYuv420p16);
  const PriorFormat format{.holds = Holds::kCodes, .unit = 1, .z_near = 2, .z_far = 10};
  const auto prior = DecodePrior(raw, format, 3, 1);
  ASSERT_TRUE(prior.ok()) << prior.status().message();
  EXPECT_THAT(prior->values(), ElementsAre(0.0F, 0.1F, 0.5F));
  EXPECT_EQ(DecodePrior(raw, format, 6, 2).status().code(), ErrorCode::kInvalidArgument);
}

TEST(DecodePrior, OpenExrIsReadAsOtherMapsOfValues) {
  const std::string exr = *EncodeExr(Map<float>(2, 1, {4, 0}));
  EXPECT_THAT(DecodePrior(exr, {.holds = Holds::kDepth, .unit = 0.5}, 2, 1)->values(), ElementsAre(0.5F, 0.0F));
}

TEST(DecodePrior, OtherSizesAreSampledAndOtherProportionsRefused) {
  const std::string pfm = EncodePfm(Map<float>(2, 1, {1, 2}));
  EXPECT_THAT(DecodePrior(pfm, {.holds = Holds::kInverseDepth}, 4, 2)->values(),
              ElementsAre(1.0F, 1.0F, 2.0F, 2.0F, 1.0F, 1.0F, 2.0F, 2.0F));
  const Status refused = DecodePrior(pfm, {.holds = Holds::kInverseDepth}, 4, 3).status();
  EXPECT_EQ(refused.code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(refused.message(), "has 2x1 pixels, expected the proportions of 4x3");
}

TEST(DecodePrior, ABrokenFileIsRefused) {
  EXPECT_EQ(DecodePrior("", {.holds = Holds::kDepth}, 4, 3).status().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(DecodePrior("Pf\n4 3\n-1\nshort", {.holds = Holds::kDepth}, 4, 3).status().code(),
            ErrorCode::kInvalidArgument);
}

TEST(DecodeShare, IsOfTheFullRangeOfEitherDepth) {
  EXPECT_THAT(DecodeShare(*EncodeGreyPng(Map<std::uint8_t>(2, 1, {0, 255})), 2, 1)->values(), ElementsAre(0.0F, 1.0F));
  EXPECT_THAT(DecodeShare(*EncodeGreyPng(Map<std::uint16_t>(2, 1, {65535, 0})), 2, 1)->values(),
              ElementsAre(1.0F, 0.0F));
}

TEST(ApplyMask, WritesTheMatteAlone) {
  YcbcrImage picture(3, 1, Ycbcr{90, 120, 130, 0});
  ASSERT_TRUE(ApplyMask(*EncodeGreyPng(Map<std::uint8_t>(3, 1, {0, 128, 255})), picture).ok());
  EXPECT_EQ(picture(0, 0), (Ycbcr{90, 120, 130, 0}));
  EXPECT_EQ(picture(1, 0), (Ycbcr{90, 120, 130, kForegroundMatte / 2}));
  EXPECT_EQ(picture(2, 0), (Ycbcr{90, 120, 130, kForegroundMatte}));
}

}  // namespace
}  // namespace depthfarm
