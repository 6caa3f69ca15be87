#include "worker/cost/uniqueness.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

namespace depthfarm {
namespace {

using testing::SizeIs;

DepthLevels Levels() {
  Camera reference;
  reference.name = "cam";
  reference.width = 64;
  reference.height = 48;
  reference.intrinsics << 100, 0, 31.5, 0, 100, 23.5, 0, 0, 1;
  return DepthLevels::Create(reference, 2, 10, 50).value();
}

TEST(FloorPlanes, AreSpreadEvenlyOverTheRange) {
  const std::vector<double> planes = FloorPlanes(Levels(), 40);
  ASSERT_THAT(planes, SizeIs(kFloorPlanes));
  for (std::size_t i = 0; i < planes.size(); ++i) {
    EXPECT_NEAR(planes[i], 0.1 + 0.4 * (static_cast<double>(i) + 0.5) / kFloorPlanes, 1e-12);
  }
}

TEST(FloorPlanes, ReachBeyondARangeOfFewPixels) {
  const std::vector<double> planes = FloorPlanes(Levels(), 8);  // a quarter of 32: four times as far
  EXPECT_NEAR(planes[1] - planes[0], 4 * 0.4 / kFloorPlanes, 1e-12);
  EXPECT_NEAR(planes.front() + planes.back(), 0.1 + 0.5, 1e-12);  // to either side
  EXPECT_LT(planes.front(), 0);                                   // beyond infinity
}

TEST(FloorPlanes, StayInTheRangeWhereItIsNotKnownInPixels) {
  EXPECT_EQ(FloorPlanes(Levels(), 0), FloorPlanes(Levels(), 32));
}

TEST(RewardFloor, IsThePercentileOfTheRewards) {
  std::vector<std::uint16_t> rewards = {50, 10, 40, 20, 30};
  EXPECT_EQ(RewardFloor(rewards, 0), 10);
  EXPECT_EQ(RewardFloor(rewards, 50), 30);
  EXPECT_EQ(RewardFloor(rewards, 75), 40);
  EXPECT_EQ(RewardFloor(rewards, 99), 40);  // below 100 the largest of five is out of reach: something stays rewarded
  std::vector<std::uint16_t> one = {7};
  EXPECT_EQ(RewardFloor(one, 99), 7);
}

TEST(RewardFloor, IsThatOfSortedRewards) {
  std::mt19937 random(5);  // NOLINT(cert-msc32-c,cert-msc51-cpp): the same cases every time
  for (int round = 0; round < 200; ++round) {
    std::vector<std::uint16_t> rewards(1 + random() % 32);
    for (std::uint16_t& reward : rewards) reward = static_cast<std::uint16_t>(random() % 40);
    std::vector<std::uint16_t> sorted = rewards;
    std::sort(sorted.begin(), sorted.end());
    const int percent = static_cast<int>(random() % 100);
    const std::size_t index = (sorted.size() - 1) * static_cast<std::size_t>(percent) / 100;
    EXPECT_EQ(RewardFloor(rewards, percent), sorted[index]);
  }
}

}  // namespace
}  // namespace depthfarm
