#include "worker/media_cli/scene_command.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/geometry/camera.h"
#include "common/scene/array.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

std::string Contents(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::map<std::string, std::string> AllFiles(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = Contents(entry.path());
  }
  return files;
}

class RunSceneTest : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] SceneCommandOptions Small(const std::string& name) const {
    return {.output = (folder_ / name).string(), .cameras = 3, .width = 64, .height = 48, .frames = 2};
  }
  // One folder per test: they run at the same time.
  const fs::path folder_ = fs::path(testing::TempDir()) /
                           (std::string("scene_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(RunSceneTest, WritesAllThatSequenceJsonNames) {
  const SceneCommandOptions options = Small("a");
  const Status status = RunScene(options);
  ASSERT_TRUE(status.ok()) << status.message();
  const fs::path folder = options.output;
  const auto json = nlohmann::json::parse(Contents(folder / "sequence.json"));
  EXPECT_EQ(json.at("name"), "arc-1");
  EXPECT_EQ(json.at("frameRate"), 25);
  EXPECT_GT(json.at("zNear").get<double>(), 0);
  EXPECT_GT(json.at("zFar").get<double>(), json.at("zNear").get<double>());
  std::size_t named = 1;
  ASSERT_EQ(json.at("cameras").size(), 3u);
  for (const auto& camera : json.at("cameras")) {
    ASSERT_EQ(camera.at("images").size(), 2u);
    for (const auto& image : camera.at("images")) {
      EXPECT_TRUE(fs::is_regular_file(folder / image.get<std::string>())) << image;
      ++named;
    }
    EXPECT_FALSE(camera.contains("format"));
  }
  const auto& truth = json.at("groundTruth");
  EXPECT_EQ(truth.at("encoding"), "z-pfm");
  EXPECT_EQ(truth.at("zones").at("panel"), 6);
  ASSERT_EQ(truth.at("views").size(), 3u);
  EXPECT_EQ(truth.at("views")[2].at("view"), "cam2");
  EXPECT_EQ(truth.at("views")[2].at("depth")[1], "truth/cam2/0001.pfm");
  for (const auto& view : truth.at("views")) {
    for (const char* kind : {"depth", "zones"}) {
      for (const auto& file : view.at(kind)) {
        EXPECT_TRUE(fs::is_regular_file(folder / file.get<std::string>())) << file;
        ++named;
      }
    }
  }
  EXPECT_EQ(AllFiles(folder).size(), named);  // nothing half-written stays
}

TEST_F(RunSceneTest, CamerasKeepFullPrecision) {
  SceneCommandOptions options = Small("a");
  options.kind = "irregular";
  ASSERT_TRUE(RunScene(options).ok());
  const auto json = nlohmann::json::parse(Contents(fs::path(options.output) / "sequence.json"));
  const std::vector<Camera> cameras = MakeArray(ArrayKind::kIrregular, 3, 64, 48, 1);
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const auto& written = json.at("cameras")[i];
    for (int row = 0; row < 3; ++row) {
      EXPECT_EQ(written.at("t")[row].get<double>(), cameras[i].cam_from_world_translation[row]);
      for (int column = 0; column < 3; ++column) {
        EXPECT_EQ(written.at("R")[row][column].get<double>(), cameras[i].cam_from_world_rotation(row, column));
        EXPECT_EQ(written.at("K")[row][column].get<double>(), cameras[i].intrinsics(row, column));
      }
    }
  }
}

TEST_F(RunSceneTest, EqualOptionsGiveEqualBytesAndLongerSequencesBeginAlike) {
  ASSERT_TRUE(RunScene(Small("a")).ok());
  ASSERT_TRUE(RunScene(Small("b")).ok());
  const auto a = AllFiles(folder_ / "a");
  EXPECT_EQ(a, AllFiles(folder_ / "b"));
  SceneCommandOptions longer = Small("c");
  longer.frames = 3;
  ASSERT_TRUE(RunScene(longer).ok());
  const auto c = AllFiles(folder_ / "c");
  for (const auto& [name, bytes] : a) {
    if (name == "sequence.json") continue;
    EXPECT_EQ(bytes, c.at(name)) << name;
  }
}

TEST_F(RunSceneTest, RawPicturesSayTheirFormatAndHaveItsSize) {
  for (const auto& [format, bytes_per_sample] :
       {std::pair<std::string, std::size_t>{"yuv420p8", 1}, {"yuv420p10le", 2}}) {
    SceneCommandOptions options = Small(format);
    options.format = format;
    ASSERT_TRUE(RunScene(options).ok());
    const auto json = nlohmann::json::parse(Contents(fs::path(options.output) / "sequence.json"));
    const auto& camera = json.at("cameras")[1];
    EXPECT_EQ(camera.at("format"), format);
    EXPECT_EQ(camera.at("range"), "full");
    EXPECT_EQ(camera.at("matrix"), "bt601");
    const fs::path picture = fs::path(options.output) / camera.at("images")[0].get<std::string>();
    EXPECT_EQ(fs::file_size(picture), bytes_per_sample * 64 * 48 * 3 / 2);
  }
}

TEST_F(RunSceneTest, AFailedRunLeavesNoSequenceJson) {
  const SceneCommandOptions options = Small("a");
  ASSERT_TRUE(RunScene(options).ok());
  // A folder where a depth file must go: the old sequence.json no longer vouches for the pictures.
  fs::remove(fs::path(options.output) / "truth/cam2/0001.pfm");
  fs::create_directories(fs::path(options.output) / "truth/cam2/0001.pfm/in_the_way");
  const Status status = RunScene(options);
  EXPECT_EQ(status.code(), ErrorCode::kUnavailable);
  EXPECT_NE(status.message().find("0001.pfm"), std::string::npos);
  EXPECT_FALSE(fs::exists(fs::path(options.output) / "sequence.json"));
}

TEST_F(RunSceneTest, OptionsOutOfBoundsAreNamedWithTheBound) {
  const auto refused = [&](auto change, const std::string& word) {
    SceneCommandOptions options = Small("never");
    change(options);
    const Status status = RunScene(options);
    EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument) << word;
    EXPECT_NE(status.message().find(word), std::string::npos) << status.message();
  };
  refused([](SceneCommandOptions& o) { o.kind = "ring"; }, "'ring'");
  refused([](SceneCommandOptions& o) { o.output = ""; }, "output");
  refused([](SceneCommandOptions& o) { o.cameras = 1; }, "cameras is 1, expected 2 to 256");
  refused([](SceneCommandOptions& o) { o.cameras = 257; }, "cameras is 257");
  refused([](SceneCommandOptions& o) { o.width = 15; }, "width is 15, expected 16 to 8192");
  refused([](SceneCommandOptions& o) { o.height = 8193; }, "height is 8193");
  refused([](SceneCommandOptions& o) { o.frames = 0; }, "frames is 0");
  refused([](SceneCommandOptions& o) { o.noise = -1; }, "noise is -1");
  refused([](SceneCommandOptions& o) { o.noise = std::numeric_limits<double>::quiet_NaN(); }, "noise is nan");
  refused([](SceneCommandOptions& o) { o.gain = 0.3; }, "gain is 0.3");
  refused([](SceneCommandOptions& o) { o.format = "jpeg"; }, "'jpeg'");
  EXPECT_FALSE(fs::exists(folder_ / "never"));
}

}  // namespace
}  // namespace depthfarm
