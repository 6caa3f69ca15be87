#include "worker/media_cli/export_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "common/base/little_endian.h"
#include "common/files/atomic_file.h"
#include "common/media/depth_file.h"
#include "common/media/exr.h"
#include "common/media/pfm.h"
#include "common/sequence/depth_manifest.h"
#include "tests/support/temporary_folder.h"
#include "worker/media_cli/point_cloud.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;
using testing_support::TemporaryFolder;

constexpr int kWidth = 4;
constexpr int kHeight = 2;

// Depth of frames 3 and 4 of two cameras, 2 everywhere but for a pixel without depth.
class Exported : public testing::Test {
 protected:
  void SetUp() override {
    DepthManifest manifest;
    manifest.first_frame = 3;
    DepthMap depth(kWidth, kHeight, 2.0F);
    depth(1, 0) = 0;
    for (const char* name : {"a", "b"}) {
      DepthManifestCamera entry;
      entry.camera.name = name;
      entry.camera.width = kWidth;
      entry.camera.height = kHeight;
      entry.z_near = 1;
      entry.z_far = 4;
      for (const int frame : {3, 4}) {
        entry.files.push_back({DepthFileName(name, frame), std::string(64, '0')});
        entry.input_sha256.emplace_back(64, '0');
        folder_.Write("in/" + entry.files.back().path, *EncodeDepthPng(depth, *DepthCode::Create(1, 4)));
      }
      manifest.cameras.push_back(entry);
    }
    ASSERT_TRUE(WriteDepthManifest(folder_.File("in"), manifest).ok());
  }
  [[nodiscard]] Status Export(ExportCommandOptions options) {
    options.depth_dir = folder_.File("in");
    options.output = folder_.File("out");
    return RunExport(options, out_);
  }
  [[nodiscard]] std::string Bytes(const std::string& name) const {
    return ReadFileBytes(folder_.File("out/" + name), 1 << 20).value();
  }

  TemporaryFolder folder_;
  std::ostringstream out_;
};

TEST_F(Exported, PfmIsMetric) {
  const Status status = Export({.format = "pfm"});
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_THAT(out_.str(), HasSubstr("2 frames of 2 cameras"));
  for (const char* file : {"a/0003.pfm", "b/0004.pfm"}) {
    const Grid<float> depth = ReadPfm(folder_.File(std::string("out/") + file)).value();
    EXPECT_EQ(depth.width(), kWidth);
    EXPECT_NEAR(depth(0, 0), 2, 1e-4);
    EXPECT_EQ(depth(1, 0), 0);
  }
}

TEST_F(Exported, OpenExrHasTheSameDepthAsPfm) {
  ASSERT_TRUE(Export({.format = "pfm"}).ok());
  const Status status = Export({.format = "exr"});
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_THAT(out_.str(), HasSubstr("/CAMERA/FRAME.exr"));
  for (const char* name : {"a/0003", "b/0004"}) {
    const Result<Grid<float>> depth = DecodeExr(Bytes(std::string(name) + ".exr"));
    ASSERT_TRUE(depth.ok()) << depth.status().message();
    EXPECT_EQ(*depth, ReadPfm(folder_.File("out/" + std::string(name) + ".pfm")).value());
  }
}

TEST_F(Exported, YuvHasTheCodesOfAllFramesAndTheirCameras) {
  const Status status = Export({.format = "yuv"});
  ASSERT_TRUE(status.ok()) << status.message();
  const std::string video = Bytes("a.yuv");
  constexpr std::size_t kPictureBytes = 2 * (kWidth * kHeight + 2 * 2 * 1);
  ASSERT_EQ(video.size(), 2 * kPictureBytes);
  const auto sample = [&](std::size_t i) {
    return static_cast<std::uint8_t>(video[2 * i]) | static_cast<std::uint8_t>(video[2 * i + 1]) << 8;
  };
  // 1 + 65534 (1/2 - 1/4) / (1/1 - 1/4), rounded.
  EXPECT_EQ(sample(0), 21846);
  EXPECT_EQ(sample(1), 0);
  for (std::size_t i = kWidth * kHeight; i < kPictureBytes / 2; ++i) EXPECT_EQ(sample(i), 32768);
  EXPECT_EQ(sample(kPictureBytes / 2), 21846) << "the second frame";
  const auto json = nlohmann::json::parse(Bytes("cameras.json"));
  EXPECT_EQ(json["frames"], 2);
  EXPECT_EQ(json["firstFrame"], 3);
  EXPECT_EQ(json["cameras"][1]["depth"], "b.yuv");
  EXPECT_EQ(json["cameras"][1]["zFar"], 4);
}

TEST_F(Exported, FramesAreThoseOfTheSequence) {
  ASSERT_TRUE(Export({.format = "pfm", .first_frame = 4}).ok());
  EXPECT_FALSE(std::filesystem::exists(folder_.File("out/a/0003.pfm")));
  EXPECT_TRUE(std::filesystem::exists(folder_.File("out/a/0004.pfm")));
  EXPECT_THAT(Export({.format = "pfm", .first_frame = 2}).message(),
              HasSubstr("--frames asks for 2 to 4, " + folder_.File("in") + " has depth of 3 to 4"));
}

TEST_F(Exported, WhatIsNotTheFormatsIsRefused) {
  EXPECT_THAT(Export({.format = "obj"}).message(), HasSubstr("FORMAT is 'obj', expected pfm, exr, yuv or ply"));
  EXPECT_THAT(Export({.format = "ply"}).message(), HasSubstr("ply needs --sequence"));
  EXPECT_THAT(Export({.format = "yuv", .step = 2}).message(), HasSubstr("are of ply"));
  EXPECT_THAT(
      RunExport({.format = "pfm", .depth_dir = folder_.File("in"), .output = folder_.File("in")}, out_).message(),
      HasSubstr("the folder that is exported"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("out")));
}

TEST_F(Exported, AnInterruptedOneLeavesNothingHalfWritten) {
  int asked = 0;
  EXPECT_EQ(Export({.format = "yuv", .interrupted = [&] { return ++asked == 2; }}).code(), ErrorCode::kCancelled);
  EXPECT_TRUE(std::filesystem::is_empty(folder_.File("out")));
}

float FloatAt(const std::string& bytes, std::size_t offset) { return std::bit_cast<float>(ReadU32(bytes, offset)); }

// By hand: K has focal length 2 and its centre at pixel (1, 1); R turns the world by 90 degrees about y.
TEST(PointCloud, PointsAreInTheWorld) {
  Camera camera;
  camera.width = 4;
  camera.height = 2;
  camera.intrinsics << 2, 0, 1, 0, 2, 1, 0, 0, 1;
  camera.cam_from_world_rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  camera.cam_from_world_translation << 1, 2, 3;
  DepthMap depth(4, 2);
  depth(3, 1) = 4;  // x_cam = (4, 0, 4); x_cam - t = (3, -2, 1); X = R^T of that = (-1, -2, 3)
  depth(0, 0) = 1;
  YcbcrImage picture(4, 2);
  for (Ycbcr& pixel : picture.values()) pixel = {255, 128, 128, 0};
  Grid<std::uint16_t> confidence(4, 2, 100);
  confidence(0, 0) = 99;
  PointCloud cloud;
  cloud.Add(camera, depth, picture, {.confidence = &confidence, .least = 100});
  ASSERT_EQ(cloud.num_points(), 1U);
  const std::string ply = cloud.Ply();
  EXPECT_THAT(ply, testing::StartsWith("ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n"));
  const std::size_t at = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size(), at + 15);
  EXPECT_FLOAT_EQ(FloatAt(ply, at), -1);
  EXPECT_FLOAT_EQ(FloatAt(ply, at + 4), -2);
  EXPECT_FLOAT_EQ(FloatAt(ply, at + 8), 3);
  EXPECT_EQ(ply.substr(at + 12), "\xff\xff\xff");
  cloud.Add(camera, depth, picture, {});
  EXPECT_EQ(cloud.num_points(), 3U);
  PointCloud coarse;
  coarse.Add(camera, depth, picture, {.step = 2});
  EXPECT_EQ(coarse.num_points(), 1U) << "(0, 0) is on the grid, (3, 1) is not";
}

}  // namespace
}  // namespace depthfarm
