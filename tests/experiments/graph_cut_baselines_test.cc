#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "tests/experiments/anchored_problem.h"
#include "tests/experiments/per_view.h"
#include "tests/experiments/pixel_cut.h"
#include "tests/support/rendered_sequence.h"

namespace depthfarm {
namespace {

ResolvedJob JobOf(const test::RenderedSequence& rendered) { return ResolveJob(rendered.sequence, {}).value(); }

// Share of pixels within 5 % of exact depth.
double ShareGood(const DepthMap& depth, const DepthMap& exact) {
  int good = 0;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    good += std::abs(depth.values()[i] - exact.values()[i]) < 0.05F * exact.values()[i] ? 1 : 0;
  }
  return good / static_cast<double>(depth.size());
}

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

TEST(PixelCut, FindsTheDepthOfARenderedSceneEachTimeTheSame) {
  const test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, 160, 120, 1, 2, 0.5);
  const ResolvedJob job = JobOf(rendered);
  const auto stereo = [&](std::size_t v) { return StereoView{&rendered.pictures[0][v], job.views[v].camera}; };
  const DepthMap depth = EstimateByPixelCut(stereo(1), {stereo(0), stereo(2)}, job.Levels(), {}).value();
  EXPECT_GT(ShareGood(depth, rendered.depth[0][1]), 0.75);
  EXPECT_EQ(depth, EstimateByPixelCut(stereo(1), {stereo(0), stereo(2)}, job.Levels(), {}).value());
}

TEST(PixelCut, SmoothingMakesNeighboursAgree) {
  const test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, 96, 72, 1, 2, 2);
  const ResolvedJob job = JobOf(rendered);
  const auto stereo = [&](std::size_t v) { return StereoView{&rendered.pictures[0][v], job.views[v].camera}; };
  const auto steps = [&](double smoothing) {
    PixelCutParams params;
    params.smoothing = smoothing;
    const DepthMap depth = EstimateByPixelCut(stereo(1), {stereo(0), stereo(2)}, job.Levels(), params).value();
    double sum = 0;
    for (int y = 0; y < depth.height(); ++y) {
      for (int x = 1; x < depth.width(); ++x) sum += std::abs(depth(x, y) - depth(x - 1, y));
    }
    return sum;
  };
  EXPECT_LT(steps(1), 0.5 * steps(0));
}

TEST(PixelCut, NeedsANeighbour) {
  const test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 2, 96, 72, 1, 2, 0);
  const ResolvedJob job = JobOf(rendered);
  const StereoView view = {&rendered.pictures[0][0], job.views[0].camera};
  EXPECT_EQ(EstimateByPixelCut(view, {}, job.Levels(), {}).status().code(), ErrorCode::kInvalidArgument);
}

TEST(PerView, FindsTheDepthOfARenderedSceneEachTimeTheSame) {
  const test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, 160, 120, 1, 2, 0.5);
  const ResolvedJob job = JobOf(rendered);
  const std::vector<DepthMap> depths = PerViewOfFrame(job, rendered.pictures[0]).value();
  ASSERT_EQ(depths.size(), 3U);
  EXPECT_GT(ShareGood(depths[1], rendered.depth[0][1]), 0.5);  // whole pixels at 160 x 120
  EXPECT_EQ(depths, PerViewOfFrame(job, rendered.pictures[0]).value());
}

// What makes it another method: the pictures of the others count, their depth does not.
TEST(PerView, AViewsDepthDoesNotDependOnThatOfViewsItIsNotMatchedWith) {
  const test::RenderedSequence rendered = test::Render(ArrayKind::kLine, 5, 96, 72, 1, 2, 0.5);
  const ResolvedJob job = JobOf(rendered);
  for (const int neighbour : job.views[0].neighbours) ASSERT_NE(neighbour, 4);
  std::vector<YcbcrImage> changed = rendered.pictures[0];
  for (Ycbcr& pixel : changed[4].values()) pixel = {50, 128, 128, 0};
  EXPECT_EQ(PerViewOfFrame(job, std::move(changed)).value()[0], PerViewOfFrame(job, rendered.pictures[0]).value()[0]);
}

}  // namespace
}  // namespace depthfarm
