#include "worker/optimization/path_kernels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <vector>

#include "tests/support/every_target.h"
#include "tests/support/random.h"

namespace depthfarm {
namespace {

using test::OnEveryTarget;
using test::Random;
using testing::ElementsAreArray;

using Costs = std::vector<std::int16_t>;

// The header's formula, of each level from all levels.
Costs Plainly(const Costs& path, int step, const Costs& own) {
  const int least = *std::min_element(path.begin(), path.end());
  Costs result;
  for (std::size_t l = 0; l < own.size(); ++l) {
    int cost = kMostPathCost;
    for (std::size_t other = 0; other < own.size(); ++other) {
      const int way = std::abs(static_cast<int>(l) - static_cast<int>(other));
      cost = std::min(cost, path[other] - least + step * way);
    }
    result.push_back(static_cast<std::int16_t>(cost + own[l]));
  }
  return result;
}

TEST(FollowPath, IsTheFormulaOnEveryTarget) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const std::size_t levels = kPathBlock * static_cast<std::size_t>(random.Int(1, 12));
    const int step = seed % 5 == 0 ? kMostPathCost : random.Int(0, seed % 2 == 0 ? 40 : kMostPathCost);
    const int highest = seed % 3 == 0 ? kMostPathCost : 300;
    Costs path;
    Costs own;
    Costs sum;
    for (std::size_t l = 0; l < levels; ++l) {
      path.push_back(static_cast<std::int16_t>(random.Int(-1000, highest)));
      own.push_back(static_cast<std::int16_t>(random.Int(-1000, 0)));
      sum.push_back(static_cast<std::int16_t>(random.Int(-3000, 12000)));
    }
    const Costs expected = Plainly(path, step, own);
    Costs expected_sum;
    for (std::size_t l = 0; l < levels; ++l) expected_sum.push_back(static_cast<std::int16_t>(sum[l] + expected[l]));
    OnEveryTarget([&] {
      Costs followed = path;
      followed.resize(2 * levels, -999);
      Costs added = sum;
      FollowPath(followed, step, own, added);
      followed.resize(levels);
      EXPECT_THAT(followed, ElementsAreArray(expected));
      EXPECT_THAT(added, ElementsAreArray(expected_sum));
    });
  }
}

}  // namespace
}  // namespace depthfarm
