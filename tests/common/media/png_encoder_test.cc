#include "common/media/png_encoder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

namespace depthfarm {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// What libpng makes of it, as it was stored.
cv::Mat Decoded(const std::string& png) {
  return cv::imdecode(std::vector<std::uint8_t>(png.begin(), png.end()), cv::IMREAD_UNCHANGED);
}

bool Same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

cv::Mat Noise(int width, int height, int type) {
  cv::Mat image(height, width, type);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, image.depth() == CV_8U ? 256 : 65536);
  return image;
}

// A slanted wall with a step, as depth is.
cv::Mat Depth(int width, int height) {
  cv::Mat image(height, width, CV_16U);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      image.at<std::uint16_t>(y, x) = static_cast<std::uint16_t>((x > y ? 20'000 : 3'000) + 37 * x + 11 * y);
  return image;
}

// What OpenCV's own encoder makes of it at zlib's level 4.
std::size_t BytesOfOpenCv(const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(
      cv::imencode(".png", image, bytes,
                   {cv::IMWRITE_PNG_COMPRESSION, 4, cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_DEFAULT}));
  return bytes.size();
}

TEST(EncodePng, IsReadBackByLibpng) {
  for (const int type : {CV_8UC1, CV_8UC3, CV_16UC1, CV_16UC3}) {
    for (const cv::Size size : {cv::Size(1, 1), cv::Size(1, 9), cv::Size(9, 1), cv::Size(64, 48), cv::Size(321, 7)}) {
      const cv::Mat noise = Noise(size.width, size.height, type);
      const Result<std::string> png = EncodePng(noise);
      ASSERT_TRUE(png.ok()) << png.status().message();
      EXPECT_THAT(*png, StartsWith("\x89PNG\r\n\x1a\n"));
      EXPECT_TRUE(Same(Decoded(*png), noise)) << type << ", " << size.width << "x" << size.height;
      const cv::Mat flat(size, type, cv::Scalar::all(200));
      EXPECT_TRUE(Same(Decoded(*EncodePng(flat)), flat));
    }
  }
  const cv::Mat depth = Depth(320, 240);
  EXPECT_TRUE(Same(Decoded(*EncodePng(depth)), depth));
}

TEST(EncodePng, TakesAPartOfAPicture) {
  const cv::Mat whole = Noise(40, 30, CV_8UC3);
  const cv::Mat part = whole(cv::Rect(5, 6, 17, 11));
  const Result<std::string> png = EncodePng(part);
  ASSERT_TRUE(png.ok());
  EXPECT_TRUE(Same(Decoded(*png), part));
  EXPECT_EQ(*png, *EncodePng(part.clone()));
}

TEST(EncodePng, IsHardlyLargerThanWhatLibpngWrites) {
  cv::Mat picture(240, 320, CV_8UC3);
  const cv::Mat noise = Noise(320, 240, CV_8UC3);
  for (int y = 0; y < picture.rows; ++y) {
    for (int x = 0; x < picture.cols; ++x) {
      for (int c = 0; c < 3; ++c) {
        const double value = 128 + 90 * std::sin(0.02 * (x + 3 * y + 40 * c)) + noise.at<cv::Vec3b>(y, x)[c] % 5;
        picture.at<cv::Vec3b>(y, x)[c] = static_cast<std::uint8_t>(value);
      }
    }
  }
  for (const cv::Mat& image : {picture, Depth(320, 240)})
    EXPECT_LT(static_cast<double>(EncodePng(image)->size()), 1.1 * static_cast<double>(BytesOfOpenCv(image)));
}

TEST(EncodePng, RefusesWhatPngCannotHold) {
  for (const cv::Mat& image : {cv::Mat(), cv::Mat(3, 4, CV_32F), cv::Mat(3, 4, CV_8UC2), cv::Mat(3, 4, CV_8UC4)}) {
    const Result<std::string> png = EncodePng(image);
    EXPECT_EQ(png.status().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(png.status().message(), HasSubstr("cannot be encoded as PNG"));
  }
}

}  // namespace
}  // namespace depthfarm
