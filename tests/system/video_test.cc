// Cameras whose frames are in one file: the depth is that of the same pictures in files of their own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/landlock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>

#include "common/media/picture_reader.h"
#include "common/media/raw_picture.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kFrames = 4;
constexpr int kWidth = 160;
constexpr int kHeight = 120;

class VideoRuns : public testing::Test {
 protected:
  // The pictures of a scene as planes: a file each, a file for each camera, and a y4m, which libav reads.
  void SetUp() override {
    std::ifstream(RenderScene(Scene(), {.cameras = 3, .frames = kFrames})) >> sequence_;
    for (const json& camera : sequence_["cameras"]) {
      const std::string name = camera["name"];
      std::ofstream all(Scene() / (name + ".yuv"));
      std::ofstream coded(Scene() / (name + ".y4m"));
      coded << "YUV4MPEG2 W160 H120 F25:1 Ip A1:1 C420mpeg2\n";
      for (int frame = 0; frame < kFrames; ++frame) {
        const fs::path png = Scene() / std::string(camera["images"][static_cast<std::size_t>(frame)]);
        const std::string planes = EncodeLimitedYuv420(ReadPicture({png.string(), {}, kWidth, kHeight}, 1).value());
        std::ofstream(fs::path(png).replace_extension(".yuv")) << planes;
        all << planes;
        coded << "FRAME\n" << planes;
      }
    }
    pictures_ = Edited("pictures.json", [](json& camera) {
      camera["format"] = "yuv420p8";
      for (json& path : camera["images"]) path = fs::path(std::string(path)).replace_extension(".yuv").string();
    });
    raw_ = WithVideos("raw.json", ".yuv", {{"format", "yuv420p8"}});
    coded_ = WithVideos("coded.json", ".y4m", {{"frames", kFrames}});
  }

  [[nodiscard]] fs::path Scene() const { return folder_.path() / "scene"; }
  std::string Edited(const std::string& name, const std::function<void(json&)>& edit) const {
    json sequence = sequence_;
    for (json& camera : sequence["cameras"]) edit(camera);
    std::ofstream(Scene() / name) << sequence;
    return (Scene() / name).string();
  }
  [[nodiscard]] std::string WithVideos(const std::string& name, const std::string& ending, const json& keys) const {
    return Edited(name, [&](json& camera) {
      camera.erase("images");
      camera["video"] = keys;
      camera["video"]["path"] = std::string(camera["name"]) + ending;
    });
  }
  [[nodiscard]] Outcome Run(const std::string& sequence, const std::string& output, const Words& options = {}) const {
    return Depthfarm(Words{"run", sequence, "-o", folder_ / output} + SmallJob() + options);
  }
  // The depth maps that a run makes.
  [[nodiscard]] std::map<std::string, std::string> DepthMaps(const std::string& sequence, const std::string& output,
                                                             const Words& options = {}) const {
    const Outcome run = Run(sequence, output, options);
    EXPECT_EQ(run.exit_code, 0) << run.output;
    std::map<std::string, std::string> files = DepthOf(folder_.path() / output);
    EXPECT_EQ(files.erase("depth.json"), 1U);  // names the inputs
    EXPECT_THAT(files, testing::Not(IsEmpty()));
    return files;
  }

  TemporaryFolder folder_;
  json sequence_;
  std::string pictures_;
  std::string raw_;
  std::string coded_;
};

TEST_F(VideoRuns, GiveTheDepthOfTheSamePicturesInFilesOfTheirOwn) {
  const auto expected = DepthMaps(pictures_, "pictures", {"--workers", "2"});
  EXPECT_THAT(Differences(DepthMaps(raw_, "raw", {"--workers", "2"}), expected), IsEmpty());
  EXPECT_THAT(Differences(DepthMaps(coded_, "coded", {"--workers", "1"}), expected), IsEmpty());
  EXPECT_THAT(Differences(DepthMaps(coded_, "coded2", {"--workers", "2"}), expected), IsEmpty());
  for (const std::string& sequence : {raw_, coded_}) {
    const Outcome evaluate = Depthfarm({"evaluate", sequence, folder_ / "coded"});
    EXPECT_EQ(evaluate.exit_code, 0) << evaluate.output;
  }
  // Colours of points are those of the pictures.
  std::vector<std::string> clouds;
  for (const std::string& sequence : {pictures_, raw_, coded_}) {
    const std::string points = folder_ / ("points" + std::to_string(clouds.size()));
    const Outcome exported =
        Depthfarm({"export", "ply", folder_ / "coded", "-o", points, "--sequence", sequence, "--frames", "3:4"});
    ASSERT_EQ(exported.exit_code, 0) << exported.output;
    EXPECT_THAT(exported.output, HasSubstr("1 frame of 3 cameras"));
    clouds.push_back(ReadFile(fs::path(points) / "0003.ply"));
  }
  EXPECT_TRUE(clouds[1] == clouds[0]);
  EXPECT_TRUE(clouds[2] == clouds[0]);
}

TEST_F(VideoRuns, FramesAreCountedFromTheBeginningOfTheFile) {
  const Words later = {"--frames", "2:4", "--workers", "1"};
  const auto expected = DepthMaps(pictures_, "pictures", later);
  EXPECT_THAT(Differences(DepthMaps(raw_, "raw", later), expected), IsEmpty());
  EXPECT_THAT(Differences(DepthMaps(coded_, "coded", later), expected), IsEmpty());
}

TEST_F(VideoRuns, AVideoThatEndsEarlyFailsTheJobWithItsName) {
  const std::string video = (Scene() / "cam1.y4m").string();
  fs::resize_file(video, fs::file_size(video) / 2);
  const Outcome run = Run(coded_, "out");
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_THAT(run.output, AllOf(HasSubstr("camera 'cam1', frame 0: " + video + ": has 1 of 4 expected frames")));
}

TEST_F(VideoRuns, AFileThatIsNoVideoFailsTheJobWithItsName) {
  std::ofstream(Scene() / "cam2.y4m") << "no video";
  const Outcome run = Run(coded_, "out");
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_THAT(run.output, AllOf(HasSubstr("camera 'cam2', frame 0"), HasSubstr("cam2.y4m: is no video of a kind")));
}

// What libav brings is loaded before a worker gives up the right to open other files.
TEST_F(VideoRuns, AreReadByWorkersThatAreHeldToFolders) {
  if (syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) < 2)
    GTEST_SKIP() << "this kernel has no Landlock";
  const auto expected = DepthMaps(pictures_, "expected");
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  fs::create_directories(folder_ / "out");
  farm.AddWorker({"--read-root", Scene().string(), "--write-root", folder_ / "out"});
  const Outcome done =
      Depthfarm(Words{"submit", coded_, "-o", folder_ / "out/depth", "--wait"} + SmallJob() + farm.Options());
  ASSERT_EQ(done.exit_code, 0) << done.output << farm.Logs();
  std::map<std::string, std::string> files = DepthOf(folder_ / "out/depth");
  files.erase("depth.json");
  EXPECT_THAT(Differences(files, expected), IsEmpty());
}

TEST_F(VideoRuns, AreNotUploaded) {
  const Outcome submit = Depthfarm(
      Words{"submit", raw_, "-o", folder_ / "out", "--upload", "--coordinator", "ipc://" + (folder_ / "none")} +
      SmallJob());
  EXPECT_EQ(submit.exit_code, 2) << submit.output;
  EXPECT_THAT(submit.output, AllOf(HasSubstr("camera 'cam0'"), HasSubstr("cam0.yuv is a video")));
}

TEST_F(VideoRuns, AreImported) {
  const std::string text = (Scene() / "cams.txt").string();
  std::ofstream out(text);
  for (const json& camera : sequence_["cameras"]) {
    out << std::string(camera["name"]) << "\n";
    for (const json& row : camera["K"]) out << row[0] << " " << row[1] << " " << row[2] << "\n";
    out << "0 0\n";
    for (std::size_t r = 0; r < 3; ++r)
      out << camera["R"][r][0] << " " << camera["R"][r][1] << " " << camera["R"][r][2] << " " << camera["t"][r] << "\n";
    out << "\n";
  }
  out.close();
  const auto import = [&](const std::string& name, const Words& options) {
    return Depthfarm(Words{"import", "ftv", text, "-o", (Scene() / name).string(), "--size", "160x120", "--z-near",
                           std::to_string(double(sequence_["zNear"])), "--z-far",
                           std::to_string(double(sequence_["zFar"])), "--pose", "world-to-camera"} +
                     options);
  };
  const std::string raw = (Scene() / "{camera}.yuv").string();
  const std::string coded = (Scene() / "cam{number}.y4m").string();
  const Outcome of_raw = import("imported.json", {"--videos", raw, "--pixel-format", "yuv420p8"});
  EXPECT_EQ(of_raw.exit_code, 0) << of_raw.output;
  EXPECT_THAT(of_raw.output, HasSubstr("3 of them with pictures, 4 frames"));
  const auto expected = DepthMaps(raw_, "raw", {"--frames", "0:1"});
  EXPECT_EQ(DepthMaps((Scene() / "imported.json").string(), "a", {"--frames", "0:1"}).size(), expected.size());
  const Outcome of_coded = import("imported2.json", {"--videos", coded, "--frames", "0:3"});
  EXPECT_EQ(of_coded.exit_code, 0) << of_coded.output;
  EXPECT_THAT(of_coded.output, HasSubstr("3 of them with pictures, 3 frames"));
  EXPECT_EQ(DepthMaps((Scene() / "imported2.json").string(), "b", {"--frames", "0:1"}).size(), expected.size());

  const auto refused = [&](const Words& options, const std::string& reason) {
    const Outcome bad = import("bad.json", options);
    EXPECT_EQ(bad.exit_code, 2) << bad.output;
    EXPECT_THAT(bad.output, HasSubstr(reason));
    EXPECT_FALSE(fs::exists(Scene() / "bad.json"));
  };
  refused({"--videos", coded}, "--videos needs --frames 0:B");
  refused({"--videos", coded, "--frames", "1:3"}, "of videos it begins with 0");
  refused({"--videos", coded, "--images", raw}, "--images and --videos are given");
  refused({"--videos", (Scene() / "cam0.y4m").string(), "--frames", "0:3"}, "same for all cameras");
  refused({"--videos", (Scene() / "{camera}{frame}.y4m").string(), "--frames", "0:3"}, "{frame} is of --images");
  refused({"--videos", coded, "--frames", "0:3", "--range", "full"}, "--range and --matrix are given both");
  refused({"--videos", raw, "--pixel-format", "yuv420p8", "--frames", "0:9"}, "holds 4 frames, --frames asks for 9");
  refused({"--videos", raw, "--pixel-format", "yuv422p16le", "--frames", "0:1"},
          "bytes, expected 76800 for one picture of 160x120 yuv422p16le, or 1 to");
}

}  // namespace
}  // namespace depthfarm::system_test
