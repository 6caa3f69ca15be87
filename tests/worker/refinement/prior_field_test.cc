#include "worker/refinement/prior_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "tests/worker/refinement/plain_scene.h"
#include "worker/refinement/pixel_choice.h"
#include "worker/refinement/region_plane.h"

namespace depthfarm {
namespace {

constexpr double kBoard = PlainScene::kWall;  // of the plain scene
constexpr double kBent = 0.3;                 // by how much a bend in the prior is off at most
constexpr double kGuess = 9;                  // what the view has of the board, which no texture tells
constexpr double kPerPixel = 8;               // of u in the unit of the prior, so that PriorScale matters

// A prior of the plain scene with its board: right but for what `error(x, y)` adds, in pixels of u.
template <typename Error>
ViewPrior PriorOf(const SegmentMap& segments, const Error& error) {
  Grid<float> values(PlainScene::kWidth, PlainScene::kHeight);
  for (int y = 0; y < values.height(); ++y) {
    for (int x = 0; x < values.width(); ++x) {
      const double u = PlainScene::OnBoard(x, y) ? kBoard : PlainScene::kWall;
      values(x, y) = static_cast<float>(std::max(0.0, u + error(x, y)) / kPerPixel);
    }
  }
  ViewPrior prior = MakePrior(values, {});
  prior.segments = DescribePrior(segments, prior);
  return prior;
}

double NoError(int /*x*/, int /*y*/) { return 0; }

class PriorOfAScene : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::uint8_t> Told() const {
    std::vector<std::uint8_t> told = scene_.Plain();
    for (std::uint8_t& value : told) value = value == 0 ? 1 : 0;
    return told;
  }
  [[nodiscard]] std::optional<PriorField> Fit(const ViewPrior& prior, const PriorScale& scale = {kPerPixel, false}) {
    return FitPrior(prior, scale, scene_.segments, Told(), scene_.View(kGuess));
  }
  // Depth in the middle of the board after regions have been decided.
  [[nodiscard]] double BoardWith(const PriorField* prior) {
    RefinedView view = scene_.View(kGuess);
    DecidePlainRegions(scene_.picture, scene_.segments, FindPlainRegions(scene_.segments, scene_.Plain(), view),
                       scene_.Others(), prior, view);
    return view.At(62, 40);
  }
  // What the prior says of a pixel, and how far it is trusted there.
  [[nodiscard]] double PlaneAt(const PriorField& prior, int x, int y) const {
    return prior.planes[scene_.segments.labels(x, y)].At(x, y);
  }
  [[nodiscard]] float TrustAt(const PriorField& prior, int x, int y) const {
    return prior.trust[scene_.segments.labels(x, y)];
  }

  PlainScene scene_{kBoard};
};

// The board as the prior has it is a little bent, which no candidate of the region itself is.
TEST_F(PriorOfAScene, ARightOneIsTrustedAndDecidesThePlainRegion) {
  const ViewPrior values = PriorOf(scene_.segments, [](int x, int y) {
    return PlainScene::OnBoard(x, y) ? kBent * (1 - (x - 62) * (x - 62) / 900.0) : 0;
  });
  const auto prior = Fit(values);
  ASSERT_TRUE(prior.has_value());
  EXPECT_NEAR(PlaneAt(*prior, 62, 40), kBoard + kBent, 0.02);
  EXPECT_GT(TrustAt(*prior, 62, 40), 0.9);
  EXPECT_GT(TrustedShare(&*prior), 0.7);
  EXPECT_NEAR(prior->At(62, 40).value(), kBoard + kBent, 0.01);
  EXPECT_EQ(BoardWith(nullptr), kBoard);
  EXPECT_NEAR(BoardWith(&*prior), kBoard + kBent, 0.02);
}

TEST_F(PriorOfAScene, ScaleAndShiftAreFittedWhereValuesHaveNone) {
  // The wall alone does not tell the scale: give it a slant.
  RefinedView view = scene_.View(kGuess);
  const auto wall = [](double x) { return 3 + 0.05 * x; };
  for (SegmentIndex s = 0; s < view.planes.size(); ++s)
    if (!PlainScene::OnBoard(scene_.segments.centers[s].x, scene_.segments.centers[s].y))
      view.planes[s] = {0.05F, 0, 3};
  Grid<float> values(PlainScene::kWidth, PlainScene::kHeight);
  for (int y = 0; y < values.height(); ++y) {
    for (int x = 0; x < values.width(); ++x) {
      const double u = PlainScene::OnBoard(x, y) ? kBoard : wall(x);
      values(x, y) = static_cast<float>(50 + 3 * u);
    }
  }
  ViewPrior relative = MakePrior(values, {});
  relative.segments = DescribePrior(scene_.segments, relative);
  const auto prior = FitPrior(relative, {1, true}, scene_.segments, Told(), view);
  ASSERT_TRUE(prior.has_value());
  EXPECT_NEAR(PlaneAt(*prior, 62, 40), kBoard, 0.05);
  EXPECT_NEAR(prior->At(10, 5).value(), wall(10), 0.05);
}

TEST_F(PriorOfAScene, OneThatIsOffAsAWholeIsPutRight) {
  RefinedView view = scene_.View(kGuess);
  for (SegmentIndex s = 0; s < view.planes.size(); ++s)
    if (!PlainScene::OnBoard(scene_.segments.centers[s].x, scene_.segments.centers[s].y))
      view.planes[s] = {0.05F, 0, 3};
  const ViewPrior values = PriorOf(scene_.segments, [](int x, int y) {
    return PlainScene::OnBoard(x, y) ? 2.0 : 3 + 0.05 * x + 2 - PlainScene::kWall;
  });
  const auto prior = FitPrior(values, {kPerPixel, false}, scene_.segments, Told(), view);
  ASSERT_TRUE(prior.has_value());
  EXPECT_NEAR(PlaneAt(*prior, 62, 40), kBoard, 0.1);
}

TEST_F(PriorOfAScene, NoiseIsNotTrusted) {
  const ViewPrior values = PriorOf(scene_.segments, [](int x, int y) { return (x * 7 + y * 13) % 11 * 0.6 - 3; });
  const auto prior = Fit(values);
  ASSERT_TRUE(prior.has_value());
  for (const float trust : prior->trust) EXPECT_EQ(trust, 0);
  EXPECT_EQ(TrustedShare(&*prior), 0);
  EXPECT_EQ(TrustedShare(nullptr), 0);
  EXPECT_EQ(BoardWith(&*prior), BoardWith(nullptr));
}

TEST_F(PriorOfAScene, OneThatContradictsThePicturesIsNotTrusted) {
  const ViewPrior values =
      PriorOf(scene_.segments, [](int x, int y) { return 2 * std::sin(0.1 * x) * std::cos(0.1 * y); });
  const auto prior = Fit(values);
  ASSERT_TRUE(prior.has_value());
  for (const float trust : prior->trust) EXPECT_LT(trust, kTrusted);
}

TEST_F(PriorOfAScene, TooLittleOfItIsNone) {
  const ViewPrior values = PriorOf(scene_.segments, [](int x, int y) { return x < 20 && y < 20 ? 0.0 : -100.0; });
  EXPECT_FALSE(Fit(values).has_value());
  EXPECT_FALSE(FitPrior(PriorOf(scene_.segments, [](int, int) { return 1.0; }), {1, true}, scene_.segments,
                        std::vector<std::uint8_t>(scene_.segments.centers.size()), scene_.View(kGuess))
                   .has_value());
}

TEST_F(PriorOfAScene, ASegmentTakesItWhereItFitsTheOtherViewsBetter) {
  const ViewPrior values = PriorOf(scene_.segments, NoError);
  const auto prior = Fit(values);
  ASSERT_TRUE(prior.has_value());
  RefinedView view = scene_.View(kBoard);
  const SegmentIndex wrong = scene_.segments.labels(12, 70);  // on the wall
  const SegmentIndex kept = scene_.segments.labels(12, 10);
  const SegmentIndex decided = scene_.segments.labels(102, 70);
  for (const SegmentIndex s : {wrong, kept, decided}) view.planes[s] = {0, 0, 8};
  view.kept[kept] = 1;
  std::vector<std::uint8_t> decisions(view.planes.size());
  decisions[decided] = 1;
  TakePrior(scene_.picture, scene_.segments, *prior, decisions, scene_.Others(), view);
  EXPECT_NEAR(view.At(12, 70), PlainScene::kWall, 0.01);
  EXPECT_EQ(view.At(12, 10), 8);
  EXPECT_EQ(view.At(102, 70), 8);
}

TEST_F(PriorOfAScene, DrawsPlanesThatAreNearIt) {
  const ViewPrior values = PriorOf(scene_.segments, NoError);
  const auto prior = Fit(values);
  ASSERT_TRUE(prior.has_value());
  RefinedView view = scene_.View(kBoard);
  const SegmentIndex near = scene_.segments.labels(12, 70);
  const SegmentIndex far = scene_.segments.labels(102, 70);
  view.planes[near] = {0, 0, 4.2F};
  view.planes[far] = {0, 0, 9};
  std::vector<NormalEquations> equations(view.planes.size());
  AddPrior(*prior, view, scene_.segments.centers, equations);
  EXPECT_NEAR(equations[near].rhs[2] / equations[near].h[5], -0.2, 0.01);  // to the prior
  EXPECT_GT(equations[near].h[5], 10);
  EXPECT_LT(equations[far].h[5], 0.1);
}

}  // namespace
}  // namespace depthfarm
