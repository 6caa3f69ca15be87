#include "worker/estimation/reward_floors.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/support/rendered_sequence.h"

namespace depthfarm {
namespace {

const test::RenderedSequence& Scene() {
  static const test::RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, 48, 36, 1, 3, 1.5);
  return rendered;
}

ResolvedJob Job(int uniqueness) {
  EstimationParams params;
  params.segments = 40;
  params.levels = 12;
  params.uniqueness = uniqueness;
  return ResolveJob(Scene().sequence, params).value();
}

TEST(FloorMemory, KeepsTheFloorsOfAFrame) {
  FloorMemory memory;
  const ResolvedJob job = Job(75);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const FrameAnalysis other = test::Analyse(Scene(), job, 0);
  const auto floors = memory.Of(job, analysis);
  EXPECT_NE(memory.Of(job, other), floors);  // equal, but how should it know
  EXPECT_EQ(memory.Of(job, analysis), floors);
  EXPECT_EQ(memory.Of(Job(75), analysis), floors);
}

TEST(FloorMemory, AnotherJobHasOtherFloors) {
  FloorMemory memory;
  const ResolvedJob job = Job(75);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const auto floors = memory.Of(job, analysis);
  EXPECT_NE(memory.Of(Job(50), analysis), floors);
  ResolvedJob moved = job;
  moved.views[1].camera.cam_from_world_translation.x() += 0.01;
  EXPECT_NE(memory.Of(moved, analysis), floors);
  ResolvedJob neighbours = job;
  neighbours.views[1].neighbours.pop_back();
  EXPECT_NE(memory.Of(neighbours, analysis), floors);
  ResolvedJob turned = job;
  turned.reference.cam_from_world_translation.z() += 0.01;
  EXPECT_NE(memory.Of(turned, analysis), floors);
}

TEST(FloorMemory, ForgetsFramesThatWereNotUsedForLong) {
  FloorMemory memory;
  const ResolvedJob job = Job(75);
  const FrameAnalysis first = test::Analyse(Scene(), job, 0);
  const std::weak_ptr<RewardFloors> floors = memory.Of(job, first);
  for (int frame = 0; frame < 3; ++frame) (void)memory.Of(job, test::Analyse(Scene(), job, 0));
  EXPECT_FALSE(floors.expired());
  (void)memory.Of(job, test::Analyse(Scene(), job, 0));
  EXPECT_TRUE(floors.expired());
}

TEST(RewardFloors, KeepWhatWasMeasuredAsLongAsTheirNumberStays) {
  RewardFloors floors;
  floors.Resize(3);
  EXPECT_EQ(floors[2], RewardFloors::kNotMeasured);
  floors[2] = 7;
  floors.Resize(3);
  EXPECT_EQ(floors[2], 7);
}

}  // namespace
}  // namespace depthfarm
