#include "coordinator/library/depthfarm.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <stdexcept>

#include "tests/support/temporary_folder.h"

namespace depthfarm::library {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kWidth = 96;
constexpr int kHeight = 72;
constexpr double kFocal = 100;
constexpr double kDepth = 4;

// Three cameras in a row look at a textured wall; what each sees is computed, so that its depth is known.
class Wall {
 public:
  explicit Wall(int frames = 1) {
    for (int c = 0; c < 3; ++c) {
      scene.cameras.push_back({.name = "cam" + std::to_string(c),
                               .width = kWidth,
                               .height = kHeight,
                               .K = {kFocal, 0, (kWidth - 1) / 2.0, 0, kFocal, (kHeight - 1) / 2.0, 0, 0, 1},
                               .t = {-0.12 * (c - 1), 0, 0}});
    }
    scene.z_near = 2;
    scene.z_far = 8;
    for (int f = 0; f < frames; ++f) {
      scene.frames.emplace_back();
      for (const Camera& camera : scene.cameras) {
        samples_.push_back(See(camera));
        scene.frames.back().push_back({.samples = samples_.back().data()});
      }
    }
  }

  Scene scene;

 private:
  static std::vector<std::uint8_t> See(const Camera& camera) {
    std::vector<std::uint8_t> rgb;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double wall_x = (x - camera.K[2]) / kFocal * kDepth - camera.t[0];
        const double wall_y = (y - camera.K[5]) / kFocal * kDepth;
        for (int channel = 0; channel < 3; ++channel) {
          const double value =
              std::sin(9 * wall_x + channel) * std::cos(7 * wall_y - channel) + std::sin(23 * wall_x * wall_y);
          rgb.push_back(static_cast<std::uint8_t>(128 + 60 * value));
        }
      }
    }
    return rgb;
  }

  std::vector<std::vector<std::uint8_t>> samples_;
};

const std::map<std::string, std::string> kSmall = {{"segments", "300"}, {"levels", "24"}};

TEST(EstimateDepth, FindsAWall) {
  const Wall wall(2);
  const Result result = EstimateDepth(wall.scene, {.estimation = kSmall, .threads = 2, .scratch = {}, .progress = {}});
  ASSERT_EQ(result.code, Code::kDone) << result.message;
  ASSERT_THAT(result.depth, SizeIs(2));
  for (const std::vector<DepthMap>& frame : result.depth) {
    ASSERT_THAT(frame, SizeIs(3));
    for (const DepthMap& map : frame) {
      EXPECT_EQ(map.width, kWidth);
      EXPECT_EQ(map.height, kHeight);
      ASSERT_THAT(map.z, SizeIs(kWidth * kHeight));
      EXPECT_THAT(map.confidence, IsEmpty());
      // Of the middle, which all cameras see.
      int right = 0;
      for (int y = 12; y < kHeight - 12; ++y) {
        for (int x = 16; x < kWidth - 16; ++x) {
          right += std::abs(map.z[static_cast<std::size_t>(y * kWidth + x)] - kDepth) < 0.1 * kDepth ? 1 : 0;
        }
      }
      EXPECT_GT(right, 0.95 * (kHeight - 24) * (kWidth - 32));
    }
  }
}

TEST(EstimateDepth, IsTheSameOnAnyNumberOfThreads) {
  const Wall wall(2);
  const auto estimate = [&](int threads) {
    return EstimateDepth(wall.scene, {.estimation = kSmall, .threads = threads, .scratch = {}, .progress = {}});
  };
  const Result one = estimate(1);
  const Result four = estimate(4);
  ASSERT_EQ(one.code, Code::kDone) << one.message;
  ASSERT_EQ(four.code, Code::kDone) << four.message;
  for (std::size_t f = 0; f < 2; ++f) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(one.depth[f][c].z, four.depth[f][c].z);
  }
}

TEST(EstimateDepth, TakesOptionsAndTellsConfidence) {
  const Wall wall;
  std::map<std::string, std::string> options = kSmall;
  options["confidence"] = "on";
  options["views"] = "cam0,cam1";
  options["preset"] = "fast";
  const Result result = EstimateDepth(wall.scene, {.estimation = options, .threads = 2, .scratch = {}, .progress = {}});
  ASSERT_EQ(result.code, Code::kDone) << result.message;
  EXPECT_THAT(result.depth[0][1].confidence, SizeIs(kWidth * kHeight));
  EXPECT_EQ(result.depth[0][2].width, 0) << "it was not asked for";
}

TEST(EstimateDepth, TellsProgressAndCanBeCancelled) {
  const Wall wall(6);
  const testing_support::TemporaryFolder folder;
  double done = 0;
  Options options{.estimation = kSmall, .threads = 1, .scratch = folder.path().string(), .progress = {}};
  options.progress = [&](const Progress& progress) {
    EXPECT_EQ(progress.frames, 6);
    EXPECT_GE(progress.done, done);
    done = progress.done;
    return true;
  };
  ASSERT_EQ(EstimateDepth(wall.scene, options).code, Code::kDone);
  EXPECT_EQ(done, 1);

  options.progress = [](const Progress&) { return false; };
  const Wall one_frame(1);  // over before an interval is
  const Result cancelled = EstimateDepth(one_frame.scene, options);
  EXPECT_EQ(cancelled.code, Code::kCancelled);
  EXPECT_THAT(cancelled.depth, IsEmpty());
  options.progress = [](const Progress&) -> bool { throw std::runtime_error("from outside"); };
  EXPECT_THROW((void)EstimateDepth(wall.scene, options), std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "nothing may be left";
}

TEST(EstimateDepth, SaysWhatIsWrong) {
  struct Row {
    std::function<void(Scene&, Options&)> change;
    const char* expected;
  };
  const std::vector<Row> rows = {
      {[](Scene& s, Options&) { s.frames.clear(); }, "no frames"},
      {[](Scene& s, Options&) { s.frames[0].pop_back(); }, "frame 0 has 2 pictures, the scene 3 cameras"},
      {[](Scene& s, Options&) { s.frames[0][1].samples = nullptr; }, "camera 'cam1', frame 0"},
      {[](Scene& s, Options&) { s.frames[0][1].channels = 2; }, "camera 'cam1', frame 0: a picture has 2 channels"},
      {[](Scene& s, Options&) { s.frames[0][1].bytes_per_sample = 4; }, "of 4 bytes"},
      {[](Scene& s, Options&) { s.frames[0][1].row_bytes = 3; }, "rows of a picture are 3 bytes apart"},
      {[](Scene& s, Options&) { s.cameras[1].width = 0; }, "cam1"},
      {[](Scene& s, Options&) { s.cameras[1].name = "cam0"; }, "cam0"},
      {[](Scene& s, Options&) { s.cameras[1].name = "a/b"; }, "a/b"},
      {[](Scene& s, Options&) { s.cameras[1].K[0] = std::numeric_limits<double>::quiet_NaN(); }, "cam1"},
      {[](Scene& s, Options&) { s.cameras[1].R[0] = 5; }, "cam1"},
      {[](Scene& s, Options&) { s.z_near = 9; }, "zNear"},
      {[](Scene& s, Options&) { s.reference = "nobody"; }, "nobody"},
      {[](Scene&, Options& o) { o.estimation["levles"] = "3"; }, "there is no option 'levles'"},
      {[](Scene&, Options& o) { o.estimation["levels"] = "many"; }, "levels"},
      {[](Scene&, Options& o) { o.estimation["preset"] = "finest"; }, "finest"},
      {[](Scene&, Options& o) { o.threads = -1; }, "threads are -1"},
  };
  for (const Row& row : rows) {
    Wall wall;
    Options options{.estimation = kSmall, .threads = 1, .scratch = {}, .progress = {}};
    row.change(wall.scene, options);
    const Result result = EstimateDepth(wall.scene, options);
    EXPECT_EQ(result.code, Code::kBadInput) << row.expected << ": " << result.message;
    EXPECT_THAT(result.message, HasSubstr(row.expected));
  }
  Wall wall;
  const Result result =
      EstimateDepth(wall.scene, {.estimation = {}, .threads = 1, .scratch = "/nonexistent", .progress = {}});
  EXPECT_EQ(result.code, Code::kFailed);
  EXPECT_THAT(result.message, HasSubstr("/nonexistent"));
}

TEST(EstimateDepth, SixteenBitsAndPaddedRowsAreTheSamePicture) {
  const Wall wall;
  Scene scene = wall.scene;
  std::vector<std::vector<std::uint16_t>> wide(3);
  for (std::size_t c = 0; c < 3; ++c) {
    const auto* samples = static_cast<const std::uint8_t*>(scene.frames[0][c].samples);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < 3 * kWidth; ++x)
        wide[c].push_back(static_cast<std::uint16_t>(257 * samples[3 * kWidth * y + x]));
      wide[c].insert(wide[c].end(), 10, 77);
    }
    scene.frames[0][c] = {
        .samples = wide[c].data(), .channels = 3, .bytes_per_sample = 2, .row_bytes = 2 * (3 * kWidth + 10)};
  }
  const Options options{.estimation = kSmall, .threads = 2, .scratch = {}, .progress = {}};
  const Result eight = EstimateDepth(wall.scene, options);
  const Result sixteen = EstimateDepth(scene, options);
  ASSERT_EQ(sixteen.code, Code::kDone) << sixteen.message;
  ASSERT_EQ(eight.code, Code::kDone) << eight.message;
  int differ = 0;
  for (std::size_t i = 0; i < eight.depth[0][1].z.size(); ++i) {
    differ += std::abs(eight.depth[0][1].z[i] - sixteen.depth[0][1].z[i]) > 0.05F * static_cast<float>(kDepth) ? 1 : 0;
  }
  EXPECT_LT(differ, kWidth * kHeight / 50);
}

}  // namespace
}  // namespace depthfarm::library
