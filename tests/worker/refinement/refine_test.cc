#include "worker/refinement/refine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/rendered_sequence.h"
#include "worker/refinement/view_geometry.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;

constexpr int kWidth = 160;
constexpr int kHeight = 120;

// Three views of an arc, two frames (an I and a P frame), with the labels of the cut.
struct Scene {
  test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, kWidth, kHeight, 2, 7, 1.0);
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

  [[nodiscard]] FrameRefinement Start() const {
    FrameRefinement start;
    for (std::size_t v = 0; v < analysis.size(); ++v) {
      start.push_back(std::make_shared<const RefinedView>(
          StartRefinement(job, static_cast<int>(v), *analysis[v], labels.views[v], nullptr).value()));
    }
    return start;
  }

  // All views in ascending or descending order.
  [[nodiscard]] FrameRefinement Round(const FrameAnalysis& of, const FrameRefinement& before, int round,
                                      bool descending = false) const {
    FrameRefinement after(before.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
      const std::size_t v = descending ? before.size() - 1 - i : i;
      after[v] = std::make_shared<const RefinedView>(RefineView(job, static_cast<int>(v), round, of, before).value());
    }
    return after;
  }

  [[nodiscard]] FrameRefinement Refined() const {
    FrameRefinement views = Start();
    for (int round = 1; round <= job.params.refine_rounds; ++round) views = Round(analysis, views, round);
    return views;
  }

  // Mean |u - exact u| of a view over pixels wrong by less than two pixels, so that the cut's own errors do not count.
  [[nodiscard]] double Error(const RefinedView& view, std::size_t v) const {
    const double scale = RefinementGeometry(job, static_cast<int>(v)).pixels_per_inverse_depth;
    double sum = 0;
    int count = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double error = std::abs(view.At(x, y) - scale / rendered.depth[0][v](x, y));
        if (error >= 2) continue;
        sum += error;
        ++count;
      }
    }
    EXPECT_GT(count, kWidth * kHeight * 3 / 4);
    return sum / count;
  }
};

TEST(StartRefinement, OfAnIFrameIsTheLevelsThemselves) {
  const Scene scene;
  const FrameRefinement views = scene.Start();
  for (std::size_t v = 0; v < views.size(); ++v) {
    EXPECT_EQ(views[v]->plane_of_pixel, scene.analysis[v]->segments.labels);
    const Grid<std::uint16_t> codes = RefinedDepthCodes(scene.job, static_cast<int>(v), *views[v]);
    const Grid<std::uint16_t> of_levels =
        DepthCodes(scene.job, static_cast<int>(v), scene.analysis[v]->segments.labels, scene.labels.views[v]);
    for (std::size_t i = 0; i < codes.size(); ++i) ASSERT_NEAR(codes.values()[i], of_levels.values()[i], 1);
  }
}

TEST(RefineView, RoundsHalveTheErrorThatLevelsLeave) {
  const Scene scene;
  const FrameRefinement before = scene.Start();
  const FrameRefinement after = scene.Refined();
  for (std::size_t v = 0; v < before.size(); ++v)
    EXPECT_LT(scene.Error(*after[v], v), 0.5 * scene.Error(*before[v], v)) << v;
}

TEST(RefineView, TheOrderOfViewsAndTheViewsNotComparedWithChangeNothing) {
  const Scene scene;
  FrameRefinement forth = scene.Start();
  FrameRefinement back = scene.Start();
  for (int round = 1; round <= scene.job.params.refine_rounds; ++round) {
    forth = scene.Round(scene.analysis, forth, round);
    back = scene.Round(scene.analysis, back, round, true);
  }
  for (std::size_t v = 0; v < forth.size(); ++v) EXPECT_EQ(*forth[v], *back[v]);

  Scene alone;
  alone.job.views[0].compared = {1};
  const FrameRefinement start = alone.Start();
  FrameRefinement without = start;
  without[2] = nullptr;
  FrameAnalysis analysis = alone.analysis;
  analysis[2] = nullptr;
  EXPECT_EQ(RefineView(alone.job, 0, 1, analysis, without).value(),
            RefineView(alone.job, 0, 1, alone.analysis, start).value());
}

TEST(RefineView, OneMemoryForAllViewsAndRoundsChangesNothing) {
  const Scene scene;
  ViewMemory memory;
  FrameRefinement alone = scene.Start();
  FrameRefinement shared = alone;
  for (int round = 1; round <= scene.job.params.refine_rounds; ++round) {
    alone = scene.Round(scene.analysis, alone, round);
    FrameRefinement after;
    for (int view = 0; view < scene.job.num_views(); ++view) {
      after.push_back(std::make_shared<const RefinedView>(
          RefineView(scene.job, view, round, scene.analysis, shared, memory).value()));
    }
    shared = after;
    for (std::size_t v = 0; v < shared.size(); ++v) ASSERT_EQ(*shared[v], *alone[v]) << v << ", round " << round;
  }
}

TEST(RefineView, IsTheSameOnAnyNumberOfThreads) {
  const Scene scene;
  for (const int threads : {2, 3, 5}) {
    FrameRefinement before = scene.Start();
    for (int round = 1; round <= scene.job.params.refine_rounds; ++round) {
      const FrameRefinement expected = scene.Round(scene.analysis, before, round);
      ViewMemory memory;
      for (int view = 0; view < scene.job.num_views(); ++view) {
        EXPECT_EQ(RefineView(scene.job, view, round, scene.analysis, before, memory, {.threads = threads}).value(),
                  *expected[static_cast<std::size_t>(view)])
            << "view " << view << ", round " << round << ", " << threads << " threads";
      }
      before = expected;
    }
  }
}

TEST(RefineView, AStillPFrameHasTheDepthOfTheIFrameToTheBit) {
  const Scene scene;
  const FrameRefinement i_frame = scene.Refined();
  // The same pictures segmented otherwise: nothing moved, but no segment is the same.
  ResolvedJob coarser = scene.job;
  for (JobView& view : coarser.views) view.segments = 400;
  const FrameAnalysis analysis = test::Analyse(scene.rendered, coarser, 0);
  ResolvedJob job = scene.job;
  job.params.p_threshold = 255;  // noise is no motion
  for (std::size_t v = 0; v < analysis.size(); ++v) {
    const RefinementReferences references{{scene.analysis[v], i_frame[v]}, {scene.analysis[v], i_frame[v]}};
    const ViewLabels labels{std::vector<Level>(analysis[v]->segments.centers.size(), 3),
                            std::vector<std::uint8_t>(analysis[v]->segments.centers.size(), 1)};
    const auto start = StartRefinement(job, static_cast<int>(v), *analysis[v], labels, &references);
    ASSERT_TRUE(start.ok()) << start.status().message();
    EXPECT_EQ(start->Map(), i_frame[v]->Map());
  }
}

TEST(RefineView, APFrameMovesOnlyWhatChanged) {
  const Scene scene;
  const FrameRefinement i_frame = scene.Refined();
  const FrameAnalysis analysis = test::Analyse(scene.rendered, scene.job, 1);
  const TemporalReferences temporal{scene.analysis, std::make_shared<const LabelField>(scene.labels), scene.analysis,
                                    std::make_shared<const LabelField>(scene.labels)};
  const LabelField labels = test::EstimateFrame(scene.job, analysis, &temporal, 1);
  FrameRefinement start;
  for (std::size_t v = 0; v < analysis.size(); ++v) {
    const RefinementReferences references{{scene.analysis[v], i_frame[v]}, {scene.analysis[v], i_frame[v]}};
    start.push_back(std::make_shared<const RefinedView>(
        StartRefinement(scene.job, static_cast<int>(v), *analysis[v], labels.views[v], &references).value()));
    EXPECT_EQ(start[v]->kept, labels.views[v].unchanged) << "the cut and the refinement see the same segments move";
  }
  FrameRefinement after = start;
  for (int round = 1; round <= scene.job.params.refine_rounds; ++round) after = scene.Round(analysis, after, round);
  int moved = 0;
  int kept = 0;
  int uncovered = 0;
  for (std::size_t v = 0; v < analysis.size(); ++v) {
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        if (start[v]->kept[analysis[v]->segments.labels(x, y)] != 0) {
          ASSERT_EQ(after[v]->At(x, y), start[v]->At(x, y));
          uncovered += after[v]->At(x, y) != i_frame[v]->At(x, y) ? 1 : 0;
          ++kept;
        } else {
          moved += after[v]->At(x, y) != start[v]->At(x, y) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(moved, 100);
  EXPECT_GT(kept, 1000);
  EXPECT_LT(uncovered, kept / 200);
}

TEST(RefineView, RefusesWhatDoesNotFit) {
  const Scene scene;
  const FrameRefinement start = scene.Start();
  const auto message = [&](int view, int round, const FrameAnalysis& analysis, const FrameRefinement& before) {
    return RefineView(scene.job, view, round, analysis, before).status().message();
  };
  EXPECT_THAT(message(3, 1, scene.analysis, start), HasSubstr("view 3 of a job with 3"));
  EXPECT_THAT(message(0, 0, scene.analysis, start), HasSubstr("round 0 of 4"));
  EXPECT_THAT(message(0, 5, scene.analysis, start), HasSubstr("round 5 of 4"));
  FrameRefinement without = start;
  without[1] = nullptr;
  EXPECT_THAT(message(0, 1, scene.analysis, without), HasSubstr("camera 'cam1' has no analysis or no refined depth"));
  RefinedView fewer = *start[1];
  fewer.kept.pop_back();
  without[1] = std::make_shared<const RefinedView>(fewer);
  EXPECT_THAT(message(0, 1, scene.analysis, without), HasSubstr("camera 'cam1': refined depth of 160x120"));
  EXPECT_THAT(message(0, 1, {scene.analysis[0]}, start), HasSubstr("1 analyses and 3 refined views"));
  ViewLabels labels = scene.labels.views[0];
  labels.levels[4] = 24;
  EXPECT_THAT(StartRefinement(scene.job, 0, *scene.analysis[0], labels, nullptr).status().message(),
              HasSubstr("camera 'cam0' has label 24 of 24"));
  labels.levels.pop_back();
  EXPECT_FALSE(StartRefinement(scene.job, 0, *scene.analysis[0], labels, nullptr).ok());
}

TEST(RefineView, StopsWhenAsked) {
  const Scene scene;
  std::stop_source stop;
  stop.request_stop();
  EXPECT_EQ(RefineView(scene.job, 0, 1, scene.analysis, scene.Start(), {.stop = stop.get_token()}).status().code(),
            ErrorCode::kCancelled);
}

TEST(RefinedDepthCodes, ClampToTheRangeAndLeaveOutWhatIsBehindInfinity) {
  const Scene scene;
  const double pixels = RefinementGeometry(scene.job, 0).pixels_per_inverse_depth;
  const DepthRange range = scene.job.views[0].own_range;
  const auto code = [&](double u) {
    const RefinedView view{
        .planes = {{0, 0, static_cast<float>(u)}}, .kept = {0}, .plane_of_pixel = Grid<PlaneIndex>(1, 1)};
    return RefinedDepthCodes(scene.job, 0, view)(0, 0);
  };
  EXPECT_EQ(code(pixels / range.z_near), 65535);
  EXPECT_EQ(code(pixels / range.z_near + 5), 65535);
  EXPECT_EQ(code(pixels / range.z_far), 1);
  EXPECT_EQ(code(-0.9), 1);
  EXPECT_EQ(code(-1.1), 0);
  EXPECT_NEAR(code(0.5 * (pixels / range.z_near + pixels / range.z_far)), 32768, 1);
}

}  // namespace
}  // namespace depthfarm
