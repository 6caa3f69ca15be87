#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "common/job/resolved_job.h"
#include "tests/common/job/line_sequence.h"

namespace depthfarm {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

ResolvedJob Resolved(const Sequence& sequence, const EstimationParams& params = {}) {
  Result<ResolvedJob> job = ResolveJob(sequence, params);
  EXPECT_TRUE(job.ok()) << job.status().message();
  return job.ok() ? std::move(job).value() : ResolvedJob();
}

std::vector<std::string> ViewNames(const ResolvedJob& job) {
  std::vector<std::string> names;
  for (const JobView& view : job.views) names.push_back(view.camera.name);
  return names;
}

TEST(ResolveJobSegments, AutoIsOnePerTwentyPixels) {  // III-B
  for (const JobView& view : Resolved(LineSequence({0, 0.1})).views) EXPECT_EQ(view.segments, 320 * 240 / 20);
}

TEST(ResolveJobSegments, OfLargeRefinedViewsAreLarger) {
  const auto segments = [](int width, int height, int refine_rounds) {
    Sequence sequence = LineSequence({0, 0.1});
    for (SequenceCamera& camera : sequence.cameras) {
      camera.camera.width = width;
      camera.camera.height = height;
    }
    EstimationParams params;
    params.refine_rounds = refine_rounds;
    return Resolved(sequence, params).views[0].segments;
  };
  EXPECT_EQ(segments(1024, 768, 4), 1024 * 768 / 20);
  EXPECT_EQ(segments(2048, 1536, 4), 2 * (1024 * 768 / 20) + 1);  // four times the pixels, twice the segments
  EXPECT_EQ(segments(1920, 1080, 4), 63850);
  EXPECT_EQ(segments(1920, 1080, 0), 1920 * 1080 / 20);  // the paper's
}

TEST(ResolveJob, OneGopForAllFramesIsAsLongAsTheJob) {
  EstimationParams params;
  params.gop = 0;
  const ResolvedJob job = Resolved(LineSequence({0, 0.1}), params);
  EXPECT_EQ(job.params.gop, job.num_frames);
}

TEST(ResolveJob, OnlyViewsWithFilesAreGuided) {
  Sequence sequence = LineSequence({0, 0.1});
  const std::vector<std::string> none(sequence.cameras[0].images.size());
  for (SequenceCamera& camera : sequence.cameras) {
    camera.masks = camera.prior = none;
    camera.prior_format = {PriorFormat::Holds::kDepth, 1, 0, 0};
  }
  sequence.cameras[1].masks.back() = "/m.png";
  sequence.cameras[1].prior.back() = "/p.pfm";
  const ResolvedJob job = Resolved(sequence);
  EXPECT_FALSE(job.views[0].masked);
  EXPECT_TRUE(job.views[1].masked);
  EXPECT_EQ(job.views[0].prior, PriorFormat());
  EXPECT_EQ(job.views[1].prior, sequence.cameras[1].prior_format);
}

TEST(ResolveJobSegments, AutoFollowsTheSizeOfEachView) {
  Sequence sequence = LineSequence({0, 0.1});
  sequence.cameras[1].camera = ForwardCamera("cam1", 0.1, 0, 160, 120, kFocal_px / 2);
  const ResolvedJob job = Resolved(sequence);
  EXPECT_EQ(job.views[0].segments, 3840);
  EXPECT_EQ(job.views[1].segments, 960);
}

TEST(ResolveJobSegments, AreAtLeastOneAndAtMostThePixels) {
  Sequence tiny = LineSequence({0, 0.1});
  for (SequenceCamera& camera : tiny.cameras) {
    camera.camera = ForwardCamera(camera.camera.name, camera.camera.name == "cam0" ? 0 : 0.1, 0, 4, 4, 4);
  }
  EXPECT_EQ(Resolved(tiny).views[0].segments, 1);
  EstimationParams params;
  params.segments = 5000;
  EXPECT_EQ(Resolved(tiny, params).views[0].segments, 16);
  EXPECT_EQ(Resolved(LineSequence({0, 0.1}), params).views[0].segments, 5000);
}

TEST(ResolveJobLevels, AutoIsAPixelAtTheNearestNeighbour) {
  ASSERT_NEAR(DisparityOf(0.4), 47.6, 1e-9);
  EXPECT_EQ(Resolved(LineSequence({0, 0.4})).params.levels, 49);  // 48 steps, between 49 planes
}

TEST(ResolveJobLevels, AutoIsTwoPixelsAtTheWidestBaselineUsed) {
  // Nearest neighbours travel 11.9, 11.9 and 95.2 pixels: a median of 11.9 asks for 12 steps, the widest baseline for
  // 95.2 / 2 = 47.6.
  EXPECT_EQ(Resolved(LineSequence({0, 0.1, 0.9})).params.levels, 49);
}

TEST(ResolveJobLevels, AutoIsFinerWhereThereWouldBeFew) {
  ASSERT_NEAR(DisparityOf(0.1), 11.9, 1e-9);
  EXPECT_EQ(Resolved(LineSequence({0, 0.1, 0.2})).params.levels, 25);  // 24 steps of half a pixel
  EXPECT_EQ(Resolved(LineSequence({0, 0.02})).params.levels, 11);      // 2.38 / 0.25 = 9.5 steps, no finer
}

TEST(ResolveJobLevels, AutoIsAQuarterOfAPixelWhereNothingIsRefined) {
  EstimationParams params;
  params.refine_rounds = 0;
  EXPECT_EQ(Resolved(LineSequence({0, 0.1, 0.2}), params).params.levels, 49);  // 11.9 / 0.25 = 47.6 steps
  EXPECT_EQ(Resolved(LineSequence({0, 0.1, 0.5}), params).params.levels, 97);  // 47.6 / 0.5 = 95.2 steps
}

TEST(ResolveJobLevels, AutoIsAtLeastTwoAndAtMost250) {
  EXPECT_EQ(Resolved(LineSequence({0, 1e-7})).params.levels, 2);
  EstimationParams params;
  params.refine_rounds = 0;
  EXPECT_EQ(Resolved(LineSequence({0, 1.2}), params).params.levels, 250);
}

TEST(ResolveJobLevels, OneAskedForIsKept) {
  EstimationParams params;
  params.levels = 1000;
  const ResolvedJob job = Resolved(LineSequence({0, 0.1}), params);
  EXPECT_EQ(job.params.levels, 1000);
  EXPECT_EQ(job.Levels().count(), 1000);
}

TEST(ResolveJobReference, IsTheCentreCameraOfTheViews) {
  const Sequence sequence = LineSequence({0, 0.1, 0.2, 0.3, 0.4});
  EXPECT_EQ(Resolved(sequence).reference.name, "cam2");
  EstimationParams params;
  params.views = {"cam2", "cam3", "cam4"};
  EXPECT_EQ(Resolved(sequence, params).reference.name, "cam3");
}

TEST(ResolveJobReference, IsTheSequencesEvenWithoutPictures) {
  Sequence sequence = LineSequence({0, 0.1, 0.2});
  sequence.reference = "cam0";
  EXPECT_EQ(Resolved(sequence).reference.name, "cam0");
  sequence.cameras[0].images.clear();
  const ResolvedJob job = Resolved(sequence);
  EXPECT_EQ(job.reference.name, "cam0");
  EXPECT_THAT(ViewNames(job), ElementsAre("cam1", "cam2"));
}

TEST(ResolveJobRange, IsTheParametersThenTheReferencesThenTheSequences) {
  Sequence sequence = LineSequence({0, 0.1, 0.2});
  EXPECT_EQ(Resolved(sequence).params.z_near, kNear);
  EXPECT_EQ(Resolved(sequence).params.z_far, kFar);
  sequence.cameras[0].z_near = 3;  // no reference: of no account
  EXPECT_EQ(Resolved(sequence).params.z_near, kNear);
  sequence.cameras[1].z_near = 4;
  sequence.cameras[1].z_far = 8;
  EXPECT_EQ(Resolved(sequence).params.z_near, 4);
  EXPECT_EQ(Resolved(sequence).params.z_far, 8);
  EstimationParams params;
  params.z_near = 5;
  EXPECT_EQ(Resolved(sequence, params).params.z_near, 5);
  EXPECT_EQ(Resolved(sequence, params).params.z_far, 8);
  params.z_far = 6;
  EXPECT_EQ(Resolved(sequence, params).params.z_far, 6);
}

TEST(ResolveJobRange, NeedsNoRangeOfTheSequenceWhereAnotherIsGiven) {
  Sequence sequence = LineSequence({0, 0.1, 0.2});
  sequence.z_near.reset();
  sequence.z_far.reset();
  EstimationParams params;
  params.z_near = 3;
  params.z_far = 9;
  EXPECT_EQ(Resolved(sequence, params).params.z_far, 9);
  sequence.cameras[1].z_near = 3;
  sequence.cameras[1].z_far = 7;
  EXPECT_EQ(Resolved(sequence).params.z_far, 7);
}

TEST(ResolveJobRange, EachViewGetsItsOwn) {
  Sequence sequence = LineSequence({0, 0.1, 0.2});
  sequence.reference = "cam0";
  sequence.cameras[2].camera.cam_from_world_translation[2] = 0.5;  // half a unit back
  const ResolvedJob job = Resolved(sequence);
  EXPECT_NEAR(job.views[0].own_range.z_near, 2, 1e-12);
  EXPECT_NEAR(job.views[0].own_range.z_far, 10, 1e-12);
  EXPECT_NEAR(job.views[2].own_range.z_near, 2.5, 1e-12);
  EXPECT_NEAR(job.views[2].own_range.z_far, 10.5, 1e-12);
}

TEST(ResolveJobRange, OfAViewBetweenThePlanesStartsAtTheFirstInFrontOfIt) {
  // A parallel view just past the nearest plane, its picture wide enough to hold what the others see.
  Sequence sequence = LineSequence({0, 0.1, 0.2});
  sequence.reference = "cam1";
  sequence.cameras.push_back(CameraWithPictures(ForwardCamera("ahead", 0.1, 0, 320, 240, kFocal_px / 2), 5));
  sequence.cameras.back().camera.cam_from_world_translation[2] = -2.05;
  for (const int levels : {0, 100}) {
    EstimationParams params;
    params.levels = levels;
    const ResolvedJob job = Resolved(sequence, params);
    ASSERT_EQ(job.num_views(), 4);
    EXPECT_NEAR(job.views[3].own_range.z_far, 10 - 2.05, 1e-12);
    double nearest_ahead = kFar;
    for (int level = 0; level < job.params.levels; ++level) {
      const double depth = job.Levels().DepthInRef(level);
      if (depth > 2.05) nearest_ahead = std::min(nearest_ahead, depth);
    }
    EXPECT_NEAR(job.views[3].own_range.z_near, std::max(nearest_ahead - 2.05, kNear / 20), 1e-12);
  }
}

TEST(ResolveJobFrames, AreAllUnlessTold) {
  const ResolvedJob job = Resolved(LineSequence({0, 0.1}, 7));
  EXPECT_EQ(job.num_frames, 7);
  EXPECT_EQ(job.params.first_frame, 0);
  EXPECT_EQ(job.params.end_frame, 7);
}

TEST(ResolveJobFrames, AreThoseAskedFor) {
  EstimationParams params;
  params.first_frame = 2;
  EXPECT_EQ(Resolved(LineSequence({0, 0.1}, 7), params).num_frames, 5);
  params.end_frame = 4;
  EXPECT_EQ(Resolved(LineSequence({0, 0.1}, 7), params).num_frames, 2);
  params.end_frame = 7;
  EXPECT_EQ(Resolved(LineSequence({0, 0.1}, 7), params).num_frames, 5);
}

TEST(ResolveJobViews, AreThoseWithPicturesUnlessTold) {
  Sequence sequence = LineSequence({0, 0.1, 0.2, 0.3});
  sequence.cameras[1].images.clear();
  EXPECT_THAT(ViewNames(Resolved(sequence)), ElementsAre("cam0", "cam2", "cam3"));
}

TEST(ResolveJobViews, AreThoseAskedForInTheOrderOfTheSequence) {
  EstimationParams params;
  params.views = {"cam3", "cam0"};
  EXPECT_THAT(ViewNames(Resolved(LineSequence({0, 0.1, 0.2, 0.3}), params)), ElementsAre("cam0", "cam3"));
}

TEST(ResolveJobViews, NeighboursAreIndicesIntoTheViewsOfTheJob) {
  EstimationParams params;
  params.views = {"cam1", "cam2", "cam4"};
  const ResolvedJob job = Resolved(LineSequence({0, 0.1, 0.2, 0.3, 0.5}), params);
  EXPECT_THAT(job.views[0].neighbours, ElementsAre(1));
  EXPECT_THAT(job.views[1].neighbours, ElementsAre(0, 2));
  EXPECT_THAT(job.views[2].neighbours, ElementsAre(1));
}

TEST(ResolveJobViews, AsManyNeighboursAsAskedFor) {
  EstimationParams params;
  params.neighbours = 3;
  for (const JobView& view : Resolved(LineSequence({0, 0.1, 0.2, 0.3}), params).views) {
    EXPECT_EQ(view.neighbours.size(), 3u);
  }
}

TEST(ResolveJobViews, RefinementComparesWithUpToFourWhateverIsMatched) {
  EstimationParams params;
  params.neighbours = 1;
  const ResolvedJob job = Resolved(LineSequence({0, 0.1, 0.2, 0.3, 0.4, 0.5}), params);
  EXPECT_THAT(job.views[0].compared, SizeIs(4));
  EXPECT_THAT(job.views[2].compared, UnorderedElementsAre(0, 1, 3, 4));
  EXPECT_EQ(job.views[2].compared.front(), job.views[2].neighbours.front());
}

TEST(ResolveJobDownscale, ShrinksPicturesCamerasSegmentsAndLevels) {
  EstimationParams params;
  params.downscale = 2;
  const Sequence sequence = LineSequence({0, 0.1, 0.2});
  const ResolvedJob job = Resolved(sequence, params);
  for (std::size_t i = 0; i < job.views.size(); ++i) {
    const JobView& view = job.views[i];
    EXPECT_EQ(view.source_width, 320);
    EXPECT_EQ(view.source_height, 240);
    EXPECT_EQ(view.camera.width, 160);
    EXPECT_EQ(view.camera.height, 120);
    EXPECT_EQ(view.camera.intrinsics, Downscaled(sequence.cameras[i].camera, 2).intrinsics);
    EXPECT_EQ(view.segments, 160 * 120 / 20);
  }
  EXPECT_EQ(job.reference.width, 160);
  EXPECT_EQ(job.params.levels, 25);  // 5.95 / 0.25 = 23.8 steps
}

TEST(ResolveJobBlocks, SmallProblemsAreNotSplit) {
  const ResolvedJob job = Resolved(LineSequence({0, 0.1, 0.2}));  // 3 x 3840 segments x 25 levels
  EXPECT_EQ(job.level_blocks_i, 1);
  EXPECT_EQ(job.level_blocks_p, 1);
  EXPECT_EQ(job.params.level_blocks, 1);
}

struct Blocks {
  Search search;
  int uniqueness;
  int segments;
  int levels;
  int of_i_frames;
  int of_p_frames;
};

TEST(ResolveJobBlocks, FollowTheSizeOfTheProblem) {
  const Blocks cases[] = {
      {Search::kFull, 75, 10000, 66, 1, 1},     // 3 views: 1.98 million entries
      {Search::kFull, 75, 10000, 67, 8, 1},     // 2.01
      {Search::kFull, 75, 70000, 95, 8, 1},     // 19.95
      {Search::kFull, 75, 70000, 96, 8, 2},     // 20.16
      {Search::kFull, 75, 50000, 16, 2, 1},     // 2.4, of few levels: 8 a block
      {Search::kFull, 75, 70000, 10, 1, 1},     // 2.1
      {Search::kSparse, 75, 70000, 208, 1, 1},  // 43.7
      {Search::kSparse, 75, 70000, 209, 2, 1},  // 43.9
      {Search::kSparse, 0, 70000, 209, 3, 2},   // every match is kept
      {Search::kSparse, 75, 76800, 520, 3, 2},  // 119.8
  };
  for (const Blocks& blocks : cases) {
    EstimationParams params;
    params.search = blocks.search;
    params.uniqueness = blocks.uniqueness;
    params.segments = blocks.segments;
    params.levels = blocks.levels;
    params.refine_rounds = 0;
    const ResolvedJob job = Resolved(LineSequence({0, 0.1, 0.2}), params);
    EXPECT_EQ(job.level_blocks_i, blocks.of_i_frames) << blocks.segments << " x " << blocks.levels;
    EXPECT_EQ(job.level_blocks_p, blocks.of_p_frames) << blocks.segments << " x " << blocks.levels;
    EXPECT_EQ(job.params.level_blocks, job.level_blocks_i);
  }
}

TEST(ResolveJobBlocks, NoPartTakesMoreThanItsBound) {
  EstimationParams params;
  params.refine_rounds = 0;
  params.segments = 76800;
  params.levels = 520;
  const ResolvedJob job = Resolved(LineSequence({0, 0.1, 0.2}), params);
  const std::int64_t bytes = std::int64_t{3} * 76800 * 520 * (4 + 8 * 2 / 4);
  EXPECT_LE(bytes / job.level_blocks_i, kMostBytesOfPart);
  EXPECT_GT(bytes / (job.level_blocks_i - 1), kMostBytesOfPart);
}

TEST(ResolveJobBlocks, LevelsThatAreNotAllTriedTakeNoMemory) {
  EstimationParams params;
  params.segments = 76800;
  params.levels = 520;
  EXPECT_EQ(Resolved(LineSequence({0, 0.1, 0.2}), params).level_blocks_i, 1);
}

TEST(ResolvedJob, TheLastGopMayBeShorter) {
  ResolvedJob job;
  job.num_frames = 7;
  for (const auto& [gop, count] : {std::pair(1, 7), std::pair(3, 3), std::pair(7, 1), std::pair(9, 1)}) {
    job.params.gop = gop;
    EXPECT_EQ(job.num_gops(), count);
  }
  EXPECT_EQ(PartsOnly(4).num_gops(), 4);
}

TEST(SearchStep, IsAsLongAsLevelsThatRefinementNeeds) {
  EstimationParams params;
  params.levels = 250;
  const ResolvedJob job = Resolved(LineSequence({0, 0.4}), params);  // 48 steps, as AutoIsAPixelAtTheNearestNeighbour
  EXPECT_EQ(SearchStep(job, 1), 5);
  EXPECT_EQ(SearchStep(job, 2), 3);  // of a part's levels, which are two apart
  EXPECT_EQ(SearchStep(job, 5), 1);
  EXPECT_EQ(SearchStep(job, 8), 1);
  params.levels = 96;
  EXPECT_EQ(SearchStep(Resolved(LineSequence({0, 0.4}), params), 1), 1);
  params.levels = 97;
  EXPECT_EQ(SearchStep(Resolved(LineSequence({0, 0.4}), params), 1), 2);
  params.levels = 0;
  EXPECT_EQ(SearchStep(Resolved(LineSequence({0, 0.4}), params), 1), 1);
}

TEST(SearchStep, OfContiguousPartsIsThatOfTheWhole) {
  EstimationParams params;
  params.levels = 250;
  params.partition = Partition::kContiguous;
  EXPECT_EQ(SearchStep(Resolved(LineSequence({0, 0.4}), params), 4), 5);
}

TEST(SearchStep, IsOneWhereAllLevelsAreTried) {
  EstimationParams params;
  params.levels = 250;
  params.refine_rounds = 0;
  EXPECT_EQ(SearchStep(Resolved(LineSequence({0, 0.4}), params), 1), 1);
  params.refine_rounds = 4;
  params.search = Search::kFull;
  EXPECT_EQ(SearchStep(Resolved(LineSequence({0, 0.4}), params), 1), 1);
}

TEST(ResolveJobBlocks, AskedForAreThoseOfEveryFrame) {
  EstimationParams params;
  params.level_blocks = 5;
  params.gop = 4;
  const ResolvedJob job = Resolved(LineSequence({0, 0.1, 0.2}, 9), params);
  for (int frame = 0; frame < 9; ++frame) EXPECT_EQ(job.NumBlocks(frame), 5);
}

TEST(ResolvedJob, EveryGopStartsWithAnIFrame) {
  ResolvedJob job;
  job.params.gop = 3;
  job.level_blocks_i = 8;
  job.level_blocks_p = 2;
  for (int frame = 0; frame < 12; ++frame) {
    EXPECT_EQ(job.IsIFrame(frame), frame == 0 || frame == 3 || frame == 6 || frame == 9) << frame;
    EXPECT_EQ(job.IFrameOf(frame), frame / 3 * 3);
    EXPECT_EQ(job.NumBlocks(frame), job.IsIFrame(frame) ? 8 : 2);
  }
  job.params.gop = 1;
  for (int frame = 0; frame < 5; ++frame) EXPECT_TRUE(job.IsIFrame(frame));
}

TEST(ResolvedJob, WithASharedAnchorTheFirstFrameIsTheOnlyIFrame) {
  ResolvedJob job;
  job.params.anchor = Anchor::kShared;
  job.params.gop = 3;
  for (int frame = 0; frame < 12; ++frame) {
    EXPECT_EQ(job.IsIFrame(frame), frame == 0) << frame;
    EXPECT_EQ(job.IFrameOf(frame), 0);
    EXPECT_EQ(job.GopOf(frame), frame / 3);
    if (frame > 0) {
      EXPECT_EQ(job.PreviousOf(frame), frame % 3 == 0 ? 0 : frame - 1);
    }
  }
  job.params.gop = 1;
  job.num_frames = 2;
  EXPECT_TRUE(job.HasPFrames());
  job.num_frames = 1;
  EXPECT_FALSE(job.HasPFrames());
}

TEST(ResolveJob, OrderOfTheCamerasInTheFileChangesNothing) {
  const Sequence sequence = LineSequence({0, 0.1, 0.5, 0.6, 0.65});
  Sequence reversed = sequence;
  std::reverse(reversed.cameras.begin(), reversed.cameras.end());
  const ResolvedJob job = Resolved(sequence);
  const ResolvedJob other = Resolved(reversed);
  EXPECT_EQ(job.params, other.params);
  EXPECT_EQ(job.reference.name, other.reference.name);
  ASSERT_EQ(job.num_views(), other.num_views());
  const int last = job.num_views() - 1;
  for (int i = 0; i <= last; ++i) {
    const JobView& a = job.views[static_cast<std::size_t>(i)];
    const JobView& b = other.views[static_cast<std::size_t>(last - i)];
    EXPECT_EQ(a.camera.name, b.camera.name);
    EXPECT_EQ(a.own_range.z_near, b.own_range.z_near);
    EXPECT_EQ(a.own_range.z_far, b.own_range.z_far);
    std::vector<int> mirrored = b.neighbours;
    for (int& index : mirrored) index = last - index;
    EXPECT_EQ(a.neighbours, mirrored);
  }
}

TEST(ResolveJob, UnitOfLengthChangesOnlyTheRange) {
  const Sequence sequence = LineSequence({0, 0.1, 0.5, 0.6});
  Sequence in_mm = sequence;
  for (SequenceCamera& camera : in_mm.cameras) camera.camera.cam_from_world_translation *= 1000;
  in_mm.z_near = kNear * 1000;
  in_mm.z_far = kFar * 1000;
  const ResolvedJob job = Resolved(sequence);
  const ResolvedJob other = Resolved(in_mm);
  EXPECT_EQ(other.params.levels, job.params.levels);
  EXPECT_EQ(other.level_blocks_i, job.level_blocks_i);
  EXPECT_EQ(other.reference.name, job.reference.name);
  for (std::size_t i = 0; i < job.views.size(); ++i) {
    EXPECT_EQ(other.views[i].neighbours, job.views[i].neighbours);
    EXPECT_NEAR(other.views[i].own_range.z_near, 1000 * job.views[i].own_range.z_near, 1e-9);
  }
}

TEST(ResolveJob, LeavesWhatWasSetAlone) {
  EstimationParams params;
  params.segments = 1234;
  params.levels = 77;
  params.z_near = 3;
  params.z_far = 9;
  params.level_blocks = 4;
  params.first_frame = 1;
  params.end_frame = 3;
  params.views = {"cam0", "cam1"};
  params.partition = Partition::kContiguous;
  EXPECT_EQ(Resolved(LineSequence({0, 0.1, 0.2}), params).params, params);
}

}  // namespace
}  // namespace depthfarm
