#include "coordinator/scheduling/fair_share.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace depthfarm {
namespace {

using testing::ElementsAre;

TEST(FairOrder, PriorityBeforeAllElse) {
  EXPECT_THAT(FairOrder({{JobId(1), 0, 0, 0}, {JobId(2), 3, 9, 90}, {JobId(3), std::numeric_limits<int>::min(), 0, 0}}),
              ElementsAre(JobId(2), JobId(1), JobId(3)));
}

TEST(FairOrder, OfEqualPriorityTheOneWithFewestLeases) {
  EXPECT_THAT(FairOrder({{JobId(1), 0, 2, 1}, {JobId(2), 0, 1, 9}}), ElementsAre(JobId(2), JobId(1)));
}

TEST(FairOrder, ThenTheOneThatWaitedLongestThenTheOldest) {
  EXPECT_THAT(FairOrder({{JobId(4), 0, 1, 7}, {JobId(2), 0, 1, 5}, {JobId(3), 0, 1, 5}}),
              ElementsAre(JobId(2), JobId(3), JobId(4)));
}

TEST(FairOrder, AJobThatEndsIsOverFirst) {
  EXPECT_THAT(FairOrder({{JobId(1), 9, 0, 0, false}, {JobId(2), 0, 5, 7, true}}), ElementsAre(JobId(2), JobId(1)));
}

TEST(FairOrder, NothingOfNothing) { EXPECT_TRUE(FairOrder({}).empty()); }

TEST(ReadyShare, IsRoundedUpAndNeverNone) {
  EXPECT_EQ(ReadyShare(8, 3), 3U);
  EXPECT_EQ(ReadyShare(2, 100), 1U);
  EXPECT_EQ(ReadyShare(8, 0), 8U);
}

}  // namespace
}  // namespace depthfarm
