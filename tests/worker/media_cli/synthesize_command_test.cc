#include "worker/media_cli/synthesize_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "common/media/picture_reader.h"
#include "common/quality/psnr.h"
#include "tests/worker/media_cli/evaluated_scene.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

std::string Bytes(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  EXPECT_TRUE(stream.good()) << path;
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

class SynthesizeCommandTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = std::make_unique<EvaluatedScene>();
    exact_ = scene_->WriteDepth("exact", [](DepthMap&) {});
    pair_ = scene_->WriteDepth("pair", [](DepthMap&) {}, {"cam1", "cam2"});
  }
  static void TearDownTestSuite() { scene_.reset(); }

  static SynthesizeCommandOptions Options(const std::string& name) {
    SynthesizeCommandOptions options;
    options.sequence = scene_->sequence_file();
    options.depth_dir = exact_;
    options.output = scene_->File(name);
    return options;
  }
  static std::string Run(const SynthesizeCommandOptions& options) {
    std::ostringstream out;
    const Status status = RunSynthesize(options, out);
    EXPECT_TRUE(status.ok()) << status.message();
    return out.str();
  }
  static std::string Failure(const SynthesizeCommandOptions& options) {
    std::ostringstream out;
    const Status status = RunSynthesize(options, out);
    EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
    return status.message();
  }
  // Of a camera's real picture against a PNG.
  static double Psnr(const std::string& png, const std::string& camera, int frame) {
    const auto made = ReadPicture({png, {}, 160, 120}, 1);
    const auto real = ReadPicture({scene_->File(camera + "/" + std::to_string(frame) + ".yuv"),
                                   {PictureFormat::Kind::kYuv400, 8, true, false},
                                   160,
                                   120},
                                  1);
    EXPECT_TRUE(made.ok()) << made.status().message();
    EXPECT_TRUE(real.ok()) << real.status().message();
    return PsnrFullRange(MeasureLumaError(*made, *real));
  }
  static std::size_t Files(const std::string& folder) {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
  }

  static std::unique_ptr<EvaluatedScene> scene_;
  static std::string exact_;
  static std::string pair_;
};

std::unique_ptr<EvaluatedScene> SynthesizeCommandTest::scene_;
std::string SynthesizeCommandTest::exact_;
std::string SynthesizeCommandTest::pair_;

TEST_F(SynthesizeCommandTest, AViewIsMadeFromItsNeighboursInEveryFrame) {
  SynthesizeCommandOptions options = Options("view");
  options.view = "cam1";
  EXPECT_THAT(Run(options), HasSubstr("2 pictures of 160x120 from cam"));
  EXPECT_EQ(Files(options.output), 2U);
  const double first = Psnr(options.output + "/0000.png", "cam1", 0);
  EXPECT_GT(first, 27);
  EXPECT_LT(first, 45);  // not the camera's own picture
  EXPECT_GT(Psnr(options.output + "/0001.png", "cam1", 1), 27);
}

TEST_F(SynthesizeCommandTest, NamedSourcesAndFrames) {
  SynthesizeCommandOptions options = Options("named");
  options.view = "cam1";
  options.from = {"cam3"};
  options.first_frame = 1;
  EXPECT_THAT(Run(options), HasSubstr("1 picture of 160x120 from cam3 ->"));
  EXPECT_EQ(Files(options.output), 1U);
  EXPECT_TRUE(fs::exists(options.output + "/0001.png"));
}

TEST_F(SynthesizeCommandTest, APathGoesFromRealViewToRealView) {
  SynthesizeCommandOptions options = Options("path");
  options.path = {"cam0", "cam1", "cam3"};
  options.steps = 5;
  options.end_frame = 1;
  Run(options);
  EXPECT_EQ(Files(options.output), 5U);
  // The stops are the cameras, and the cameras are their own best sources.
  EXPECT_GT(Psnr(options.output + "/0000.png", "cam0", 0), 45);
  EXPECT_GT(Psnr(options.output + "/0002.png", "cam1", 0), 45);
  EXPECT_GT(Psnr(options.output + "/0004.png", "cam3", 0), 45);
  EXPECT_LT(Psnr(options.output + "/0001.png", "cam0", 0), 40);
}

TEST_F(SynthesizeCommandTest, ThePicturesOfAPathShowTheFramesInTurn) {
  SynthesizeCommandOptions options = Options("frames");
  options.path = {"cam1", "cam1"};
  options.steps = 3;
  Run(options);
  EXPECT_GT(Psnr(options.output + "/0000.png", "cam1", 0), 45);
  EXPECT_GT(Psnr(options.output + "/0001.png", "cam1", 1), 45);
  EXPECT_EQ(Bytes(options.output + "/0001.png"), Bytes(options.output + "/0002.png"));  // the last frame stays
}

TEST_F(SynthesizeCommandTest, TheSameBytesOnAnyNumberOfThreads) {
  SynthesizeCommandOptions options = Options("one.yuv");
  options.path = {"cam0", "cam3"};
  options.steps = 7;
  options.threads = 1;
  Run(options);
  const std::string one = Bytes(options.output);
  EXPECT_EQ(one.size(), 7U * 160 * 120 * 3 / 2);
  options.output = scene_->File("deep/three.yuv");  // the folder is made
  options.threads = 3;
  Run(options);
  EXPECT_EQ(Bytes(options.output), one);
  EXPECT_EQ(Files(scene_->File("deep")), 1U);  // nothing half-written is left
}

TEST_F(SynthesizeCommandTest, AVideoIsTheSameBytesOnAnyNumberOfThreads) {
  SynthesizeCommandOptions options = Options("video/one.mp4");
  options.path = {"cam0", "cam3"};
  options.steps = 7;
  options.threads = 1;
  Run(options);
  const std::string one = Bytes(options.output);
  EXPECT_EQ(one.substr(4, 4), "ftyp");
  options.output = scene_->File("video/three.mp4");
  options.threads = 3;
  Run(options);
  EXPECT_EQ(Bytes(options.output), one);
  EXPECT_EQ(Files(scene_->File("video")), 2U);
}

TEST_F(SynthesizeCommandTest, InterruptedItLeavesNothingHalfWritten) {
  for (const char* name : {"cut/short.yuv", "cut/short.mp4"}) {
    SynthesizeCommandOptions options = Options(name);
    options.path = {"cam0", "cam3"};
    options.steps = 4;
    options.threads = 1;
    int asked = 0;
    options.interrupted = [&] { return ++asked > 2; };
    std::ostringstream progress;
    options.progress = &progress;
    std::ostringstream out;
    EXPECT_EQ(RunSynthesize(options, out).code(), ErrorCode::kCancelled);
    EXPECT_THAT(progress.str(), testing::EndsWith(" \r"));  // the line is erased: a message begins its own
    EXPECT_EQ(Files(scene_->File("cut")), 0U);
  }
}

TEST_F(SynthesizeCommandTest, TellsOfOlderPicturesAndShowsProgress) {
  SynthesizeCommandOptions options = Options("twice");
  options.path = {"cam0", "cam3"};
  options.steps = 3;
  std::ostringstream progress;
  options.progress = &progress;
  EXPECT_THAT(Run(options), testing::Not(HasSubstr("older")));
  EXPECT_THAT(progress.str(), HasSubstr("picture 1 of 3"));
  options.steps = 2;
  EXPECT_THAT(Run(options), HasSubstr("also holds 1 older pictures"));
}

TEST_F(SynthesizeCommandTest, AVideoOfAnOddSizeLosesAColumn) {
  const std::string file = scene_->File("odd.json");
  std::ofstream(file) << R"({"name": "odd", "width": 97, "height": 64, "K": [[110, 0, 48], [0, 110, 31.5], [0, 0, 1]],
    "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [0, 0, 0]})";
  SynthesizeCommandOptions options = Options("odd.mp4");
  options.camera_file = file;
  Run(options);
  EXPECT_GT(Bytes(options.output).size(), 500U);
}

TEST_F(SynthesizeCommandTest, AnyVirtualCamera) {
  const std::string file = scene_->File("virtual.json");
  std::ofstream(file)
      << R"({"name": "above", "width": 96, "height": 64, "K": [[110, 0, 47.5], [0, 110, 31.5], [0, 0, 1]],
    "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [0, 0.1, 0]})";
  SynthesizeCommandOptions options = Options("above");
  options.camera_file = file;
  EXPECT_THAT(Run(options), HasSubstr("2 pictures of 96x64"));
  EXPECT_EQ(Files(options.output), 2U);
}

TEST_F(SynthesizeCommandTest, SaysWhatIsWrong) {
  SynthesizeCommandOptions options = Options("wrong");
  EXPECT_THAT(Failure(options), HasSubstr("one of --view, --camera and --path"));
  options.view = "cam9";
  EXPECT_THAT(Failure(options), HasSubstr("no camera 'cam9'"));
  options.view = "cam1";
  options.path = {"cam0", "cam1"};
  EXPECT_THAT(Failure(options), HasSubstr("one of --view, --camera and --path"));
  options.path.clear();
  options.steps = 3;
  EXPECT_THAT(Failure(options), HasSubstr("--steps goes with --path"));
  options.steps = 0;
  options.from = {"cam1"};
  EXPECT_THAT(Failure(options), HasSubstr("both --view and one of --from"));
  options.from = {"cam2", "cam2"};
  EXPECT_THAT(Failure(options), HasSubstr("twice"));
  options.from = {"cam2"};
  options.end_frame = 3;
  EXPECT_THAT(Failure(options), HasSubstr("has depth of 0:2"));
  options.end_frame = -1;
  options.sources = 0;
  EXPECT_THAT(Failure(options), HasSubstr("--sources is 0"));
  options.sources = 2;
  options.threads = -1;
  EXPECT_THAT(Failure(options), HasSubstr("--threads is -1"));
  options.threads = 1;
  options.frames_per_second = 0;
  EXPECT_THAT(Failure(options), HasSubstr("--fps is 0"));
  options.frames_per_second = 25;
  options.output = scene_->File("wrong.mkv");
  EXPECT_THAT(Failure(options), HasSubstr("expected FILE.mp4, FILE.yuv or a folder"));
  options.output = scene_->File("wrong");
  options.depth_dir = pair_;
  options.from = {"cam0"};
  EXPECT_THAT(Failure(options), HasSubstr("no depth of camera 'cam0'"));
  options.view.clear();
  options.from.clear();
  options.path = {"cam1"};
  EXPECT_THAT(Failure(options), HasSubstr("at least two cameras"));
  EXPECT_FALSE(fs::exists(options.output));
}

TEST_F(SynthesizeCommandTest, ACameraInTheSamePlaceThatLooksAwayIsNoSource) {
  std::ifstream stream(scene_->sequence_file());
  nlohmann::json camera = nlohmann::json::parse(stream)["cameras"][1];
  for (const char* key : {"format", "range", "images"}) camera.erase(key);
  for (const int row : {0, 2}) {  // half a turn about the vertical: the centre -R^T t stays if t turns too
    for (nlohmann::json& value : camera["R"][row]) value = -value.get<double>();
    camera["t"][row] = -camera["t"][row].get<double>();
  }
  const std::string file = scene_->File("back.json");
  std::ofstream(file) << camera;
  SynthesizeCommandOptions options = Options("back");
  options.camera_file = file;
  EXPECT_THAT(Failure(options), HasSubstr("no camera with depth sees what 'cam1' does"));
}

TEST_F(SynthesizeCommandTest, ACameraThatLooksAwayNeedsSources) {
  const std::string file = scene_->File("away.json");
  std::ofstream(file)
      << R"({"name": "away", "width": 96, "height": 64, "K": [[110, 0, 47.5], [0, 110, 31.5], [0, 0, 1]],
    "R": [[-1, 0, 0], [0, 1, 0], [0, 0, -1]], "t": [0, 0, 0]})";
  SynthesizeCommandOptions options = Options("away");
  options.camera_file = file;
  EXPECT_THAT(Failure(options), HasSubstr("no camera with depth sees what 'away' does"));
}

}  // namespace
}  // namespace depthfarm
