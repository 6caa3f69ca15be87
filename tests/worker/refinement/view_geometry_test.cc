#include "worker/refinement/view_geometry.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "common/geometry/reprojection.h"
#include "tests/support/rendered_sequence.h"

namespace depthfarm {
namespace {

ResolvedJob MixedJob() {
  EstimationParams params;
  params.levels = 24;
  return ResolveJob(test::Render(ArrayKind::kMixed, 5, 160, 120, 1, 3, 0).sequence, params).value();
}

std::vector<ViewGeometry> GeometryOfAll(const ResolvedJob& job) {
  std::vector<ViewGeometry> all;
  for (int view = 0; view < job.num_views(); ++view) all.push_back(RefinementGeometry(job, view));
  return all;
}

// Cameras of one picture size at the given places, looking along z, and depth from `z_near` to `z_far`.
ResolvedJob JobOfPlaces(const std::vector<Eigen::Vector3d>& places, double z_near, double z_far) {
  ResolvedJob job;
  for (std::size_t i = 0; i < places.size(); ++i) {
    JobView view;
    view.camera = {.name = "c" + std::to_string(i), .width = 101, .height = 81};
    view.camera.intrinsics << 100, 0, 50, 0, 100, 40, 0, 0, 1;
    view.camera.cam_from_world_translation = -places[i];
    view.own_range = {z_near, z_far};
    for (std::size_t other = 0; other < places.size(); ++other)
      if (other != i) view.compared.push_back(static_cast<int>(other));
    job.views.push_back(view);
  }
  return job;
}

TEST(RefinementGeometry, MovesPixelsAsTheReprojectionDoes) {
  const ResolvedJob job = MixedJob();
  const std::vector<ViewGeometry> geometry = GeometryOfAll(job);
  for (std::size_t v = 0; v < geometry.size(); ++v) {
    const double scale = geometry[v].pixels_per_inverse_depth;
    ASSERT_EQ(geometry[v].pairs.size(), job.views[v].compared.size());
    for (const PairGeometry& pair : geometry[v].pairs) {
      const auto o = static_cast<std::size_t>(pair.other);
      const double inverse_depth = 1 / job.views[v].own_range.z_near;
      const auto expected = Reprojection(job.views[v].camera, job.views[o].camera).Project(70, 50, inverse_depth);
      const Eigen::Vector3d q = pair.m * Eigen::Vector3d(70, 50, 1) + pair.e * (scale * inverse_depth);
      EXPECT_NEAR(q[0] / q[2], expected.x, 1e-9);
      EXPECT_NEAR(q[1] / q[2], expected.y, 1e-9);
      // 1/z' = (1/z) / (z'/z), in pixels of the other view's own nearest neighbour.
      const double u_in_other = pair.other_scale * scale * inverse_depth / q[2];
      EXPECT_NEAR(u_in_other, geometry[o].pixels_per_inverse_depth * inverse_depth / expected.depth_per_source, 1e-9);
    }
  }
}

TEST(RefinementGeometry, UIsPixelsInTheNearestViewComparedWith) {
  // f b = 100 px x 0.5 m for all pixels alike.
  const ViewGeometry aside = RefinementGeometry(JobOfPlaces({{0, 0, 0}, {0.3, 0.4, 0}, {9, 0, 0}}, 2, 8), 0);
  EXPECT_NEAR(aside.pixels_per_inverse_depth, 50, 1e-9);
}

TEST(RefinementGeometry, CamerasOneBehindTheOtherShowParallaxAwayFromTheCentre) {
  const ResolvedJob job = JobOfPlaces({{0, 0, 0}, {0, 0, 0.5}}, 2, 8);
  const double middle = 0.5 * (1.0 / 2 + 1.0 / 8);
  // A pixel r from the centre is seen at r / (1 - 0.5 / z) from the camera in front.
  const double corner = std::sqrt(50.0 * 50 + 40 * 40) * 0.5 / ((1 - 0.5 * middle) * (1 - 0.5 * middle));
  EXPECT_NEAR(RefinementGeometry(job, 0).pixels_per_inverse_depth, 4 * corner / 5, 1e-9);
}

TEST(RefinementGeometry, PassesOverAViewWithoutParallax) {
  const ResolvedJob job = JobOfPlaces({{0, 0, 0}, {1e-9, 0, 0}, {0.5, 0, 0}}, 2, 8);
  EXPECT_NEAR(RefinementGeometry(job, 0).pixels_per_inverse_depth, 50, 1e-9);
}

TEST(RefinementGeometry, DoesNotDependOnTheUnitOfLength) {
  const std::vector<std::vector<Eigen::Vector3d>> rigs = {
      {{0, 0, 0}, {0.5, 0, 0}}, {{0, 0, 0}, {0, 0, 0.5}}, {{0, 0, 0}, {0, 0, 0}}};
  for (std::vector<Eigen::Vector3d> places : rigs) {
    const double metres = RefinementGeometry(JobOfPlaces(places, 2, 8), 0).pixels_per_inverse_depth;
    for (Eigen::Vector3d& place : places) place *= 1000;
    const double millimetres = RefinementGeometry(JobOfPlaces(places, 2000, 8000), 0).pixels_per_inverse_depth;
    EXPECT_NEAR(millimetres / 1000, metres, 1e-9 * metres);
  }
}

TEST(PlanesOfLevels, AreTheLevelsInverseDepths) {
  const ResolvedJob job = MixedJob();
  const DepthLevels levels = job.Levels();
  for (int v = 0; v < job.num_views(); ++v) {
    const ViewGeometry geometry = RefinementGeometry(job, v);
    const LevelsInView in_view(job.views[static_cast<std::size_t>(v)].camera, levels);
    const std::vector<SlantedPlane> planes = PlanesOfLevels(job, v, geometry);
    ASSERT_EQ(planes.size(), 24U);
    for (const int level : {0, 11, 23}) {
      const double expected =
          geometry.pixels_per_inverse_depth * in_view.InverseDepth(130, 90, levels.DepthInRef(level));
      EXPECT_NEAR(planes[static_cast<std::size_t>(level)].At(130, 90), expected, 1e-4);
    }
  }
}

}  // namespace
}  // namespace depthfarm
