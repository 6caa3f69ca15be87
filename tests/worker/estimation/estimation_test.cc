#include "worker/estimation/estimation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/reprojection.h"
#include "common/image/depth_code.h"
#include "common/job/level_partition.h"
#include "tests/support/cut_oracle.h"
#include "tests/support/rendered_sequence.h"
#include "worker/estimation/frame_problem.h"

namespace depthfarm {
namespace {

using test::RenderedSequence;

EstimationParams SmallParams() {
  EstimationParams params;
  params.segments = 700;
  params.levels = 24;
  params.level_blocks = 1;
  return params;
}

// Rendered once for the whole file: three cameras on an arc, 160 x 120, two frames.
const RenderedSequence& Scene() {
  static const RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, 160, 120, 2, 7, 1.5);
  return rendered;
}

ResolvedJob SmallJob(const EstimationParams& params) { return ResolveJob(Scene().sequence, params).value(); }

TemporalReferences SelfReferences(const FrameAnalysis& analysis, const LabelField& labels) {
  const auto shared = std::make_shared<LabelField>(labels);
  return {analysis, shared, analysis, shared};
}

// Share of pixels whose point lands more than one pixel from the true one in the nearest neighbour, in percent.
double BadPixels(const ResolvedJob& job, int view_index, const Grid<std::uint16_t>& codes, const DepthMap& exact) {
  const JobView& view = job.views[static_cast<std::size_t>(view_index)];
  const DepthCode code = DepthCode::Create(view.own_range.z_near, view.own_range.z_far).value();
  const Reprojection neighbour_from_view(view.camera, job.views[static_cast<std::size_t>(view.neighbours[0])].camera);
  int bad = 0;
  for (int y = 0; y < codes.height(); ++y) {
    for (int x = 0; x < codes.width(); ++x) {
      const Reprojection::Projected truth = neighbour_from_view.Project(x, y, 1.0 / double{exact(x, y)});
      const Reprojection::Projected found = neighbour_from_view.Project(x, y, code.ToInverseDepth(codes(x, y)));
      if (std::hypot(truth.x - found.x, truth.y - found.y) > 1.0) ++bad;
    }
  }
  return 100.0 * bad / static_cast<double>(codes.size());
}

TEST(EstimateBlock, FindsTheDepthOfARenderedScene) {
  const ResolvedJob job = SmallJob(SmallParams());
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const LabelField field = test::EstimateFrame(job, analysis, nullptr, 1);
  for (int view = 0; view < job.num_views(); ++view) {
    const auto v = static_cast<std::size_t>(view);
    const Grid<std::uint16_t> codes = DepthCodes(job, view, analysis[v]->segments.labels, field.views[v]);
    // 160 x 120 pixels, two frames of a few pixels' disparity, segments of 27 pixels: 14 % at the borders that no other
    // view sees, the rest at silhouettes.
    EXPECT_LT(BadPixels(job, view, codes, Scene().depth[0][v]), 25.0) << "view " << view;
  }
}

TEST(EstimateBlock, LabelsAreThoseOfTheOracleOnARealProblem) {
  EstimationParams params = SmallParams();
  params.segments = 150;
  params.levels = 10;
  params.search = Search::kFull;
  params.max_sweeps = 0;
  const ResolvedJob job = SmallJob(params);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  EstimationStats stats;
  const LabelField field = EstimateBlock(job, analysis, nullptr, {}, {.stats = &stats}).value();

  const FrameProblem frame(job, analysis);
  LabellingProblem problem;
  problem.num_nodes = frame.num_nodes();
  for (int level = 0; level < params.levels; ++level) problem.levels.push_back(static_cast<Level>(level));
  problem.matches_per_node = frame.matches_per_node();
  problem.smoothness = frame.smoothness();
  problem.matches = frame.MatchesOnLevels(problem.levels, {});
  problem.fixed.assign(frame.num_nodes(), 0);
  std::vector<Level> labels(frame.num_nodes(), 0);
  WinnerTakesAll(problem, labels);
  for (int sweep = 0;; ++sweep) {
    const std::vector<Level> before = labels;
    for (int step = 0; step < params.levels; ++step) {
      const int level = sweep % 2 == 0 ? step : params.levels - 1 - step;
      labels = test::ExpandPlainly(problem, labels, static_cast<Level>(level));
    }
    if (labels == before) break;
  }
  EXPECT_EQ(frame.ToNodes(field), labels);
  EXPECT_EQ(stats.energy, test::EnergyPlainly(problem, labels));
}

TEST(EstimateBlock, DoesNotDependOnTheOrderOfTheViewsOrTheUnitOfLength) {
  const ResolvedJob job = SmallJob(SmallParams());
  const LabelField field = test::EstimateFrame(job, test::Analyse(Scene(), job, 0), nullptr, 1);

  RenderedSequence turned = Scene();
  std::reverse(turned.sequence.cameras.begin(), turned.sequence.cameras.end());
  std::reverse(turned.pictures[0].begin(), turned.pictures[0].end());
  for (SequenceCamera& camera : turned.sequence.cameras) camera.camera.cam_from_world_translation *= 4;
  *turned.sequence.z_near *= 4;
  *turned.sequence.z_far *= 4;
  const ResolvedJob turned_job = ResolveJob(turned.sequence, SmallParams()).value();
  LabelField turned_field = test::EstimateFrame(turned_job, test::Analyse(turned, turned_job, 0), nullptr, 1);
  std::reverse(turned_field.views.begin(), turned_field.views.end());
  EXPECT_EQ(turned_field, field);
}

TEST(EstimateBlock, HoldsOnlyLevelsOfItsBlock) {
  EstimationParams params = SmallParams();
  for (const Partition partition : {Partition::kContiguous, Partition::kInterleaved}) {
    params.partition = partition;
    const ResolvedJob job = SmallJob(params);
    const LabelField field =
        EstimateBlock(job, test::Analyse(Scene(), job, 0), nullptr, {.count = 4, .index = 1}).value();
    for (const ViewLabels& view : field.views) {
      for (const Level level : view.levels) {
        EXPECT_TRUE(partition == Partition::kContiguous ? level >= 6 && level < 12 : level % 4 == 1) << level;
      }
    }
  }
}

TEST(EstimateBlock, APFrameEqualToItsReferencesKeepsAllDepth) {
  const ResolvedJob job = SmallJob(SmallParams());
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  LabelField field = test::EstimateFrame(job, analysis, nullptr, 1);
  const TemporalReferences references = SelfReferences(analysis, field);
  EstimationStats stats;
  const LabelField p_field = EstimateBlock(job, analysis, &references, {}, {.stats = &stats}).value();
  EXPECT_EQ(stats.nodes, 0);
  for (std::size_t v = 0; v < field.views.size(); ++v) {
    EXPECT_EQ(p_field.views[v].levels, field.views[v].levels);
    EXPECT_TRUE(std::all_of(p_field.views[v].unchanged.begin(), p_field.views[v].unchanged.end(),
                            [](auto u) { return u == 1; }));
  }
}

TEST(EstimateBlock, UnchangedSegmentsOfAPFrameKeepTheirDepthInEveryBlockAndMerge) {
  const ResolvedJob job = SmallJob(SmallParams());
  const FrameAnalysis first = test::Analyse(Scene(), job, 0);
  const FrameAnalysis second = test::Analyse(Scene(), job, 1);
  const TemporalReferences references = SelfReferences(first, test::EstimateFrame(job, first, nullptr, 1));
  const LabelField whole = test::EstimateFrame(job, second, &references, 1);
  const LabelField merged = test::EstimateFrame(job, second, &references, 3);
  std::size_t unchanged = 0;
  std::size_t changed = 0;
  for (std::size_t v = 0; v < whole.views.size(); ++v) {
    EXPECT_EQ(whole.views[v].unchanged, merged.views[v].unchanged);
    for (std::size_t s = 0; s < whole.views[v].levels.size(); ++s) {
      if (whole.views[v].unchanged[s] == 0) {
        ++changed;
        continue;
      }
      ++unchanged;
      EXPECT_EQ(whole.views[v].levels[s], merged.views[v].levels[s]);
    }
  }
  EXPECT_GT(unchanged, changed);  // only persons move and noise is below T_P for most means
  EXPECT_GT(changed, 0U);
}

// Unchanged segments have no node in the graph and no matches but on their own level: the moves are those of the whole
// problem, move by move.
TEST(EstimateBlock, LabelsOfAPFrameAreThoseOfTheWholeProblem) {
  EstimationParams params = SmallParams();
  params.search = Search::kFull;
  params.max_sweeps = 2;
  const ResolvedJob job = SmallJob(params);
  const FrameAnalysis first = test::Analyse(Scene(), job, 0);
  const FrameAnalysis second = test::Analyse(Scene(), job, 1);
  const TemporalReferences references = SelfReferences(first, test::EstimateFrame(job, first, nullptr, 1));
  EstimationStats stats;
  const LabelField field = EstimateBlock(job, second, &references, {}, {.stats = &stats}).value();
  ASSERT_GT(stats.nodes, 0);
  ASSERT_LT(stats.nodes, stats.segments);

  const FrameProblem frame(job, second);
  LabellingProblem problem;
  problem.num_nodes = frame.num_nodes();
  problem.levels = LevelsOfBlock(job.params.levels, 1, job.params.partition, 0);
  problem.matches_per_node = frame.matches_per_node();
  problem.smoothness = frame.smoothness();
  problem.matches = frame.MatchesOnLevels(problem.levels, {});
  for (const ViewLabels& view : field.views)
    problem.fixed.insert(problem.fixed.end(), view.unchanged.begin(), view.unchanged.end());
  std::vector<Level> labels = frame.ToNodes(field);
  WinnerTakesAll(problem, labels);
  for (int step = 0; step < 2 * job.params.levels; ++step) {
    const int level = step < job.params.levels ? step : 2 * job.params.levels - 1 - step;
    labels = test::ExpandPlainly(problem, labels, static_cast<Level>(level));
  }
  EXPECT_EQ(frame.ToNodes(field), labels);
  problem.matches = frame.MatchesOnLevels(problem.levels, problem.fixed, labels, {});  // less what is constant
  EXPECT_EQ(stats.energy, test::EnergyPlainly(problem, labels));
}

TEST(EstimateBlock, RefusesAnalysesThatDoNotFitTheJob) {
  const ResolvedJob job = SmallJob(SmallParams());
  FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  EXPECT_EQ(EstimateBlock(job, analysis, nullptr, {.count = 25, .index = 0}).status().code(),
            ErrorCode::kInvalidArgument);
  EXPECT_EQ(EstimateBlock(job, analysis, nullptr, {.count = 2, .index = 2}).status().code(),
            ErrorCode::kInvalidArgument);
  auto smaller = std::make_shared<ViewAnalysis>(*analysis[1]);
  smaller->segments.labels = Grid<SegmentIndex>(8, 8);
  analysis[1] = smaller;
  EXPECT_EQ(EstimateBlock(job, analysis, nullptr, {}).status().code(), ErrorCode::kInvalidArgument);
  analysis.pop_back();
  EXPECT_EQ(EstimateBlock(job, analysis, nullptr, {}).status().code(), ErrorCode::kInvalidArgument);
}

TEST(EstimateBlock, StopsWhenAsked) {
  const ResolvedJob job = SmallJob(SmallParams());
  std::stop_source stop;
  stop.request_stop();
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  EXPECT_EQ(EstimateBlock(job, analysis, nullptr, {}, {.stop = stop.get_token()}).status().code(),
            ErrorCode::kCancelled);
}

// Two frames at levels a third of a pixel apart, of which only some are tried at first.
TEST(EstimateBlock, LevelsFinerThanAPixelAreFoundInSteps) {
  EstimationParams params = SmallParams();
  params.levels = 100;
  const ResolvedJob job = SmallJob(params);
  ASSERT_GT(SearchStep(job, 1), 1);
  ResolvedJob all_tried = job;
  all_tried.params.refine_rounds = 0;
  ASSERT_EQ(SearchStep(all_tried, 1), 1);
  const FrameAnalysis first = test::Analyse(Scene(), job, 0);
  const LabelField field = test::EstimateFrame(job, first, nullptr, 1);
  EXPECT_EQ(FrameProblem(job, first).ToNodes(field),
            FrameProblem(job, first).ToNodes(test::EstimateFrame(job, first, nullptr, 1)));
  const auto energy = static_cast<double>(test::EnergyOfField(job, first, field));
  const LabelField whole = test::EstimateFrame(all_tried, first, nullptr, 1);
  EXPECT_LT(energy, 0.99 * static_cast<double>(test::EnergyOfField(job, first, whole)));  // both are negative
  const std::vector<Level>& levels = field.views[0].levels;
  for (int remainder = 0; remainder < SearchStep(job, 1); ++remainder) {
    EXPECT_TRUE(std::any_of(levels.begin(), levels.end(),
                            [&](Level level) { return level % SearchStep(job, 1) == remainder; }));
  }

  const FrameAnalysis second = test::Analyse(Scene(), job, 1);
  const TemporalReferences references = SelfReferences(first, field);
  EstimationStats stats;
  const LabelField next = EstimateBlock(job, second, &references, {}, {.stats = &stats}).value();
  ASSERT_GT(stats.nodes, 0);
  ASSERT_LT(stats.nodes, stats.segments);
  // Unchanged segments count as on a level that is tried, but keep their own.
  int between = 0;
  for (const ViewLabels& view : next.views) {
    for (std::size_t i = 0; i < view.levels.size(); ++i) {
      const bool tried = view.levels[i] % SearchStep(job, 1) == SearchStep(job, 1) / 2;
      between += view.unchanged[i] != 0 && !tried ? 1 : 0;
    }
  }
  EXPECT_GT(between, 0);
}

class MergedBlocks : public testing::TestWithParam<std::tuple<int, Partition>> {};

TEST_P(MergedBlocks, LoseLittleEnergyAgainstOneBlock) {  // Table VI: no visible loss up to 6 threads
  const auto [num_blocks, partition] = GetParam();
  EstimationParams params = SmallParams();
  params.partition = partition;
  const ResolvedJob job = SmallJob(params);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  std::int64_t whole = 0;
  (void)test::EstimateFrame(job, analysis, nullptr, 1, &whole);
  std::int64_t merged = 0;
  const LabelField field = test::EstimateFrame(job, analysis, nullptr, num_blocks, &merged);
  EXPECT_EQ(merged, test::EnergyOfField(job, analysis, field));
  // Energies are negative. 24 levels in 8 blocks is 3 levels a block; at 250 levels the loss is below 0.4 %.
  EXPECT_LT(static_cast<double>(merged), 0.97 * static_cast<double>(whole));
}

INSTANTIATE_TEST_SUITE_P(BothPartitions, MergedBlocks,
                         testing::Combine(testing::Values(2, 3, 4, 6, 8),
                                          testing::Values(Partition::kContiguous, Partition::kInterleaved)));

TEST(DepthCodes, AreTheIntersectionOfEachRayWithItsPlane) {
  const ResolvedJob job = SmallJob(SmallParams());
  const DepthLevels levels = job.Levels();
  for (int view = 0; view < job.num_views(); ++view) {
    const Camera& camera = job.views[static_cast<std::size_t>(view)].camera;
    const DepthRange range = job.views[static_cast<std::size_t>(view)].own_range;
    const Grid<SegmentIndex> one_segment(camera.width, camera.height, 0);
    const Grid<std::uint16_t> codes = DepthCodes(job, view, one_segment, {{11}, {0}});
    for (const auto& [x, y] : {std::pair{0, 0}, {159, 0}, {80, 60}, {31, 119}}) {
      // The point at the decoded depth on the pixel's ray, in the reference camera: its z is the level's.
      const double z = DepthCode::Create(range.z_near, range.z_far)->ToInverseDepth(codes(x, y));
      const Eigen::Vector3d ray = InverseIntrinsics(camera.intrinsics) * Eigen::Vector3d(x, y, 1);
      const Eigen::Vector3d point =
          camera.cam_from_world_rotation.transpose() * (ray / z - camera.cam_from_world_translation);
      EXPECT_NEAR(levels.DepthInRefOf(point), levels.DepthInRef(11), 1e-4 * levels.DepthInRef(11));
    }
  }
}

TEST(MergeLabels, RefusesLabelsThatDoNotFit) {
  const ResolvedJob job = SmallJob(SmallParams());
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const LabelField field = EstimateBlock(job, analysis, nullptr, {.count = 2, .index = 0}).value();
  LabelField wrong = field;
  wrong.views[0].levels[0] = 24;
  EXPECT_EQ(MergeLabels(job, analysis, field, wrong).status().code(), ErrorCode::kInvalidArgument);
  wrong = field;
  wrong.views.pop_back();
  EXPECT_EQ(MergeLabels(job, analysis, wrong, field).status().code(), ErrorCode::kInvalidArgument);
  wrong = field;
  wrong.views[1].unchanged[3] = 1;
  EXPECT_EQ(MergeLabels(job, analysis, field, wrong).status().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
