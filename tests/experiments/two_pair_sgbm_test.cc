#include "tests/experiments/two_pair_sgbm.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "tests/experiments/rectified_pair.h"
#include "tests/support/rendered_sequence.h"

namespace depthfarm {
namespace {

ResolvedJob JobOf(const test::RenderedSequence& rendered) { return ResolveJob(rendered.sequence, {}).value(); }

TEST(Rectify, PointsLieInOneRowAtTheDisparityOfTheirDepth) {
  for (const ArrayKind kind : {ArrayKind::kArc, ArrayKind::kGrid, ArrayKind::kIrregular}) {
    const test::RenderedSequence rendered = test::Render(kind, 6, 96, 72, 1, 5, 0);
    const ResolvedJob job = JobOf(rendered);
    for (const JobView& view : job.views) {
      const Camera& first = view.camera;
      for (const int n : view.neighbours) {
        const Camera& second = job.views[static_cast<std::size_t>(n)].camera;
        const RectifiedPair pair = Rectify(first, second, view.own_range).value();
        for (const double z : {view.own_range.z_near, view.own_range.z_far}) {
          const Eigen::Vector3d pixel(30, 50, 1);
          const Eigen::Vector3d in_first = first.intrinsics.inverse() * pixel * z;
          const Eigen::Vector3d world =
              first.cam_from_world_rotation.transpose() * (in_first - first.cam_from_world_translation);
          const Eigen::Vector3d in_second = second.cam_from_world_rotation * world + second.cam_from_world_translation;
          const Eigen::Vector2d a = (pair.first * pixel).hnormalized();
          const Eigen::Vector2d b = (pair.second * (second.intrinsics * in_second)).hnormalized();
          EXPECT_NEAR(a.y(), b.y(), 1e-6);
          const double disparity = a.x() - b.x();
          EXPECT_GE(disparity, 1 - 1e-9);
          EXPECT_LT(disparity, pair.disparities);
          EXPECT_NEAR((disparity - pair.offset) * pair.scale * pair.ray_z.dot(pixel), 1 / z, 1e-9);
        }
      }
    }
  }
}

TEST(EstimateBySgbm, ParallelCamerasHaveDepthInEveryRow) {
  const test::RenderedSequence rendered = test::Render(ArrayKind::kLine, 3, 160, 120, 1, 2, 0.5);
  const ResolvedJob job = JobOf(rendered);
  const auto stereo = [&](std::size_t v) { return StereoView{&rendered.pictures[0][v], job.views[v].camera}; };
  const DepthMap depth = EstimateBySgbm(stereo(1), {stereo(0), stereo(2)}, job.views[1].own_range).value();
  for (const float z : depth.values()) EXPECT_GT(z, 0);
  int good = 0;
  for (int x = 0; x < depth.width(); ++x) {
    const double exact = rendered.depth[0][1](x, 119);
    good += std::abs(depth(x, 119) - exact) < 0.1 * exact ? 1 : 0;
  }
  EXPECT_GT(good, 160 * 6 / 10);
}

TEST(EstimateBySgbm, LeavesOutANeighbourThatCannotBePaired) {
  const test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, 160, 120, 1, 2, 0.5);
  const ResolvedJob job = JobOf(rendered);
  const auto stereo = [&](std::size_t v) { return StereoView{&rendered.pictures[0][v], job.views[v].camera}; };
  const DepthRange range = job.views[1].own_range;
  const StereoView itself = stereo(1);
  EXPECT_EQ(EstimateBySgbm(stereo(1), {itself, stereo(2)}, range).value(),
            EstimateBySgbm(stereo(1), {stereo(2)}, range).value());
  EXPECT_EQ(EstimateBySgbm(stereo(1), {itself}, range).status().code(), ErrorCode::kInvalidArgument);
  EXPECT_FALSE(EstimateBySgbm(stereo(1), {}, range).ok());
}

TEST(Rectify, CutsTheNearestPartOfAWideRangeOff) {
  const test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, 96, 72, 1, 5, 0);
  const ResolvedJob job = JobOf(rendered);
  const DepthRange range = job.views[1].own_range;
  const auto pair = [&](double z_near, int most) {
    return Rectify(job.views[1].camera, job.views[0].camera, {z_near, range.z_far}, most).value();
  };
  const RectifiedPair whole = pair(range.z_near, 512);
  const RectifiedPair cut = pair(range.z_near * 1e-9, 512);
  EXPECT_EQ(cut.disparities, 512);
  EXPECT_LT(whole.disparities, 512);
  EXPECT_EQ(cut.offset, whole.offset);
}

TEST(EstimateBySgbm, FindsTheDepthOfARenderedScene) {
  const test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, 320, 240, 1, 2, 0.5);
  const ResolvedJob job = JobOf(rendered);
  const auto stereo = [&](std::size_t v) { return StereoView{&rendered.pictures[0][v], job.views[v].camera}; };
  const DepthMap depth = EstimateBySgbm(stereo(1), {stereo(0), stereo(2)}, job.views[1].own_range).value();
  int good = 0;
  for (int y = 0; y < depth.height(); ++y) {
    for (int x = 0; x < depth.width(); ++x) {
      EXPECT_GT(depth(x, y), 0);
      const double exact = rendered.depth[0][1](x, y);
      good += std::abs(depth(x, y) - exact) < 0.05 * exact ? 1 : 0;
    }
  }
  EXPECT_GT(good, 320 * 240 * 8 / 10);
}

}  // namespace
}  // namespace depthfarm
