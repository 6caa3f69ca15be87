#include "coordinator/service/status_waits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using std::chrono::milliseconds;
using testing::ElementsAre;
using testing::IsEmpty;
using Question = StatusWaits::Question;

constexpr TimePoint kStart{std::chrono::hours(1)};

TEST(StatusWaits, QuestionsAreAnsweredWhenTheirTimeIsOverTheFirstFirst) {
  StatusWaits waits;
  waits.Add({"a", 1, JobId(7)}, kStart + milliseconds(200));
  waits.Add({"b", 2, JobId(7)}, kStart + milliseconds(100));
  waits.Add({"b", 3, JobId(8)}, kStart + milliseconds(300));
  EXPECT_THAT(waits.TakeDue(kStart + milliseconds(99)), IsEmpty());
  EXPECT_THAT(waits.TakeDue(kStart + milliseconds(200)),
              ElementsAre(Question{"b", 2, JobId(7)}, Question{"a", 1, JobId(7)}));
  EXPECT_THAT(waits.TakeDue(kStart + milliseconds(299)), IsEmpty());
  EXPECT_THAT(waits.TakeDue(kStart + milliseconds(1000)), ElementsAre(Question{"b", 3, JobId(8)}));
}

TEST(StatusWaits, ThoseAfterAJobAreTakenOutTogetherAndOnce) {
  StatusWaits waits;
  waits.Add({"a", 1, JobId(7)}, kStart);
  waits.Add({"b", 2, JobId(8)}, kStart);
  waits.Add({"c", 3, JobId(7)}, kStart);
  EXPECT_THAT(waits.TakeOf(JobId(7)), ElementsAre(Question{"a", 1, JobId(7)}, Question{"c", 3, JobId(7)}));
  EXPECT_THAT(waits.TakeOf(JobId(7)), IsEmpty());
  EXPECT_THAT(waits.TakeDue(kStart), ElementsAre(Question{"b", 2, JobId(8)}));
}

TEST(StatusWaits, AreBounded) {
  StatusWaits waits;
  for (std::size_t i = 0; i < StatusWaits::kMost; ++i) {
    EXPECT_FALSE(waits.full());
    waits.Add({"a", i, JobId(7)}, kStart);
  }
  EXPECT_TRUE(waits.full());
  (void)waits.TakeOf(JobId(7));
  EXPECT_FALSE(waits.full());
}

}  // namespace
}  // namespace depthfarm
