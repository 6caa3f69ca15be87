#include "common/job/estimation_params.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

namespace depthfarm {
namespace {

using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Setting {
  std::function<void(EstimationParams&)> set;
  std::string message;  // how it begins
};

TEST(EstimationParams, RefusesValuesOutsideTheirBoundsByName) {
  const Setting bad[] = {
      {[](EstimationParams& p) { p.segments = -1; }, "segments is -1"},
      {[](EstimationParams& p) { p.segments = 4'000'001; }, "segments is 4000001, expected 1 to 4000000"},
      {[](EstimationParams& p) { p.levels = -1; }, "levels is -1"},
      {[](EstimationParams& p) { p.levels = 1; }, "levels is 1, expected 2 to 65534"},
      {[](EstimationParams& p) { p.levels = 65535; }, "levels is 65535"},
      {[](EstimationParams& p) { p.z_near = -1; }, "z-near is -1"},
      {[](EstimationParams& p) { p.z_near = kNaN; }, "z-near is nan"},
      {[](EstimationParams& p) { p.z_near = kInfinity; }, "z-near is inf"},
      {[](EstimationParams& p) { p.z_far = -2; }, "z-far is -2"},
      {[](EstimationParams& p) { p.z_near = p.z_far = 3; }, "z-near is 3, expected less than z-far"},
      {[](EstimationParams& p) { p.z_near = 4, p.z_far = 3; }, "z-near is 4, expected less than z-far"},
      {[](EstimationParams& p) { p.smoothing = -0.1; }, "smoothing is -0.1, expected 0 to 100"},
      {[](EstimationParams& p) { p.smoothing = 100.5; }, "smoothing is 100.5"},
      {[](EstimationParams& p) { p.smoothing = kNaN; }, "smoothing is nan"},
      {[](EstimationParams& p) { p.matching_window = 0; }, "matching-window is 0"},
      {[](EstimationParams& p) { p.matching_window = -3; }, "matching-window is -3"},
      {[](EstimationParams& p) { p.matching_window = 4; }, "matching-window is 4, expected an odd number"},
      {[](EstimationParams& p) { p.matching_window = 17; }, "matching-window is 17"},
      {[](EstimationParams& p) { p.matching_offset = 0; }, "matching-offset is 0"},
      {[](EstimationParams& p) { p.matching_offset = 766; }, "matching-offset is 766, expected > 0, at most 765"},
      {[](EstimationParams& p) { p.matching_offset = kNaN; }, "matching-offset is nan"},
      {[](EstimationParams& p) { p.uniqueness = -1; }, "uniqueness is -1"},
      {[](EstimationParams& p) { p.uniqueness = 100; }, "uniqueness is 100, expected 1 to 99 %, or 0"},
      {[](EstimationParams& p) { p.snic_compactness = 0; }, "snic-compactness is 0"},
      {[](EstimationParams& p) { p.snic_compactness = 1001; }, "snic-compactness is 1001"},
      {[](EstimationParams& p) { p.snic_compactness = kNaN; }, "snic-compactness is nan"},
      {[](EstimationParams& p) { p.gop = -1; }, "gop is -1"},
      {[](EstimationParams& p) { p.gop = 1'000'001; }, "gop is 1000001"},
      {[](EstimationParams& p) { p.p_threshold = -1; }, "p-threshold is -1"},
      {[](EstimationParams& p) { p.p_threshold = 256; }, "p-threshold is 256"},
      {[](EstimationParams& p) { p.i_threshold = -1; }, "i-threshold is -1"},
      {[](EstimationParams& p) { p.i_threshold = 256; }, "i-threshold is 256"},
      {[](EstimationParams& p) { p.level_blocks = -1; }, "level-blocks is -1"},
      {[](EstimationParams& p) { p.level_blocks = 4097; }, "level-blocks is 4097"},
      {[](EstimationParams& p) { p.levels = 7, p.level_blocks = 8; }, "level-blocks is 8, expected at most"},
      {[](EstimationParams& p) { p.max_sweeps = -1; }, "sweeps is -1"},
      {[](EstimationParams& p) { p.max_sweeps = 1001; }, "sweeps is 1001"},
      {[](EstimationParams& p) { p.max_sweeps = 2; }, "sweeps is 2, expected 1 with the sparse search"},
      {[](EstimationParams& p) { p.max_sweeps = 0; }, "sweeps is auto, expected 1 with the sparse search"},
      {[](EstimationParams& p) { p.choice_rounds = -1; }, "choice-rounds is -1"},
      {[](EstimationParams& p) { p.choice_rounds = 101; }, "choice-rounds is 101"},
      {[](EstimationParams& p) { p.compared = 0; }, "compared is 0"},
      {[](EstimationParams& p) { p.compared = 5; }, "compared is 5, expected 1 to 4"},
      {[](EstimationParams& p) { p.segment_pixels = 0; }, "segment-pixels is 0"},
      {[](EstimationParams& p) { p.segment_pixels = 10001; }, "segment-pixels is 10001"},
      {[](EstimationParams& p) { p.neighbours = 0; }, "neighbors is 0"},
      {[](EstimationParams& p) { p.neighbours = 17; }, "neighbors is 17"},
      {[](EstimationParams& p) { p.refine_rounds = -1; }, "refine is -1"},
      {[](EstimationParams& p) { p.refine_rounds = 101; }, "refine is 101, expected 1 to 100 rounds, or 0"},
      {[](EstimationParams& p) { p.holes = -0.1; }, "holes is -0.1, expected 0 to less than 1"},
      {[](EstimationParams& p) { p.holes = 1; }, "holes is 1"},
      {[](EstimationParams& p) { p.holes = std::nan(""); }, "holes is nan"},
      {[](EstimationParams& p) {
         p.holes = 0.5;
         p.refine_rounds = 0;
       },
       "holes needs refined depth"},
      {[](EstimationParams& p) {
         p.confidence = true;
         p.refine_rounds = 0;
       },
       "confidence needs refined depth: leave out --refine 0 (--preset paper)"},
      {[](EstimationParams& p) { p.downscale = 0; }, "downscale is 0"},
      {[](EstimationParams& p) { p.downscale = 3; }, "downscale is 3, expected 1, 2 or 4"},
      {[](EstimationParams& p) { p.downscale = 8; }, "downscale is 8"},
      {[](EstimationParams& p) { p.first_frame = -1; }, "frames: first is -1"},
      {[](EstimationParams& p) { p.end_frame = 0; }, "frames: end is 0"},
      {[](EstimationParams& p) { p.end_frame = -2; }, "frames: end is -2"},
      {[](EstimationParams& p) { p.first_frame = p.end_frame = 5; }, "frames: end is 5, expected more than the first"},
      {[](EstimationParams& p) {
         p.views = {"a", "b", "a"};
       },
       "views names camera 'a' twice"},
  };
  for (const Setting& setting : bad) {
    EstimationParams params;
    setting.set(params);
    const Status status = params.Validate();
    EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument) << setting.message;
    EXPECT_EQ(status.message().substr(0, setting.message.size()), setting.message);
  }
}

TEST(EstimationParams, AcceptsTheBoundsThemselves) {
  const Setting good[] = {
      {[](EstimationParams& p) { p.segments = 4'000'000; }, "segments"},
      {[](EstimationParams& p) { p.levels = 2; }, "fewest levels"},
      {[](EstimationParams& p) { p.levels = 65534; }, "most levels"},
      {[](EstimationParams& p) { p.z_near = 3; }, "z-near alone"},
      {[](EstimationParams& p) { p.z_far = 3; }, "z-far alone"},
      {[](EstimationParams& p) { p.smoothing = 0; }, "no smoothing"},
      {[](EstimationParams& p) { p.smoothing = 100; }, "most smoothing"},
      {[](EstimationParams& p) { p.matching_window = 1; }, "smallest window"},
      {[](EstimationParams& p) { p.choice_rounds = 0; }, "no choice of pixels"},
      {[](EstimationParams& p) { p.compared = 1; }, "one compared view"},
      {[](EstimationParams& p) { p.segment_pixels = 10000; }, "the largest segments"},
      {[](EstimationParams& p) { p.matching_window = 15; }, "largest window"},
      {[](EstimationParams& p) { p.matching_offset = 765; }, "matching-offset"},
      {[](EstimationParams& p) { p.uniqueness = 0; }, "every match in full"},
      {[](EstimationParams& p) { p.uniqueness = 99; }, "the highest percentile"},
      {[](EstimationParams& p) { p.snic_compactness = 1000; }, "snic-compactness"},
      {[](EstimationParams& p) { p.gop = 1; }, "I frames only"},
      {[](EstimationParams& p) { p.p_threshold = p.i_threshold = 0; }, "lowest thresholds"},
      {[](EstimationParams& p) { p.p_threshold = p.i_threshold = 255; }, "highest thresholds"},
      {[](EstimationParams& p) { p.levels = p.level_blocks = 8; }, "one level a block"},
      {[](EstimationParams& p) { p.level_blocks = 4096; }, "level-blocks of unknown levels"},
      {[](EstimationParams& p) { p.search = Search::kFull, p.max_sweeps = 0; }, "sweeps until nothing changes"},
      {[](EstimationParams& p) { p.neighbours = 16; }, "neighbors"},
      {[](EstimationParams& p) { p.refine_rounds = 0; }, "no refinement"},
      {[](EstimationParams& p) { p.holes = 0.999; }, "only what is nearly certain"},
      {[](EstimationParams& p) { p.downscale = 4; }, "downscale"},
      {[](EstimationParams& p) { p.first_frame = 5, p.end_frame = 6; }, "one frame"},
  };
  for (const Setting& setting : good) {
    EstimationParams params;
    setting.set(params);
    EXPECT_TRUE(params.Validate().ok()) << setting.message << ": " << params.Validate().message();
  }
}

TEST(EstimationParams, DefaultsArePaperNumbers) {
  const EstimationParams params;
  EXPECT_EQ(params.matching_window, 3);  // III-C
  EXPECT_EQ(params.matching_offset, 30);
  EXPECT_EQ(params.neighbours, 2);
  EXPECT_EQ(params.p_threshold, 3);  // III-E
  EXPECT_EQ(params.i_threshold, 1);
  EXPECT_EQ(params.snic_compactness, 5);  // IV-C
  EXPECT_EQ(params.gop, 10);              // V-A
}

TEST(Preset, DefaultIsTheDefaults) { EXPECT_EQ(Preset("default").value(), EstimationParams()); }

TEST(Preset, PaperIsThePaperToTheLetter) {
  EstimationParams expected;
  expected.levels = 250;
  expected.level_blocks = 1;
  expected.search = Search::kFull;
  expected.max_sweeps = 0;
  expected.uniqueness = 0;
  expected.refine_rounds = 0;
  EXPECT_EQ(Preset("paper").value(), expected);
  EXPECT_TRUE(expected.Validate().ok());
}

TEST(Preset, BestAndFastDifferFromTheDefaultInCostAlone) {
  for (const std::string name : {"best", "fast"}) {
    const EstimationParams params = Preset(name).value();
    EXPECT_TRUE(params.Validate().ok());
    EXPECT_NE(params, EstimationParams());
    EXPECT_EQ(params.levels, 0);  // from the job, as the default
    EXPECT_EQ(params.segments, 0);
    EXPECT_EQ(params.search, EstimationParams().search);
  }
  EXPECT_GT(Preset("best").value().choice_rounds, EstimationParams().choice_rounds);
  EXPECT_LT(Preset("fast").value().compared, EstimationParams().compared);
}

TEST(Preset, UnknownNameListsThoseThereAre) {
  for (const std::string name : {"", "Paper", "better"}) {
    const Result<EstimationParams> preset = Preset(name);
    ASSERT_FALSE(preset.ok());
    EXPECT_EQ(preset.status().code(), ErrorCode::kInvalidArgument);
    EXPECT_THAT(preset.status().message(), HasSubstr("'" + name + "', expected default, best, fast or paper"));
  }
}

}  // namespace
}  // namespace depthfarm
