#include "worker/refinement/refine.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/rendered_sequence.h"

namespace depthfarm {
namespace {

struct Scene {
  test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, 160, 120, 1, 7, 1.0);
  ResolvedJob job;
  FrameAnalysis analysis;
  LabelField labels;

  Scene() {
    EstimationParams params;
    params.segments = 900;
    params.levels = 24;
    params.level_blocks = 1;
    job = ResolveJob(rendered.sequence, params).value();
    analysis = test::Analyse(rendered, job, 0);
    labels = test::EstimateFrame(job, analysis, nullptr, 1);
  }

  // Mean |u - exact u| of a view over pixels wrong by less than two pixels, so that the cut's own errors do not count.
  [[nodiscard]] double Error(const std::vector<RefinedView>& views, std::size_t v) const {
    const double scale = RefinementGeometry(job)[v].pixels_per_inverse_depth;
    const RefinedView& view = views[v];
    double sum = 0;
    int count = 0;
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 160; ++x) {
        const double exact = scale / rendered.depth[0][v](x, y);
        const double error = std::abs(view.planes[view.segment_of_pixel(x, y)].At(x, y) - exact);
        if (error >= 2) continue;
        sum += error;
        ++count;
      }
    }
    EXPECT_GT(count, 160 * 120 * 3 / 4);
    return sum / count;
  }
};

TEST(RefinePlanes, NoRoundsAreTheLevelsThemselves) {
  const Scene scene;
  const auto views = RefinePlanes(scene.job, scene.analysis, scene.labels, 0);
  const DepthLevels levels = scene.job.Levels();
  for (std::size_t v = 0; v < views.size(); ++v) {
    const double scale = RefinementGeometry(scene.job)[v].pixels_per_inverse_depth;
    const LevelsInView in_view(scene.job.views[v].camera, levels);
    EXPECT_EQ(views[v].segment_of_pixel, scene.analysis[v]->segments.labels);
    for (const auto& [x, y] : {std::pair{3, 5}, std::pair{150, 110}}) {
      const SegmentIndex s = views[v].segment_of_pixel(x, y);
      const double depth = levels.DepthInRef(scene.labels.views[v].levels[s]);
      EXPECT_NEAR(views[v].planes[s].At(x, y), scale * in_view.InverseDepth(x, y, depth), 1e-9);
    }
  }
}

TEST(RefinePlanes, HalvesTheErrorThatLevelsLeave) {
  const Scene scene;
  const auto before = RefinePlanes(scene.job, scene.analysis, scene.labels, 0);
  const auto after = RefinePlanes(scene.job, scene.analysis, scene.labels, 4);
  for (std::size_t v = 0; v < before.size(); ++v) EXPECT_LT(scene.Error(after, v), 0.5 * scene.Error(before, v)) << v;
}

TEST(RefinePlanes, PixelsMoveOnlyToSegmentsOfTheView) {
  const Scene scene;
  const auto views = RefinePlanes(scene.job, scene.analysis, scene.labels, 2);
  for (std::size_t v = 0; v < views.size(); ++v) {
    for (const SegmentIndex s : views[v].segment_of_pixel.values()) ASSERT_LT(s, views[v].planes.size());
    EXPECT_NE(views[v].segment_of_pixel, scene.analysis[v]->segments.labels);
    for (const SlantedPlane& plane : views[v].planes) ASSERT_TRUE(std::isfinite(plane.a + plane.b + plane.c));
  }
}

}  // namespace
}  // namespace depthfarm
