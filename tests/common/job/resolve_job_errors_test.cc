#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "common/job/resolved_job.h"
#include "tests/common/job/line_sequence.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// The message of the refusal; empty, and a failure of the test, if there is none.
std::string Refusal(const Sequence& sequence, const EstimationParams& params = {}) {
  const Result<ResolvedJob> job = ResolveJob(sequence, params);
  EXPECT_EQ(job.status().code(), ErrorCode::kInvalidArgument);
  return job.status().message();
}

EstimationParams WithViews(const std::vector<std::string>& views) {
  EstimationParams params;
  params.views = views;
  return params;
}

TEST(ResolveJobErrors, ParametersOutsideTheirBounds) {
  EstimationParams params;
  params.gop = -1;
  EXPECT_THAT(Refusal(LineSequence({0, 0.1}), params), HasSubstr("gop is -1"));
}

TEST(ResolveJobErrors, UnknownView) {
  EXPECT_THAT(Refusal(LineSequence({0, 0.1}), WithViews({"cam0", "cam1", "cam7"})),
              HasSubstr("views names 'cam7', which is no camera of the sequence: it has cam0, cam1"));
}

TEST(ResolveJobErrors, UnknownViewOfALargeArray) {
  std::vector<double> places(20);
  std::iota(places.begin(), places.end(), 0);
  for (double& place : places) place *= 0.1;
  EXPECT_THAT(Refusal(LineSequence(places), WithViews({"cam77"})), HasSubstr("cam10, cam11, ..."));
}

TEST(ResolveJobErrors, ViewWithoutPicturesAskedFor) {
  Sequence sequence = LineSequence({0, 0.1, 0.2});
  sequence.cameras[1].images.clear();
  EXPECT_THAT(Refusal(sequence, WithViews({"cam0", "cam1"})), HasSubstr("'cam1' is asked for by views but has no"));
}

TEST(ResolveJobErrors, FewerThanTwoViews) {
  Sequence sequence = LineSequence({0, 0.1});
  EXPECT_THAT(Refusal(sequence, WithViews({"cam1"})), HasSubstr("at least two views with pictures, there are 1"));
  sequence.cameras[0].images.clear();
  EXPECT_THAT(Refusal(sequence), HasSubstr("there are 1"));
  EXPECT_THAT(Refusal(Sequence()), HasSubstr("there are 0"));
}

TEST(ResolveJobErrors, UnknownReference) {
  Sequence sequence = LineSequence({0, 0.1});
  sequence.reference = "centre";
  EXPECT_THAT(Refusal(sequence), HasSubstr("reference is 'centre'"));
}

TEST(ResolveJobErrors, BrokenCameraOfAViewOrOfTheReference) {
  Sequence sequence = LineSequence({0, 0.1, 0.2});
  sequence.cameras[2].camera.intrinsics(0, 0) = -1;
  EXPECT_THAT(Refusal(sequence), HasSubstr("camera 'cam2': focal lengths"));
  sequence.reference = "cam2";
  sequence.cameras[2].images.clear();
  EXPECT_THAT(Refusal(sequence), HasSubstr("camera 'cam2': focal lengths"));
}

TEST(ResolveJobErrors, PicturesTooSmallForRefinement) {
  Sequence sequence = LineSequence({0, 0.1});
  sequence.cameras[1].camera.height = 1;
  EXPECT_THAT(Refusal(sequence), HasSubstr("camera 'cam1' is 320x1: refinement needs pictures of at least 2x2 pixels: "
                                           "use --refine 0"));
  sequence.cameras[1].camera.height = 2;
  EstimationParams params;
  params.downscale = 2;
  EXPECT_THAT(Refusal(sequence, params), HasSubstr("160x1 after downscale"));
  EXPECT_THAT(Refusal(sequence, params), HasSubstr("or a smaller --downscale"));
  params.refine_rounds = 0;
  EXPECT_THAT(ResolveJob(sequence, params).status().message(), Not(HasSubstr("refine")));
}

TEST(ResolveJobErrors, NoDepthRange) {
  Sequence sequence = LineSequence({0, 0.1});
  sequence.z_far.reset();
  EXPECT_THAT(Refusal(sequence), HasSubstr("no depth range"));
  sequence.z_far = kFar;
  sequence.z_near.reset();
  EXPECT_THAT(Refusal(sequence), HasSubstr("--z-near"));
}

TEST(ResolveJobErrors, RangeOfTwoSourcesThatDoNotFit) {
  EstimationParams params;
  params.z_near = 20;  // the sequence's zFar is 10
  EXPECT_THAT(Refusal(LineSequence({0, 0.1}), params), HasSubstr("zNear 20, zFar 10"));
}

TEST(ResolveJobErrors, FramesOutsideTheSequence) {
  EstimationParams params;
  params.end_frame = 6;
  EXPECT_THAT(Refusal(LineSequence({0, 0.1}, 5), params), HasSubstr("frames 0:6 are asked for, the sequence has 0:5"));
  params.first_frame = 5;
  params.end_frame = -1;
  EXPECT_THAT(Refusal(LineSequence({0, 0.1}, 5), params), HasSubstr("has 0:5"));
}

TEST(ResolveJobErrors, ViewsWithDifferentNumbersOfPictures) {
  Sequence sequence = LineSequence({0, 0.1, 0.2}, 5);
  sequence.cameras[1].images.pop_back();
  EXPECT_THAT(Refusal(sequence), HasSubstr("camera 'cam1' has 4 pictures, camera 'cam0' has 5"));
}

TEST(ResolveJobErrors, ViewThatFacesAway) {
  Sequence sequence = LineSequence({0, 0.1, 0.2});
  sequence.reference = "cam0";
  Camera& away = sequence.cameras[2].camera;
  away.cam_from_world_rotation = Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  away.cam_from_world_translation.setZero();
  EXPECT_THAT(Refusal(sequence), HasSubstr("camera 'cam2' does not see the depth planes"));
}

TEST(ResolveJobErrors, ViewWithoutANeighbour) {
  EXPECT_THAT(Refusal(LineSequence({0, 0.1, 9})), HasSubstr("camera 'cam2' has no neighbour"));
  EXPECT_THAT(Refusal(LineSequence({0, 0})), HasSubstr("camera 'cam0' has no neighbour"));
}

TEST(ResolveJobErrors, MoreLevelBlocksThanLevels) {
  EstimationParams params;
  params.level_blocks = 26;  // auto gives 25 levels
  EXPECT_THAT(Refusal(LineSequence({0, 0.1}), params),
              HasSubstr("level-blocks is 26, expected at most the number of levels, 25"));
  params.level_blocks = 25;
  EXPECT_TRUE(ResolveJob(LineSequence({0, 0.1}), params).ok());
}

TEST(ResolveJobErrors, PictureTooSmallForTheDownscale) {
  Sequence sequence = LineSequence({0, 0.1});
  for (SequenceCamera& camera : sequence.cameras) camera.camera.height = 3;
  EstimationParams params;
  params.downscale = 4;
  EXPECT_THAT(Refusal(sequence, params), HasSubstr("size is 80x0"));
}

}  // namespace
}  // namespace depthfarm
