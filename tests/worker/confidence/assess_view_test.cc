#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>

#include "tests/support/rendered_sequence.h"
#include "worker/confidence/confidence.h"
#include "worker/refinement/view_geometry.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 160;
constexpr int kHeight = 120;

Evidence Good() { return {.misfit = 0, .margin = 1, .agreeing = 4, .nearest_gap = 0, .mean_gap = 0}; }

TEST(ProbabilityOfRight, IsNearlyOneWithEveryEvidenceForItAndNearlyZeroWithAllAgainst) {
  EXPECT_GT(ProbabilityOfRight(Good()), 0.999);
  EXPECT_LT(ProbabilityOfRight({.misfit = 1,
                                .margin = 0,
                                .agreeing = 0,
                                .seen_through = true,
                                .nearest_gap = 1,
                                .mean_gap = 1,
                                .to_jump = 0}),
            0.05);
}

TEST(ProbabilityOfRight, FallsWithEveryEvidenceAgainst) {
  const double best = ProbabilityOfRight(Good());
  const auto with = [](auto change) {
    Evidence evidence = Good();
    change(evidence);
    return ProbabilityOfRight(evidence);
  };
  EXPECT_LT(with([](Evidence& e) { e.misfit = 0.05; }), best);
  EXPECT_LT(with([](Evidence& e) { e.misfit = 0.5; }), with([](Evidence& e) { e.misfit = 0.05; }));
  EXPECT_LT(with([](Evidence& e) { e.margin = 0; }), with([](Evidence& e) { e.margin = 0.05; }));
  EXPECT_LT(with([](Evidence& e) { e.margin = 0.05; }), best);
  EXPECT_EQ(with([](Evidence& e) { e.agreeing = 3; }), best);
  for (int agreeing = 2; agreeing >= 0; --agreeing) {
    EXPECT_LT(with([&](Evidence& e) { e.agreeing = agreeing; }), with([&](Evidence& e) { e.agreeing = agreeing + 1; }));
  }
  EXPECT_LT(with([](Evidence& e) { e.seen_through = true; }), best);
  EXPECT_LT(with([](Evidence& e) { e.nearest_gap = 0.2; }), best);
  EXPECT_LT(with([](Evidence& e) { e.mean_gap = 0.2; }), best);
  for (int distance = Evidence::kFarFromJumps; distance > 0; --distance) {
    EXPECT_LE(with([&](Evidence& e) { e.to_jump = distance - 1; }), with([&](Evidence& e) { e.to_jump = distance; }));
  }
}

// A rendered arc whose depth is exact, but for a square of the middle view.
struct Scene {
  test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, kWidth, kHeight, 1, 7, 1.0);
  ResolvedJob job;
  FrameAnalysis analysis;
  FrameRefinement refined;
  static constexpr int kFirst = 60;
  static constexpr int kLast = 75;

  Scene() {
    EstimationParams params;
    params.segments = 900;
    params.levels = 24;
    job = ResolveJob(rendered.sequence, params).value();
    analysis = test::Analyse(rendered, job, 0);
    for (std::size_t v = 0; v < analysis.size(); ++v) refined.push_back(Exact(v, v == 1 ? 6 : 0));
  }

  static bool InSquare(int x, int y) { return x >= kFirst && x <= kLast && y >= kFirst && y <= kLast; }

  // Each pixel a plane of its own, those of the square off by `shift` pixels.
  [[nodiscard]] std::shared_ptr<const RefinedView> Exact(std::size_t v, float shift) const {
    const double scale = RefinementGeometry(job, static_cast<int>(v)).pixels_per_inverse_depth;
    RefinedView view;
    const std::size_t segments = analysis[v]->segments.centers.size();
    view.planes.resize(segments);
    view.kept.resize(segments);
    view.plane_of_pixel = Grid<PlaneIndex>(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        view.plane_of_pixel(x, y) = static_cast<PlaneIndex>(view.planes.size());
        const float u = static_cast<float>(scale / static_cast<double>(rendered.depth[0][v](x, y)));
        view.planes.push_back({0, 0, u + (InSquare(x, y) ? shift : 0)});
      }
    }
    return std::make_shared<const RefinedView>(view);
  }

  // Mean probability of the pixels in or outside the square.
  [[nodiscard]] static double Mean(const ConfidenceMap& map, bool in_square) {
    double sum = 0;
    int count = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (InSquare(x, y) != in_square) continue;
        sum += map.codes(x, y) / kConfidenceScale;
        ++count;
      }
    }
    return sum / count;
  }
};

TEST(AssessView, TellsWrongDepthFromRight) {
  const Scene scene;
  const ConfidenceMap map = AssessView(scene.job, 1, scene.analysis, scene.refined).value();
  EXPECT_GT(Scene::Mean(map, false), 0.95);
  EXPECT_LT(Scene::Mean(map, true), 0.2);
}

TEST(AssessView, DoubtsWhatAnotherViewHasWrong) {
  const Scene scene;
  const ConfidenceMap map = AssessView(scene.job, 0, scene.analysis, scene.refined).value();
  FrameRefinement right = scene.refined;
  right[1] = scene.Exact(1, 0);
  const ConfidenceMap with_right = AssessView(scene.job, 0, scene.analysis, right).value();
  double fell = 0;
  for (std::size_t i = 0; i < map.codes.size(); ++i)
    fell += map.codes.values()[i] < with_right.codes.values()[i] ? 1 : 0;
  EXPECT_GT(fell, 200) << "of the 256 pixels of the square";
}

TEST(AssessView, ReadsTheViewAndThoseItIsComparedWith) {
  Scene scene;
  scene.job.views[0].compared = {1};
  const ConfidenceMap map = AssessView(scene.job, 0, scene.analysis, scene.refined).value();
  FrameAnalysis analysis = scene.analysis;
  FrameRefinement refined = scene.refined;
  analysis[2] = nullptr;
  refined[2] = nullptr;
  EXPECT_EQ(AssessView(scene.job, 0, analysis, refined).value(), map);
  refined[1] = nullptr;
  EXPECT_THAT(AssessView(scene.job, 0, analysis, refined).status().message(),
              HasSubstr("camera 'cam1' has no analysis or no refined depth"));
  EXPECT_FALSE(AssessView(scene.job, 3, scene.analysis, scene.refined).ok());
}

TEST(AssessView, StopsWhenAsked) {
  const Scene scene;
  std::stop_source source;
  source.request_stop();
  EXPECT_EQ(AssessView(scene.job, 1, scene.analysis, scene.refined, source.get_token()).status().code(),
            ErrorCode::kCancelled);
}

}  // namespace
}  // namespace depthfarm
