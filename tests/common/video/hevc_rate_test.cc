#include "common/video/hevc_rate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/common/video/test_video.h"

namespace depthfarm {
namespace {

constexpr int kPictures = 8;

HevcRate Rate(int qp, double motion, int noise) {
  Result<HevcRateMeter> meter = HevcRateMeter::Create(kVideoWidth, kVideoHeight, 8, qp);
  EXPECT_TRUE(meter.ok()) << meter.status().message();
  if (!meter.ok()) return {};
  for (int i = 0; i < kPictures; ++i) {
    const Status status = meter->Put(TestPicture(i, motion * i, noise));
    EXPECT_TRUE(status.ok()) << status.message();
  }
  const Result<HevcRate> rate = meter->Finish();
  EXPECT_TRUE(rate.ok()) << rate.status().message();
  return rate.ok() ? *rate : HevcRate{};
}

TEST(HevcRate, ACoarserQuantiserTakesFewerBitsAndKeepsLess) {
  const HevcRate fine = Rate(22, 0.7, 6);
  const HevcRate coarse = Rate(37, 0.7, 6);
  EXPECT_EQ(fine.qp, 22);
  EXPECT_EQ(fine.pictures, kPictures);
  EXPECT_GT(fine.bits_per_picture, 2 * coarse.bits_per_picture);
  EXPECT_GT(fine.psnr, coarse.psnr + 5);
  EXPECT_GT(fine.psnr, 35);
  EXPECT_LT(fine.psnr, 60);
}

// The reason for measuring: what flickers cannot be predicted from the picture before.
TEST(HevcRate, FlickerCostsBits) {
  const HevcRate still = Rate(22, 0, 0);
  const HevcRate flickering = Rate(22, 0, 6);
  EXPECT_GT(flickering.bits_per_picture, 3 * still.bits_per_picture);
}

TEST(HevcRate, OnlyTheFirstPictureIsIntra) {
  const HevcRate still = Rate(22, 0, 0);
  Result<HevcRateMeter> meter = HevcRateMeter::Create(kVideoWidth, kVideoHeight, 8, 22);
  ASSERT_TRUE(meter.ok());
  ASSERT_TRUE(meter->Put(TestPicture(0, 0, 0)).ok());
  const Result<HevcRate> first = meter->Finish();
  ASSERT_TRUE(first.ok());
  EXPECT_LT(still.bits_per_picture, first->bits_per_picture / 4);
}

TEST(HevcRate, IsTheSameEachTime) {
  const HevcRate a = Rate(27, 0.7, 6);
  const HevcRate b = Rate(27, 0.7, 6);
  EXPECT_EQ(a.bits_per_picture, b.bits_per_picture);
  EXPECT_EQ(a.psnr, b.psnr);
}

TEST(HevcRate, TakesTenBits) {
  Result<HevcRateMeter> meter = HevcRateMeter::Create(kVideoWidth, kVideoHeight, 10, 22);
  ASSERT_TRUE(meter.ok()) << meter.status().message();
  std::string picture;
  for (const char sample : TestPicture(0, 0, 6)) {
    const int value = 4 * static_cast<unsigned char>(sample);
    picture += static_cast<char>(value & 0xFF);
    picture += static_cast<char>(value >> 8);
  }
  ASSERT_TRUE(meter->Put(picture).ok());
  const Result<HevcRate> rate = meter->Finish();
  ASSERT_TRUE(rate.ok()) << rate.status().message();
  EXPECT_GT(rate->psnr, 35);
  EXPECT_LT(rate->psnr, 60);
}

TEST(HevcRate, RefusesWhatItCannotEncode) {
  const auto message = [](int width, int height, int bits, int qp) {
    const Result<HevcRateMeter> meter = HevcRateMeter::Create(width, height, bits, qp);
    return meter.ok() ? std::string("accepted") : meter.status().message();
  };
  EXPECT_THAT(message(63, 48, 8, 22), testing::HasSubstr("63x48"));
  EXPECT_THAT(message(64, 8, 8, 22), testing::HasSubstr("64x8"));
  EXPECT_THAT(message(64, 48, 9, 22), testing::HasSubstr("9 bits"));
  EXPECT_THAT(message(64, 48, 8, 52), testing::HasSubstr("quantiser of 52"));
  Result<HevcRateMeter> meter = HevcRateMeter::Create(64, 48, 8, 22);
  ASSERT_TRUE(meter.ok());
  EXPECT_THAT(meter->Put("short").message(), testing::HasSubstr("5 bytes"));
}

TEST(HevcRate, OfNoPictureIsAnError) {
  Result<HevcRateMeter> meter = HevcRateMeter::Create(64, 48, 8, 22);
  ASSERT_TRUE(meter.ok());
  EXPECT_EQ(meter->Finish().status().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
