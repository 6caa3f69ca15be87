#include "worker/media_cli/colour_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "common/media/depth_file.h"
#include "common/media/picture_reader.h"
#include "common/sequence/depth_manifest.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;
using testing_support::TemporaryFolder;

// An output folder of two cameras with one frame of 4 x 2 pixels, all at the same depth 2 but with ranges of their own.
void WriteDepthFolder(const TemporaryFolder& folder) {
  DepthManifest manifest;
  for (const auto& [name, z_near, z_far] : {std::tuple<const char*, double, double>{"a", 1, 4}, {"b", 2, 8}}) {
    DepthManifestCamera entry;
    entry.camera.name = name;
    entry.camera.width = 4;
    entry.camera.height = 2;
    entry.z_near = z_near;
    entry.z_far = z_far;
    entry.files = {{DepthFileName(name, 3), std::string(64, '0')}};
    entry.input_sha256 = {std::string(64, '0')};
    folder.Write(entry.files[0].path, *EncodeDepthPng(DepthMap(4, 2, 2.0F), *DepthCode::Create(z_near, z_far)));
    manifest.cameras.push_back(entry);
  }
  ASSERT_TRUE(WriteDepthManifest(folder.path().string(), manifest).ok());
}

TEST(ColourCommand, EqualDepthIsTheSameColourInEveryCamera) {
  const TemporaryFolder folder;
  WriteDepthFolder(folder);
  std::ostringstream out;
  const Status status = RunColour({.depth_dir = folder.path().string(), .output = folder.File("colour")}, out);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_THAT(out.str(), HasSubstr("wrote 2 pictures"));
  const auto a = ReadPicture({folder.File("colour/a/0003.png"), {}, 4, 2}, 1);
  const auto b = ReadPicture({folder.File("colour/b/0003.png"), {}, 4, 2}, 1);
  ASSERT_TRUE(a.ok()) << a.status().message();
  ASSERT_TRUE(b.ok()) << b.status().message();
  EXPECT_EQ(*a, *b);
  EXPECT_TRUE(ReadPicture({folder.File("colour/contact.png"), {}, 4 + 8 + 4, 2}, 1).ok());
}

TEST(ColourCommand, MissingDepthMapIsNamed) {
  const TemporaryFolder folder;
  WriteDepthFolder(folder);
  std::filesystem::remove(folder.File("depth/b/0003.png"));
  std::ostringstream out;
  const Status status = RunColour({.depth_dir = folder.path().string(), .output = folder.File("colour")}, out);
  EXPECT_THAT(status.message(), HasSubstr("depth/b/0003.png"));
}

TEST(ColourCommand, FolderWithoutManifestIsBadInput) {
  const TemporaryFolder folder;
  std::ostringstream out;
  const Status status = RunColour({.depth_dir = folder.path().string(), .output = folder.File("colour")}, out);
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_FALSE(std::filesystem::exists(folder.File("colour")));
}

}  // namespace
}  // namespace depthfarm
