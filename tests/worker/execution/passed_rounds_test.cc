#include "worker/execution/passed_rounds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr int kLastRound = 3;

ArtifactKey KeyOf(int frame, int view, int round) {
  return {static_cast<std::uint8_t>(frame), static_cast<std::uint8_t>(view), static_cast<std::uint8_t>(round)};
}

void AddRefined(TaskSpec& spec, int view, int round) {
  TaskInput input;
  input.artifact.key = KeyOf(spec.id.frame, view, round);
  input.role = InputRole::kRefined;
  input.view = view;
  spec.inputs.push_back(input);
}

// Of two views that are compared with each other.
TaskSpec Refine(int frame, int view, int round) {
  TaskSpec spec;
  spec.id = {.job = JobId{1}, .frame = frame, .kind = TaskKind::kRefine, .index = round, .pair = view};
  for (int v = 0; round > 0 && v < 2; ++v) AddRefined(spec, v, round - 1);
  spec.output_key = KeyOf(frame, view, round);
  return spec;
}

TaskSpec Emit(int frame) {
  TaskSpec spec;
  spec.id = {.job = JobId{1}, .frame = frame, .kind = TaskKind::kEmit, .index = 0, .pair = 0};
  for (int v = 0; v < 2; ++v) AddRefined(spec, v, kLastRound);
  return spec;
}

TEST(PassedRounds, OfAViewAreThoseBeforeTheOneItReads) {
  PassedRounds rounds;
  for (int round = 0; round < 2; ++round)
    for (int view = 0; view < 2; ++view) EXPECT_THAT(rounds.PassedBy(Refine(0, view, round)), IsEmpty());
  EXPECT_THAT(rounds.PassedBy(Refine(0, 0, 2)), ElementsAre(KeyOf(0, 0, 0)));
  EXPECT_THAT(rounds.PassedBy(Refine(0, 1, 2)), ElementsAre(KeyOf(0, 1, 0)));
  EXPECT_THAT(rounds.PassedBy(Refine(0, 0, 3)), ElementsAre(KeyOf(0, 0, 1)));
}

TEST(PassedRounds, OfViewsThatOthersRefineOneRoundMoreIsKept) {
  PassedRounds rounds;
  for (int round = 0; round < 3; ++round) (void)rounds.PassedBy(Refine(0, 0, round));
  EXPECT_THAT(rounds.PassedBy(Refine(0, 0, 3)), UnorderedElementsAre(KeyOf(0, 0, 1), KeyOf(0, 1, 0)));
}

TEST(PassedRounds, TheLastOneStaysForTheFramesThatReferToIt) {
  PassedRounds rounds;
  for (int round = 0; round <= kLastRound; ++round)
    for (int view = 0; view < 2; ++view) (void)rounds.PassedBy(Refine(0, view, round));
  EXPECT_THAT(rounds.PassedBy(Emit(0)), UnorderedElementsAre(KeyOf(0, 0, 2), KeyOf(0, 1, 2)));
  EXPECT_THAT(rounds.PassedBy(Emit(0)), IsEmpty());
}

TEST(PassedRounds, OtherFramesAreLeftAlone) {
  PassedRounds rounds;
  for (int round = 0; round < 2; ++round) (void)rounds.PassedBy(Refine(0, 0, round));
  EXPECT_THAT(rounds.PassedBy(Refine(1, 0, 3)), IsEmpty());
  EXPECT_THAT(rounds.PassedBy(Emit(1)), UnorderedElementsAre(KeyOf(1, 0, 2), KeyOf(1, 1, 2)));
}

}  // namespace
}  // namespace depthfarm
