#include "common/media/depth_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/media/grey_picture.h"
#include "common/media/pfm.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;
using testing_support::TemporaryFolder;

Grid<std::uint16_t> EveryCode() {
  Grid<std::uint16_t> codes(512, 128);
  for (std::size_t i = 0; i < codes.size(); ++i) codes.values()[i] = static_cast<std::uint16_t>(i * 40503);
  return codes;
}

TEST(DepthFile, EveryCodeSurvivesThePng) {
  const auto png = EncodeDepthPng(EveryCode());
  ASSERT_TRUE(png.ok()) << png.status().message();
  const auto codes = DecodeDepthPng(*png);
  ASSERT_TRUE(codes.ok()) << codes.status().message();
  EXPECT_EQ(*codes, EveryCode());
}

TEST(DepthFile, EqualCodesAreEqualBytes) { EXPECT_EQ(*EncodeDepthPng(EveryCode()), *EncodeDepthPng(EveryCode())); }

TEST(DepthFile, IsABareSixteenBitGreyPng) {
  const std::string png = *EncodeDepthPng(Grid<std::uint16_t>(3, 2, 7));
  EXPECT_EQ(png.substr(24, 2), std::string("\x10\0", 2));  // IHDR: bit depth 16, colour type 0
  for (const char* chunk : {"tIME", "tEXt", "pHYs", "gAMA"}) EXPECT_EQ(png.find(chunk), std::string::npos) << chunk;
}

TEST(DepthFile, InverseDepthAndDepthMakeTheSameFile) {
  const DepthCode code = *DepthCode::Create(2, 8);
  DepthMap depth(2, 2);
  depth.values() = {2, 4, 8, 0};
  Grid<float> inverse(2, 2);
  inverse.values() = {0.5F, 0.25F, 0.125F, -1};
  EXPECT_EQ(*EncodeDepthPng(depth, code), *EncodeInverseDepthPng(inverse, code));
}

TEST(DepthFile, IsReadThroughTheManifestsCamera) {
  const TemporaryFolder folder;
  DepthManifestCamera camera;
  camera.camera.name = "a";
  camera.camera.width = 2;
  camera.camera.height = 1;
  camera.z_near = 1;
  camera.z_far = 4;
  camera.files = {{DepthFileName("a", 0), std::string(64, '0')}};
  Grid<std::uint16_t> codes(2, 1);
  codes.values() = {0, 65535};
  folder.Write(camera.files[0].path, *EncodeDepthPng(codes));
  const std::string directory = folder.path().string();
  const auto depth = ReadDepthOf(directory, camera, 0);
  ASSERT_TRUE(depth.ok()) << depth.status().message();
  EXPECT_THAT(depth->values(), ::testing::ElementsAre(0.0F, 1.0F));
  EXPECT_THAT(ReadDepthOf(directory, camera, 1).status().message(), HasSubstr("camera 'a' has 1 depth maps"));
  camera.camera.height = 2;
  EXPECT_THAT(ReadDepthOf(directory, camera, 0).status().message(), HasSubstr("2x1 pixels, expected 2x2"));
}

TEST(DepthFile, EveryFormatHoldsTheDepthOfTheCodes) {
  const TemporaryFolder folder;
  const DepthCode code = *DepthCode::Create(2, 80);
  for (const DepthFormat format :
       {DepthFormat::kPng16, DepthFormat::kPfm, DepthFormat::kExr, DepthFormat::kYuv420p16}) {
    SCOPED_TRACE(NameOf(format));
    const auto bytes = EncodeDepthFile(EveryCode(), code, format);
    ASSERT_TRUE(bytes.ok()) << bytes.status().message();
    EXPECT_TRUE(*bytes == *EncodeDepthFile(EveryCode(), code, format));
    const std::string name = "map." + ExtensionOf(format);
    folder.Write(name, *bytes);
    const std::string path = (folder.path() / name).string();
    const auto depth = ReadDepthFile(path, 512, 128, code);
    ASSERT_TRUE(depth.ok()) << depth.status().message();
    EXPECT_TRUE(*depth == DecodeDepth(EveryCode(), code));
    const auto codes = ReadDepthCodes(path, 512, 128, code);
    ASSERT_TRUE(codes.ok()) << codes.status().message();
    EXPECT_TRUE(*codes == EveryCode()) << "floats are finer than a step of codes";
    const Status other_size = ReadDepthFile(path, 511, 128, code).status();
    EXPECT_EQ(other_size.code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(other_size.message(), HasSubstr(path));
    folder.Write(name, bytes->substr(0, bytes->size() / 2));
    EXPECT_THAT(ReadDepthFile(path, 512, 128, code).status().message(), HasSubstr(path));
  }
}

TEST(DepthFile, RawCodesAreLumaOfAGreyPicture) {
  Grid<std::uint16_t> codes(3, 1);
  codes.values() = {1, 0x1234, 65535};
  const std::string bytes = *EncodeDepthFile(codes, *DepthCode::Create(1, 2), DepthFormat::kYuv420p16);
  EXPECT_EQ(bytes, std::string("\x01\x00\x34\x12\xff\xff", 6) + std::string("\x00\x80\x00\x80\x00\x80\x00\x80", 8));
}

TEST(DepthFile, WhatIsNoDepthInMetricFilesIsNoneHere) {
  const TemporaryFolder folder;
  Grid<float> values(5, 1);
  const float infinity = std::numeric_limits<float>::infinity();
  values.values() = {2, -1, 0, infinity, std::numeric_limits<float>::quiet_NaN()};
  folder.Write("map.pfm", EncodePfm(values));
  const auto depth = ReadDepthFile((folder.path() / "map.pfm").string(), 5, 1, *DepthCode::Create(1, 4));
  ASSERT_TRUE(depth.ok()) << depth.status().message();
  EXPECT_THAT(depth->values(), ::testing::ElementsAre(2.0F, 0.0F, 0.0F, 0.0F, 0.0F));
}

TEST(DepthFile, AnUnknownEndingIsExplained) {
  EXPECT_THAT(ReadDepthFile("/there/map.tif", 1, 1, *DepthCode::Create(1, 2)).status().message(),
              HasSubstr("/there/map.tif: expected a depth map, .png, .pfm, .exr or .yuv"));
}

TEST(DepthFile, EightBitsAreRefused) {
  const std::string png = *EncodeGreyPng(Grid<std::uint8_t>(2, 2, 9));
  EXPECT_THAT(DecodeDepthPng(png).status().message(), HasSubstr("8 bits per sample"));
}

TEST(DepthFile, EmptyMapIsAnError) { EXPECT_FALSE(EncodeDepthPng(Grid<std::uint16_t>()).ok()); }

}  // namespace
}  // namespace depthfarm
