#include "worker/cost/match_kernels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/every_target.h"
#include "tests/support/random.h"
#include "worker/cost/matching.h"

namespace depthfarm {
namespace {

using test::OnEveryTarget;
using test::Random;
using testing::ElementsAreArray;

YcbcrImage RandomPicture(Random& random, int width, int height) {
  YcbcrImage picture(width, height);
  const auto grey = [&] { return static_cast<std::uint8_t>(random.Int(0, 255)); };
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) picture(x, y) = {grey(), grey(), grey(), grey()};  // a matte is not compared
  }
  return picture;
}

PixelPosition Plainly(const EpipolarLine& line, double factor) {
  const double inverse = line.slope * factor;
  const double qx = line.at_infinity[0] + line.per_inverse_depth[0] * inverse;
  const double qy = line.at_infinity[1] + line.per_inverse_depth[1] * inverse;
  const double qz = line.at_infinity[2] + line.per_inverse_depth[2] * inverse;
  const double x = qx / qz;
  const double y = qy / qz;
  if (!(qz > 0) || !(x >= -0.5) || !(y >= -0.5) || !(x < line.width - 0.5) || !(y < line.height - 0.5)) {
    return kNoTarget;
  }
  return {static_cast<std::int32_t>(std::floor(x + 0.5)), static_cast<std::int32_t>(std::floor(y + 0.5))};
}

TEST(ProjectOntoLine, IsTheSameOnEveryTarget) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    EpipolarLine line;
    const auto real = [&](int range) { return random.Int(-1000 * range, 1000 * range) / 1000.0; };
    line.at_infinity = {real(100), real(100), 1 + real(1) / 2};
    line.per_inverse_depth = {real(100), real(20), real(1)};
    line.slope = 1 + real(1) / 4;
    line.width = random.Int(1, 100);
    line.height = random.Int(1, 100);
    std::vector<double> factors;
    for (int i = random.Int(1, 40); i > 0; --i) factors.push_back(real(2));
    factors[0] = std::numeric_limits<double>::quiet_NaN();
    if (factors.size() > 1) factors[1] = std::numeric_limits<double>::infinity();
    std::vector<PixelPosition> expected;
    for (const double factor : factors) expected.push_back(Plainly(line, factor));
    OnEveryTarget([&] {
      std::vector<PixelPosition> targets(factors.size());
      ProjectOntoLine(line, factors, targets);
      EXPECT_THAT(targets, ElementsAreArray(expected));
    });
  }
}

TEST(MatchRewards, AreThoseOfTheWindowOnEveryTarget) {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const YcbcrImage view = RandomPicture(random, random.Int(1, 12), random.Int(1, 12));
    const YcbcrImage neighbour = RandomPicture(random, random.Int(1, 12), random.Int(1, 12));
    const PixelPosition center{random.Int(0, view.width() - 1), random.Int(0, view.height() - 1)};
    const int window = seed % 4 == 0 ? 5 : 3;
    const std::int32_t offset = MatchOffsetSteps(random.Int(100, 765));
    std::vector<PixelPosition> targets;
    for (int i = 0; i < 60; ++i) {
      if (random.Chance(20)) {
        targets.push_back(kNoTarget);
      } else if (random.Chance(30) && !targets.empty()) {
        targets.push_back(targets.back());
      } else {
        targets.push_back({random.Int(0, neighbour.width() - 1), random.Int(0, neighbour.height() - 1)});
      }
    }
    std::vector<std::uint16_t> expected;
    for (const PixelPosition target : targets) {
      expected.push_back(target == kNoTarget
                             ? std::uint16_t{0}
                             : MatchReward(WindowColorDifference(view, neighbour, center, target, window), offset));
    }
    OnEveryTarget([&] {
      std::vector<std::uint16_t> rewards(targets.size(), 12345);
      MatchRewards(view, neighbour, center, targets, window, offset, rewards);
      EXPECT_THAT(rewards, ElementsAreArray(expected));
    });
  }
}

}  // namespace
}  // namespace depthfarm
