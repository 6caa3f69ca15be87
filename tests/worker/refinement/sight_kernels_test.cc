#include "worker/refinement/sight_kernels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "tests/support/every_target.h"
#include "tests/worker/refinement/random_views.h"

namespace depthfarm {
namespace {

using test::OnEveryTarget;
using test::Random;
using testing::ElementsAreArray;

PixelList RandomList(Random& random, const RandomViews& views, bool smoothed) {
  PixelList list;
  const int count = random.Chance(20) ? static_cast<int>(kListPixels) : random.Int(1, static_cast<int>(kListPixels));
  for (int i = 0; i < count; ++i) {
    const int x = random.Int(0, views.own.width() - 1);
    const int y = random.Int(0, views.own.height() - 1);
    views.Own(smoothed).With([&](const auto& own) { list.Add(own, x, y, random.Int(-15'000, 15'000) / 1000.0); });
  }
  return list;
}

// The first values of a list, as many as it has pixels.
template <typename T>
std::vector<T> Values(const ListOf<T>& list, std::size_t count) {
  return {list.begin(), list.begin() + static_cast<std::ptrdiff_t>(count)};
}

struct PlainFit {
  double rho = 0;
  double gg = 0;
  double gr = 0;
};

// What one pixel says of its u, written out.
std::optional<PlainFit> FitPlainly(const OtherView& other, double base, const Colour& own, double x, double y,
                                   double u) {
  const auto seen = SeenIn(*other.pair, *other.map, x, y, u);
  if (!seen) return std::nullopt;
  const double squared = seen->dx * seen->dx + seen->dy * seen->dy;
  if (!(squared > 1e-18)) return std::nullopt;
  const double motion = std::sqrt(squared);
  const double half_x = 0.5 / motion * seen->dx;
  const double half_y = 0.5 / motion * seen->dy;
  const auto inside = [&](double px, double py) {
    return px >= 0 && py >= 0 && px <= other.colour.width() - 1 && py <= other.colour.height() - 1;
  };
  if (!inside(seen->x - half_x, seen->y - half_y) || !inside(seen->x + half_x, seen->y + half_y)) return std::nullopt;
  const ColourVector gradient = other.colour.Between(seen->x + half_x, seen->y + half_y) -
                                other.colour.Between(seen->x - half_x, seen->y - half_y);
  const ColourVector difference = other.colour.Between(seen->x, seen->y) - VectorOf(own);
  double gg = 0;
  double rr = 0;
  double gr = 0;
  for (int i = 0; i < 3; ++i) {
    gg += static_cast<double>(gradient[i]) * gradient[i];
    rr += static_cast<double>(difference[i]) * difference[i];
    gr += static_cast<double>(gradient[i]) * difference[i];
  }
  const double t = rr * (1 / (kKappa * kKappa * other.sigma * other.sigma));
  const double robust = 1 / (1 + t);
  const double weight = base * robust * robust;
  return PlainFit{t * robust, weight * squared * gg, weight * motion * gr};
}

// Each of many views and lists, of pictures as they are and smoothed.
template <typename Check>
void OnRandomLists(const Check& check) {
  for (std::uint64_t seed = 0; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const RandomViews views(random, random.Int(2, 80), random.Int(2, 50));
    const bool smoothed = random.Chance(40);
    const PixelList list = RandomList(random, views, smoothed);
    check(views.Own(smoothed), views.Other(smoothed), list);
  }
}

TEST(FitColours, AreThoseOfEachPixelOnEveryTarget) {
  int seen = 0;
  int unseen = 0;
  OnRandomLists([&](const PictureColours& own, const OtherView& other, const PixelList& list) {
    constexpr double kBase = 0.7;
    std::vector<double> fits, rho, gg, gr;
    for (std::size_t i = 0; i < list.count; ++i) {
      const auto fit = FitPlainly(other, kBase, own(list.x[i], list.y[i]), list.x[i], list.y[i], list.u[i]);
      fits.push_back(fit ? 1 : 0);
      rho.push_back(fit.value_or(PlainFit{}).rho);
      gg.push_back(fit.value_or(PlainFit{}).gg);
      gr.push_back(fit.value_or(PlainFit{}).gr);
      (fit ? seen : unseen) += 1;
    }
    OnEveryTarget([&] {
      PixelFits result;
      PixelList filled = list;
      FitColours(other, kBase, filled, result);
      EXPECT_THAT(Values(result.fits, list.count), ElementsAreArray(fits));
      EXPECT_THAT(Values(result.rho, list.count), ElementsAreArray(rho));
      EXPECT_THAT(Values(result.gg, list.count), ElementsAreArray(gg));
      EXPECT_THAT(Values(result.gr, list.count), ElementsAreArray(gr));
    });
  });
  EXPECT_GT(seen, 500);
  EXPECT_GT(unseen, 500);
}

// The kernel against what `plainly` says of each pixel.
template <typename Kernel, typename Plainly>
void ExpectOnEveryTarget(const Kernel& kernel, const Plainly& plainly) {
  OnRandomLists([&](const PictureColours& own, const OtherView& other, const PixelList& list) {
    std::vector<double> expected;
    for (std::size_t i = 0; i < list.count; ++i)
      expected.push_back(plainly(other, own(list.x[i], list.y[i]), list.x[i], list.y[i], list.u[i]).value_or(kNotSeen));
    OnEveryTarget([&] {
      ListOf<double> result;
      PixelList filled = list;
      kernel(other, filled, result);
      EXPECT_THAT(Values(result, list.count), ElementsAreArray(expected));
    });
  });
}

TEST(SquaredDistances, AreThoseOfEachPixelOnEveryTarget) {
  ExpectOnEveryTarget(SquaredDistances, [](const OtherView& other, const Colour& own, double x, double y, double u) {
    const auto seen = SeenIn(*other.pair, *other.map, x, y, u);
    return seen ? std::optional(SquaredDistance(other.colour.Between(seen->x, seen->y), VectorOf(own))) : std::nullopt;
  });
}

TEST(Misfits, AreThoseOfEachPixelOnEveryTarget) {
  ExpectOnEveryTarget(Misfits, [](const OtherView& other, const Colour& own, double x, double y, double u) {
    return Misfit(own, other, x, y, u);
  });
}

TEST(MisfitsInFreeSpace, AreThoseOfEachPixelOnEveryTarget) {
  int in_mid_air = 0;
  ExpectOnEveryTarget(MisfitsInFreeSpace, [&](const OtherView& other, const Colour& own, double x, double y, double u) {
    const auto misfit = MisfitInFreeSpace(own, other, x, y, u);
    in_mid_air += misfit != Misfit(own, other, x, y, u) ? 1 : 0;
    return misfit;
  });
  EXPECT_GT(in_mid_air, 50);
}

TEST(FitColours, OfNoPixelsAreNone) {
  Random random(1);
  const RandomViews views(random, 8, 8);
  PixelList list;
  PixelFits result;
  result.rho[0] = 7;
  FitColours(views.Other(false), 1, list, result);
  EXPECT_EQ(result.rho[0], 7);
}

}  // namespace
}  // namespace depthfarm
