#include "worker/refinement/view_geometry.h"

#include <gtest/gtest.h>

#include "common/geometry/reprojection.h"
#include "tests/support/rendered_sequence.h"

namespace depthfarm {
namespace {

ResolvedJob MixedJob() {
  EstimationParams params;
  params.levels = 24;
  return ResolveJob(test::Render(ArrayKind::kMixed, 5, 160, 120, 1, 3, 0).sequence, params).value();
}

TEST(RefinementGeometry, MovesPixelsAsTheReprojectionDoes) {
  const ResolvedJob job = MixedJob();
  const std::vector<ViewGeometry> geometry = RefinementGeometry(job);
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
  const ResolvedJob job = MixedJob();
  const std::vector<ViewGeometry> geometry = RefinementGeometry(job);
  for (std::size_t v = 0; v < geometry.size(); ++v) {
    const Camera& camera = job.views[v].camera;
    const auto nearest = static_cast<std::size_t>(job.views[v].compared.front());
    const Reprojection pair(camera, job.views[nearest].camera);
    const double middle = 0.5 * (1 / job.views[v].own_range.z_near + 1 / job.views[v].own_range.z_far);
    const double step = 0.05 / geometry[v].pixels_per_inverse_depth;  // of 1/z: 0.1 in u from end to end
    const auto at = [&](double inverse) {
      return pair.Project(0.5 * (camera.width - 1), 0.5 * (camera.height - 1), inverse);
    };
    const double dx = at(middle + step).x - at(middle - step).x;
    const double dy = at(middle + step).y - at(middle - step).y;
    EXPECT_NEAR(std::sqrt(dx * dx + dy * dy), 0.1, 1e-4);
  }
}

TEST(PlanesOfLevels, AreTheLevelsInverseDepths) {
  const ResolvedJob job = MixedJob();
  const DepthLevels levels = job.Levels();
  for (int v = 0; v < job.num_views(); ++v) {
    const ViewGeometry geometry = RefinementGeometry(job)[static_cast<std::size_t>(v)];
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
