#include "common/sequence/depth_manifest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/files/atomic_file.h"
#include "tests/common/sequence/sequence_text.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;
using testing_support::TemporaryFolder;

DepthManifest SmallManifest() {
  DepthManifest manifest;
  manifest.sequence = "small";
  manifest.algorithm_version = 3;
  manifest.first_frame = 5;
  manifest.parameters = {{"levels", std::int64_t{250}}, {"smoothing", 0.1}, {"partition", std::string("blocks")}};
  for (const char* name : {"a", "b"}) {
    DepthManifestCamera entry;
    entry.camera.name = name;
    entry.camera.width = 32;
    entry.camera.height = 24;
    entry.camera.intrinsics << 25.1, 0, 15.5, 0, 25.2, 11.5, 0, 0, 1;
    entry.camera.cam_from_world_translation << 0.1, -1.0 / 3, 1e-7;
    entry.z_near = 37.123456789012345;
    entry.z_far = 143;
    entry.files = {{DepthFileName(name, 5), std::string(64, 'a')}, {DepthFileName(name, 6), std::string(64, '0')}};
    entry.input_sha256 = {std::string(64, '1'), std::string(64, 'f')};
    manifest.cameras.push_back(entry);
  }
  return manifest;
}

TEST(DepthManifest, HasConfidenceForEachDepthMapOrForNone) {
  const TemporaryFolder folder;
  DepthManifest manifest = SmallManifest();
  EXPECT_THAT(FormatDepthManifest(manifest).value(), testing::Not(HasSubstr("confidence")));
  for (DepthManifestCamera& camera : manifest.cameras)
    for (int frame = 5; frame < 7; ++frame)
      camera.confidence.push_back({ConfidenceFileName(camera.camera.name, frame), std::string(64, 'c')});
  ASSERT_TRUE(WriteDepthManifest(folder.path().string(), manifest).ok());
  const auto read = ReadDepthManifest(folder.path().string());
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->cameras[1].confidence, manifest.cameras[1].confidence);
  EXPECT_EQ(read->cameras[1].confidence[0].path, "confidence/b/0005.png");
  const auto message = [](const DepthManifest& bad) { return FormatDepthManifest(bad).status().message(); };
  DepthManifest fewer = manifest;
  fewer.cameras[1].confidence.pop_back();
  EXPECT_THAT(message(fewer), HasSubstr("camera 'b': has 2 files and 1 of confidence"));
  DepthManifest outside = manifest;
  outside.cameras[0].confidence[1].path = "../x.png";
  EXPECT_THAT(message(outside), HasSubstr("camera 'a': confidence[1] is \"../x.png\""));
  DepthManifest digest = manifest;
  digest.cameras[0].confidence[1].sha256 = "no";
  EXPECT_THAT(message(digest), HasSubstr("confidenceSha256[1] is not 64"));
}

TEST(DepthManifest, ComesBackAsItWasToTheLastBit) {
  const TemporaryFolder folder;
  const DepthManifest written = SmallManifest();
  ASSERT_TRUE(WriteDepthManifest(folder.path().string(), written).ok());
  const auto read = ReadDepthManifest(folder.path().string());
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->sequence, written.sequence);
  EXPECT_EQ(read->algorithm_version, written.algorithm_version);
  EXPECT_EQ(read->first_frame, written.first_frame);
  EXPECT_EQ(read->parameters, written.parameters);
  ASSERT_EQ(read->cameras.size(), written.cameras.size());
  for (std::size_t i = 0; i < written.cameras.size(); ++i) {
    const DepthManifestCamera& from = written.cameras[i];
    const DepthManifestCamera& to = read->cameras[i];
    EXPECT_EQ(to.camera.name, from.camera.name);
    EXPECT_EQ(to.camera.width, from.camera.width);
    EXPECT_EQ(to.camera.height, from.camera.height);
    EXPECT_EQ(to.camera.intrinsics, from.camera.intrinsics);
    EXPECT_EQ(to.camera.cam_from_world_rotation, from.camera.cam_from_world_rotation);
    EXPECT_EQ(to.camera.cam_from_world_translation, from.camera.cam_from_world_translation);
    EXPECT_EQ(to.z_near, from.z_near);
    EXPECT_EQ(to.z_far, from.z_far);
    EXPECT_EQ(to.files, from.files);
    EXPECT_EQ(to.input_sha256, from.input_sha256);
  }
}

TEST(DepthManifest, EqualManifestsAreEqualBytes) {
  EXPECT_EQ(*FormatDepthManifest(SmallManifest()), *FormatDepthManifest(SmallManifest()));
}

TEST(DepthManifest, FrameNumbersHaveFourDigitsOrMore) {
  EXPECT_EQ(DepthFileName("cam0", 7), "depth/cam0/0007.png");
  EXPECT_EQ(DepthFileName("cam0", 12345, "pfm"), "depth/cam0/12345.pfm");
}

TEST(DepthManifest, IsNotWrittenWithANumberThatJsonCannotHold) {
  DepthManifest manifest = SmallManifest();
  manifest.parameters["smoothing"] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(FormatDepthManifest(manifest).status().message(), HasSubstr("'smoothing'"));
  manifest = SmallManifest();
  manifest.cameras[0].z_far = std::numeric_limits<double>::infinity();
  EXPECT_THAT(FormatDepthManifest(manifest).status().message(), HasSubstr("camera 'a'"));
}

TEST(DepthManifest, IsReadStrictly) {
  const TemporaryFolder folder;
  const std::string good = *FormatDepthManifest(SmallManifest());
  const std::string directory = folder.path().string();
  for (const auto& [from, to, words] : {
           std::tuple<std::string, std::string, std::string>{"depthfarm-depth-1", "depthfarm-depth-2", "'format'"},
           {"\"sequence\"", "\"seq\"", "unknown key \"seq\""},
           {"\"firstFrame\": 5", "\"firstFrame\": -5", "'firstFrame' is -5"},
           {"\"algorithmVersion\": 3", "\"algorithmVersion\": 3.5", "'algorithmVersion' is 3.5"},
           {"\"levels\": 250", "\"levels\": [250]", "'levels' is [250]"},
           {"\"levels\": 250", "\"levels\": 250, \"levels\": 251", "twice"},
           {"\"zNear\": 37", "\"zNear\": 237", "camera 'a'"},
           {"depth/a/0005.png", "../0005.png", "within the folder"},
           {"depth/a/0005.png", "/depth/0005.png", "within the folder"},
           {"depth/a/0005.png", "depth/../../x", "within the folder"},
           {std::string(64, 'a'), std::string(64, 'A'), "hexadecimal"},
           {std::string(64, '1'), std::string(63, '1'), "hexadecimal"},
           {"\"name\": \"b\"", "\"name\": \"a\"", "twice"},
           {"\"name\": \"b\"", "\"name\": \"../b\"", "no '/'"},
           {"\"depth/a/0005.png\",", "", "'files' has 1"},
       }) {
    folder.Write("depth.json", Replaced(good, from, to));
    const auto read = ReadDepthManifest(directory);
    EXPECT_EQ(read.status().code(), ErrorCode::kInvalidArgument) << from << " -> " << to;
    EXPECT_THAT(read.status().message(), HasSubstr(words));
    EXPECT_THAT(read.status().message(), HasSubstr(folder.File("depth.json")));
  }
}

TEST(DepthManifest, AFolderWithoutIsNoResult) {
  const TemporaryFolder folder;
  EXPECT_THAT(ReadDepthManifest(folder.path().string()).status().message(),
              AllOf(HasSubstr(folder.path().string()), HasSubstr("depth.json"), HasSubstr("of a finished job")));
  EXPECT_THAT(ReadDepthManifest(folder.File("none")).status().message(),
              AllOf(HasSubstr(folder.File("none")), HasSubstr("no such folder")));
  const std::string file = folder.Write("depth.json", "{}");
  EXPECT_THAT(ReadDepthManifest(file).status().message(), AllOf(HasSubstr(file), HasSubstr("is a file")));
}

}  // namespace
}  // namespace depthfarm
