#include "worker/refinement/data_term.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <span>
#include <stop_token>
#include <vector>

#include "tests/worker/refinement/random_views.h"
#include "tests/worker/refinement/two_views.h"
#include "worker/refinement/sight_kernels.h"

namespace depthfarm {
namespace {

const std::vector<PixelPosition> kCentre{{20, 15}};

// The change of u at the centre that the equations ask for, slopes held.
double Step(const NormalEquations& equations) { return equations.rhs[2] / equations.h[5]; }

std::vector<NormalEquations> Equations(const TwoViews& views, const RefinedView& view) {
  const std::vector<OtherView> others{views.Other()};
  return DataTerm(views.own, view, FreePixels(view), view.Map(), kCentre, others, false);
}

TEST(DataTerm, AsksForTheWayBackToTheTruth) {
  const TwoViews views(5);
  EXPECT_NEAR(Step(Equations(views, FlatView(5.3))[0]), -0.3, 0.05);
  EXPECT_NEAR(Step(Equations(views, FlatView(4.8))[0]), 0.2, 0.05);
  EXPECT_NEAR(Step(Equations(views, FlatView(5))[0]), 0, 1e-3);
}

TEST(DataTerm, ReadsAllOfALargerOtherView) {  // and nothing outside of a smaller one
  const TwoViews larger(-20, 80, 60);
  EXPECT_NEAR(Step(Equations(larger, FlatView(-20.2))[0]), 0.2, 0.05);
  const TwoViews smaller(5, 24, 20);
  EXPECT_NEAR(Step(Equations(smaller, FlatView(5.2))[0]), -0.2, 0.05);
}

// Smoothed pixels share their noise, and fewer of them speak; the others' share is theirs.
TEST(DataTerm, HowManyPixelsSpeakDoesNotChangeTheWeight) {
  const TwoViews views(5);
  const std::vector<OtherView> others{views.Other()};
  const RefinedView view = FlatView(5);
  constexpr double kBlurArea = 13;
  const double sharp = DataTerm(views.own, view, FreePixels(view), view.Map(), kCentre, others, false)[0].h[5];
  const double smoothed = DataTerm(views.own, view, FreePixels(view), view.Map(), kCentre, others, true)[0].h[5];
  EXPECT_NEAR(smoothed * kBlurArea / sharp, 1, 0.03);
  double expected = 0;  // of all pixels at the true depth, where nothing is robust: |g|^2 / sigma^2
  const double sigma = others[0].sigma;
  for (int y = 0; y < TwoViews::kHeight; ++y) {
    for (int x = 6; x < TwoViews::kWidth; ++x) {
      const Colour after = ColourOf(TextureAt(x + 0.5, y));
      const Colour before = ColourOf(TextureAt(x - 0.5, y));
      expected += SquaredDistance(VectorOf(after), VectorOf(before)) / (sigma * sigma);
    }
  }
  EXPECT_NEAR(sharp / expected, 1, 0.1);
}

// What a single other view says, pixel by pixel in the order of rows: of one view nothing is weighted anew.
std::vector<NormalEquations> PlainDataTerm(const RandomViews& views, const RefinedView& view,
                                           const InverseDepthMap& map, std::span<const PixelPosition> centers,
                                           bool blurred) {
  const OtherView other = views.Other(blurred);
  const int row_step = blurred ? 2 : 1;
  const double base = 2 * row_step / (other.sigma * other.sigma * (blurred ? 13 : 1));
  std::vector<NormalEquations> sums(centers.size());
  for (int y = 0; y < map.height(); y += row_step) {
    for (int x = 0; x < map.width(); ++x) {
      const PlaneIndex segment = view.plane_of_pixel(x, y);
      if ((x + y) % 2 != 0 || !view.IsFree(segment)) continue;
      PixelList one;
      if (blurred) {
        one.Add(views.smoothed_own, x, y, map(x, y));
      } else {
        one.Add(views.own, x, y, map(x, y));
      }
      PixelFits fit;
      FitColours(other, base, one, fit);
      if (fit.fits[0] == 0) continue;
      const double px = x - centers[segment].x;
      const double py = y - centers[segment].y;
      const std::array<double, 6> h{fit.gg[0] * px * px, fit.gg[0] * px * py, fit.gg[0] * px,
                                    fit.gg[0] * py * py, fit.gg[0] * py,      fit.gg[0]};
      const std::array<double, 3> rhs{fit.gr[0] * px, fit.gr[0] * py, fit.gr[0]};
      for (std::size_t i = 0; i < h.size(); ++i) sums[segment].h[i] += h[i];
      for (std::size_t i = 0; i < rhs.size(); ++i) sums[segment].rhs[i] -= rhs[i];
    }
  }
  return sums;
}

TEST(DataTerm, HasTheBitsOfAPlainSum) {
  test::Random random(7);
  int segments_that_speak = 0;
  for (int round = 0; round < 60; ++round) {
    const int width = random.Int(2, 150);
    const int height = random.Int(2, 20);
    const bool blurred = random.Chance(50);
    const RandomViews views(random, width, height);
    const int side = random.Int(1, 9);  // of a segment
    const int columns = (width + side - 1) / side;
    RefinedView view{.planes = {}, .kept = {}, .plane_of_pixel = Grid<PlaneIndex>(width, height)};
    std::vector<PixelPosition> centers;
    for (int y = 0; y < height; y += side) {
      for (int x = 0; x < width; x += side) {
        view.planes.push_back({0.01F * static_cast<float>(random.Int(-9, 9)), 0, static_cast<float>(random.Int(0, 9))});
        view.kept.push_back(random.Chance(20) ? 1 : 0);
        centers.push_back({x + side / 2, y + side / 2});
      }
    }
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        view.plane_of_pixel(x, y) = static_cast<PlaneIndex>(y / side * columns + x / side);
    const std::vector<OtherView> others{views.Other(blurred)};
    const InverseDepthMap map = view.Map();
    const auto sums = DataTerm(views.Own(blurred), view, FreePixels(view), map, centers, others, blurred);
    const auto plain = PlainDataTerm(views, view, map, centers, blurred);
    ASSERT_EQ(sums.size(), plain.size());
    for (std::size_t s = 0; s < sums.size(); ++s) {
      ASSERT_EQ(sums[s].h, plain[s].h) << round;
      ASSERT_EQ(sums[s].rhs, plain[s].rhs) << round;
      segments_that_speak += plain[s].h[5] > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(segments_that_speak, 1000);
}

TEST(DataTerm, LeavesKeptSegmentsAndTheirPixelsOut) {
  const TwoViews views(5);
  RefinedView kept = FlatView(5.3);
  kept.kept[0] = 1;
  EXPECT_EQ(Equations(views, kept)[0].h[5], 0);
  RefinedView copied = FlatView(5.3);  // all pixels have a plane of a reference frame
  copied.planes.push_back(copied.planes[0]);
  for (PlaneIndex& plane : copied.plane_of_pixel.values()) plane = 1;
  EXPECT_EQ(Equations(views, copied)[0].h[5], 0);
}

TEST(DataTerm, AnOtherViewThatDoesNotFitCountsLess) {
  const TwoViews good(5);
  TwoViews bad(5);
  for (Ycbcr& pixel : bad.there.values()) pixel.y = static_cast<std::uint8_t>(pixel.y + 30);
  const std::vector<OtherView> others{good.Other(), bad.Other()};
  const RefinedView view = FlatView(5.2);
  const auto both = DataTerm(good.own, view, FreePixels(view), view.Map(), kCentre, others, false);
  EXPECT_NEAR(Step(both[0]), -0.2, 0.05);
}

TEST(AddAgreement, DrawsToTheOtherViewsDepthUnlessItIsFarOff) {
  const TwoViews views(5);
  const std::vector<OtherView> others{views.Other()};
  const auto pull = [&](double u) {
    std::vector<NormalEquations> equations(1);
    AddAgreement(FlatView(u), kCentre, others, equations);
    return equations[0];
  };
  EXPECT_NEAR(Step(pull(5.2)), -0.2, 1e-6);
  EXPECT_GT(pull(5.2).h[5], 30);
  EXPECT_LT(pull(9).h[5], 1);
}

TEST(AddAgreement, IsOfTheSegmentsPlaneWhateverItsCentrePixelHas) {
  const TwoViews views(5);
  const std::vector<OtherView> others{views.Other()};
  RefinedView view = FlatView(5.2);
  view.planes.push_back({0, 0, 4.9F});
  view.plane_of_pixel(kCentre[0].x, kCentre[0].y) = 1;  // chosen at a jump
  std::vector<NormalEquations> equations(1);
  AddAgreement(view, kCentre, others, equations);
  EXPECT_NEAR(Step(equations[0]), -0.2, 1e-6);
}

TEST(DataTerm, EndsEarlyWhenAskedTo) {
  const TwoViews views(5);
  const std::vector<OtherView> others{views.Other()};
  const RefinedView view = FlatView(5.3);
  std::stop_source stop;
  stop.request_stop();
  const auto equations =
      DataTerm(views.own, view, FreePixels(view), view.Map(), kCentre, others, false, stop.get_token());
  EXPECT_EQ(equations[0].h[5], 0);
}

}  // namespace
}  // namespace depthfarm
