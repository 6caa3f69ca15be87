#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "common/quality/depth_error.h"
#include "common/quality/visibility.h"
#include "tests/experiments/anchored_problem.h"
#include "tests/experiments/per_view.h"
#include "tests/experiments/pixel_cut.h"
#include "tests/experiments/pixel_labelling.h"
#include "tests/support/random.h"
#include "tests/support/rendered_sequence.h"

namespace depthfarm {
namespace {

ResolvedJob JobOf(const test::RenderedSequence& rendered) { return ResolveJob(rendered.sequence, {}).value(); }

struct Scene {
  test::RenderedSequence rendered;
  ResolvedJob job;

  Scene(ArrayKind kind, int cameras, int width, int height, double noise)
      : rendered(test::Render(kind, cameras, width, height, 1, 2, noise)), job(JobOf(rendered)) {}

  [[nodiscard]] const std::vector<YcbcrImage>& pictures() const { return rendered.pictures[0]; }
  [[nodiscard]] StereoView View(std::size_t v) const { return {&pictures()[v], job.views[v].camera}; }
  [[nodiscard]] ViewDepth Exact(std::size_t v) const { return {&rendered.depth[0][v], job.views[v].camera}; }

  // Percent of the pixels of the middle one of three views that another one sees too, off by more than two levels.
  [[nodiscard]] double PercentWrong(const DepthMap& depth) const {
    const DepthLevels levels = job.Levels();
    const PixelMask visible = VisibleInAny(Exact(1), {Exact(0), Exact(2)}, levels);
    DepthErrorInput input;
    input.estimated = &depth;
    input.exact = &rendered.depth[0][1];
    input.camera = job.views[1].camera;
    input.levels = &levels;
    input.neighbour = job.views[0].camera;
    input.non_occluded = &visible;
    const std::vector<DepthErrorGroup> groups = MeasureDepthError(input).value();
    EXPECT_EQ(groups[1].name, "non-occluded");
    EXPECT_EQ(groups[1].figures.estimated, groups[1].figures.pixels);
    EXPECT_EQ(DepthErrorFigures::kBadLevels[2], 2);
    return groups[1].figures.BadLevelsPercent(2);
  }
};

// Two nodes that want levels 0 and 2 of 0..2 by 10 steps each: a weak link leaves them, a strong one joins them.
TEST(AnchoredProblem, RewardsAreEachNodesOwnAndLinksPullTogether) {
  for (const bool strong : {false, true}) {
    AnchoredProblem problem(2, 3);
    problem.SetReward(0, 0, 10);
    problem.SetReward(2, 1, 11);
    problem.smoothness().push_back({0, 1, (strong ? 20 : 4) * kEnergyUnitsPerMatchStep});
    const std::vector<Level> labels = problem.Solve(0);
    EXPECT_EQ(labels.size(), 2U);
    EXPECT_EQ(labels[0], strong ? 2 : 0);
    EXPECT_EQ(labels[1], 2);
  }
}

// Costs as rewards: the core's own expansion finds the same labels, the cut of both being the smallest.
TEST(PixelLabelling, ExpandsAsTheCoreDoes) {
  test::Random random(7);
  for (int trial = 0; trial < 20; ++trial) {
    PixelLabelling pixels(random.Int(1, 7), random.Int(1, 7), random.Int(2, 9));
    const auto nodes = static_cast<NodeIndex>(pixels.num_pixels());
    pixels.step = 2 * random.Int(0, 40);
    constexpr std::uint16_t kMost = 300;
    AnchoredProblem problem(nodes, pixels.num_levels);
    for (int level = 0; level < pixels.num_levels; ++level) {
      for (NodeIndex p = 0; p < nodes; ++p) {
        const auto steps = static_cast<std::uint16_t>(random.Int(0, kMost));
        pixels.CostsOf(level)[p] = static_cast<std::uint16_t>(kMost - steps);
        problem.SetReward(level, p, steps);
      }
    }
    const std::int32_t beta = pixels.step * kEnergyUnitsPerMatchStep;
    const auto node = [&](int x, int y) { return static_cast<NodeIndex>(y * pixels.width + x); };
    for (int y = 0; y < pixels.height; ++y) {
      for (int x = 0; x < pixels.width; ++x) {
        if (x + 1 < pixels.width) problem.smoothness().push_back({node(x, y), node(x + 1, y), beta});
        if (y + 1 < pixels.height) problem.smoothness().push_back({node(x, y), node(x, y + 1), beta});
      }
    }
    std::vector<Level> labels = CheapestLevels(pixels);
    const std::int64_t start = TotalEnergy(pixels, labels);
    const std::int64_t end = ExpandPixels(pixels, 2, labels);
    EXPECT_EQ(labels, problem.Solve(2)) << "trial " << trial;
    EXPECT_LE(end, start);
    EXPECT_EQ(end, TotalEnergy(pixels, labels));
  }
}

// Two pixels, two levels apart by what they want: a jump that is cheap from one step on stays, a dear one goes.
TEST(PixelLabelling, AJumpBeyondTheLargestCostsNoMore) {
  for (const int most_steps : {1, 2}) {
    PixelLabelling pixels(2, 1, 3);
    pixels.costs = {0, 10, 9, 9, 10, 0};  // [level][pixel]
    pixels.step = 8;
    pixels.most_steps = most_steps;
    std::vector<Level> labels = CheapestLevels(pixels);
    EXPECT_EQ(TotalEnergy(pixels, labels), 8 * most_steps);
    EXPECT_EQ(ExpandPixels(pixels, 0, labels), most_steps == 1 ? 8 : 10);
    EXPECT_EQ(labels[0] == labels[1], most_steps == 2);
  }
}

TEST(PixelCut, FindsTheDepthOfARenderedSceneEachTimeTheSame) {
  const Scene scene(ArrayKind::kArc, 3, 240, 180, 0.5);
  const auto estimate = [&] {
    return EstimateByPixelCut(scene.View(1), {scene.View(0), scene.View(2)}, scene.job.Levels(), {}).value();
  };
  const DepthMap depth = estimate();
  EXPECT_LT(scene.PercentWrong(depth), 20);
  EXPECT_EQ(depth, estimate());
}

TEST(PixelCut, HasNoMoreEnergyThanWinnerTakesAll) {
  const Scene scene(ArrayKind::kGrid, 4, 96, 72, 2);
  for (const double most_jump : {5.0, 249.0}) {
    PixelCutParams params;
    params.most_jump = most_jump;
    const PixelLabelling problem =
        PixelCutProblem(scene.View(0), {scene.View(1), scene.View(2)}, scene.job.Levels(), params);
    std::vector<Level> labels = CheapestLevels(problem);
    const std::int64_t winner_takes_all = TotalEnergy(problem, labels);
    const std::int64_t one = ExpandPixels(problem, 1, labels);
    EXPECT_LT(one, winner_takes_all);
    EXPECT_LE(ExpandPixels(problem, params.sweeps, labels), one);
  }
}

TEST(PixelCut, SmoothingMakesNeighboursAgree) {
  const Scene scene(ArrayKind::kArc, 3, 96, 72, 2);
  const auto steps = [&](double smoothing) {
    PixelCutParams params;
    params.smoothing = smoothing;
    const DepthMap depth =
        EstimateByPixelCut(scene.View(1), {scene.View(0), scene.View(2)}, scene.job.Levels(), params).value();
    double sum = 0;
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 1; x < depth.width(); ++x) sum += std::abs(depth(x, y) - depth(x - 1, y));
    }
    return sum;
  };
  EXPECT_LT(steps(1), 0.5 * steps(0));
}

TEST(PixelCut, APixelThatMatchesNowhereHasDepth) {
  Scene scene(ArrayKind::kArc, 3, 96, 72, 0);
  for (Ycbcr& pixel : scene.rendered.pictures[0][0].values()) pixel = {255, 0, 0, 0};
  const DepthMap depth = EstimateByPixelCut(scene.View(1), {scene.View(0)}, scene.job.Levels(), {}).value();
  for (const float z : depth.values()) EXPECT_GT(z, 0);
}

TEST(PixelCut, RefusesWhatIsOutOfBoundsByName) {
  const Scene scene(ArrayKind::kArc, 2, 96, 72, 0);
  const auto refusal = [&](const std::vector<StereoView>& neighbours, const PixelCutParams& params) {
    const Status status = EstimateByPixelCut(scene.View(0), neighbours, scene.job.Levels(), params).status();
    EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
    return std::string(status.message());
  };
  using testing::HasSubstr;
  EXPECT_THAT(refusal({}, {}), HasSubstr("has no neighbour"));
  const std::vector<StereoView> other = {scene.View(1)};
  EXPECT_THAT(refusal(other, {.window = 4}), HasSubstr("window is 4, expected an odd number from 1 to 15"));
  EXPECT_THAT(refusal(other, {.most_difference = 0}), HasSubstr("most-difference is 0"));
  EXPECT_THAT(refusal(other, {.smoothing = -1}), HasSubstr("smoothing is -1"));
  EXPECT_THAT(refusal(other, {.most_jump = 0.5}), HasSubstr("most-jump is 0.5"));
  EXPECT_THAT(refusal(other, {.sweeps = -1}), HasSubstr("sweeps is -1"));
}

TEST(PerView, FindsTheDepthOfARenderedSceneEachTimeTheSame) {
  const Scene scene(ArrayKind::kArc, 3, 240, 180, 0.5);
  const std::vector<DepthMap> depths = PerViewOfFrame(scene.job, scene.pictures()).value();
  ASSERT_EQ(depths.size(), 3U);
  EXPECT_LT(scene.PercentWrong(depths[1]), 40);  // whole pixels, 0.25 of which are a level
  EXPECT_EQ(depths, PerViewOfFrame(scene.job, scene.pictures()).value());
}

TEST(PerView, RefusesRewardsThatItCannotHold) {
  Scene scene(ArrayKind::kLine, 7, 96, 72, 0);
  EstimationParams params;
  params.neighbours = 6;
  params.matching_offset = 765;
  scene.job = ResolveJob(scene.rendered.sequence, params).value();
  const Status status = PerViewOfFrame(scene.job, scene.pictures()).status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(std::string(status.message()), testing::HasSubstr("matching-offset is 765"));
}

// What makes it another method: the pictures of the others count, their depth does not.
TEST(PerView, AViewsDepthDoesNotDependOnThatOfViewsItIsNotMatchedWith) {
  const Scene scene(ArrayKind::kLine, 5, 96, 72, 0.5);
  for (const int neighbour : scene.job.views[0].neighbours) ASSERT_NE(neighbour, 4);
  std::vector<YcbcrImage> changed = scene.pictures();
  for (Ycbcr& pixel : changed[4].values()) pixel = {50, 128, 128, 0};
  EXPECT_EQ(PerViewOfFrame(scene.job, changed).value()[0], PerViewOfFrame(scene.job, scene.pictures()).value()[0]);
}

}  // namespace
}  // namespace depthfarm
