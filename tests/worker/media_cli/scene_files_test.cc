#include "worker/media_cli/scene_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <string>

namespace depthfarm {
namespace {

TEST(SceneFiles, PfmStartsWithTheBottomRow) {
  DepthMap depth(2, 2);
  depth(0, 0) = 1;
  depth(1, 0) = 2;
  depth(0, 1) = 3.25F;
  depth(1, 1) = 4;
  const Bytes bytes = EncodePfm(depth);
  const std::string header = "Pf\n2 2\n-1.0\n";
  ASSERT_EQ(bytes.size(), header.size() + 16);
  EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + static_cast<long>(header.size())), header);
  // 3.25 is 0x40500000, little-endian.
  const Bytes first(bytes.begin() + static_cast<long>(header.size()),
                    bytes.begin() + static_cast<long>(header.size()) + 4);
  EXPECT_EQ(first, (Bytes{0, 0, 0x50, 0x40}));
}

TEST(SceneFiles, PngKeepsEveryPixelAndTheOrderOfChannels) {
  RgbImage rgb(3, 2);
  rgb(2, 1) = {200, 100, 50};
  const cv::Mat decoded = cv::imdecode(EncodePng(rgb).value(), cv::IMREAD_COLOR);
  ASSERT_EQ(decoded.cols, 3);
  ASSERT_EQ(decoded.rows, 2);
  EXPECT_EQ(decoded.at<cv::Vec3b>(1, 2), cv::Vec3b(50, 100, 200));
  ZoneMap zones(3, 2);
  zones(1, 0) = 7;
  const cv::Mat grey = cv::imdecode(EncodePng(zones).value(), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(grey.type(), CV_8UC1);
  EXPECT_EQ(grey.at<unsigned char>(0, 1), 7);
}

TEST(SceneFiles, Yuv420HasHalfSizeChromaRoundedUp) {
  RgbImage rgb(3, 3);
  for (auto& pixel : rgb.values()) pixel = {255, 0, 0};
  const Bytes eight = EncodeYuv420(rgb, 8);
  ASSERT_EQ(eight.size(), 9u + 4u + 4u);
  EXPECT_EQ(eight[0], 76);
  EXPECT_EQ(eight[9], 85);
  EXPECT_EQ(eight[13], 255);
}

TEST(SceneFiles, TenBitSamplesAreLittleEndianOverTheFullRange) {
  RgbImage rgb(2, 2);
  for (auto& pixel : rgb.values()) pixel = {255, 255, 255};
  const Bytes ten = EncodeYuv420(rgb, 10);
  ASSERT_EQ(ten.size(), 2u * (4 + 1 + 1));
  EXPECT_EQ(ten[0] + 256 * ten[1], 1023);
  EXPECT_EQ(ten[8] + 256 * ten[9], 512);
  EXPECT_EQ(ten[10] + 256 * ten[11], 512);
}

TEST(SceneFiles, WritingReplacesAFileAndLeavesNothingElse) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "scene_files_test";
  std::filesystem::remove_all(folder);
  ASSERT_TRUE(MakeFolder(folder / "a" / "b").ok());
  const std::filesystem::path file = folder / "a" / "b" / "x";
  ASSERT_TRUE(WriteWhole(file, Bytes{1, 2, 3}).ok());
  ASSERT_TRUE(WriteWhole(file, Bytes{9}).ok());
  std::ifstream stream(file, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), std::string(1, '\t'));
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(file.parent_path())) ++files;
  EXPECT_EQ(files, 1);
  // A file where a folder is needed: said, with its name.
  const Status status = MakeFolder(file / "below");
  EXPECT_EQ(status.code(), ErrorCode::kUnavailable);
  EXPECT_NE(status.message().find("below"), std::string::npos);
  EXPECT_EQ(WriteWhole(folder / "missing" / "x", Bytes{1}).code(), ErrorCode::kUnavailable);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace depthfarm
