#include "worker/refinement/pixel_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "tests/support/random.h"
#include "tests/worker/refinement/random_views.h"
#include "tests/worker/refinement/two_views.h"
#include "worker/refinement/colour_weight.h"
#include "worker/refinement/jump_band.h"
#include "worker/refinement/patch_cost.h"

namespace depthfarm {
namespace {

constexpr int kEdge = 20;  // a board at u = 8 ends here, the wall behind is at u = 2
constexpr double kNear = 8;
constexpr double kFar = 2;

// The board left of the edge is dark, the wall bright; the segments' border is three pixels too far right.
struct Edge {
  TwoViews views{kFar};
  Grid<SegmentIndex> segments{TwoViews::kWidth, TwoViews::kHeight};
  RefinedView refined{.planes = {{0, 0, float(kNear)}, {0, 0, float(kFar)}}, .kept = {0, 0}, .plane_of_pixel = {}};

  Edge() {
    const auto dark = [](Ycbcr pixel) {
      pixel.y = static_cast<std::uint8_t>(std::max(0, pixel.y - 40));
      return pixel;
    };
    for (int y = 0; y < TwoViews::kHeight; ++y) {
      for (int x = 0; x < TwoViews::kWidth; ++x) {
        if (x < kEdge) views.own(x, y) = dark(TextureAt(x, y));
        segments(x, y) = x < kEdge + 3 ? 0 : 1;
        if (x >= kEdge - int(kNear)) continue;
        views.there(x, y) = dark(TextureAt(x + kNear, y));
        views.there_map(x, y) = float(kNear);
      }
    }
    refined.plane_of_pixel = segments;
  }

  void Choose(const std::stop_token& stop = {}) {
    const std::vector<OtherView> others{views.Other()};
    ChoosePlanes(views.own, segments, refined.Map(), others, nullptr, refined, stop);
  }
};

TEST(ChoosePlanes, MovesTheDepthEdgeToThePictures) {
  Edge edge;
  edge.Choose();
  for (int y = 1; y + 1 < TwoViews::kHeight; ++y) {
    for (int x = 12; x < TwoViews::kWidth - 6; ++x)
      EXPECT_EQ(edge.refined.At(x, y), x < kEdge ? kNear : kFar) << x << "," << y;
  }
}

// A dark rod in front of the wall, from top to bottom of both views; of its segments only the highest has its depth.
TEST(ChoosePlanes, APlaneSpreadsAlongARodThatOtherSegmentsMissed) {
  constexpr int kLeft = 20;
  constexpr int kWidth = 2;
  constexpr int kFound = 5;  // rows
  TwoViews views(kFar);
  const auto on_rod = [](int x, int left) { return x >= left && x < left + kWidth; };
  RefinedView refined{.planes = {{0, 0, float(kFar)}, {0, 0, float(kNear)}}, .kept = {0, 0}, .plane_of_pixel = {}};
  Grid<SegmentIndex> segments(TwoViews::kWidth, TwoViews::kHeight);
  for (int y = 0; y < TwoViews::kHeight; ++y) {
    for (int x = 0; x < TwoViews::kWidth; ++x) {
      if (on_rod(x, kLeft)) views.own(x, y) = {20, 100, 128, 0};
      if (on_rod(x, kLeft - int(kNear))) {
        views.there(x, y) = {20, 100, 128, 0};
        views.there_map(x, y) = float(kNear);
      }
      segments(x, y) = on_rod(x, kLeft) && y < kFound ? 1 : 0;
    }
  }
  refined.plane_of_pixel = segments;
  const std::vector<OtherView> others{views.Other()};
  ChoosePlanes(views.own, segments, refined.Map(), others, nullptr, refined);
  for (int y = 0; y < TwoViews::kHeight; ++y) {
    for (int x = 15; x < 30; ++x) ASSERT_EQ(refined.At(x, y), on_rod(x, kLeft) ? kNear : kFar) << x << "," << y;
  }
}

TEST(ChoosePlanes, PixelsOfKeptSegmentsStay) {
  Edge edge;
  edge.refined.kept[0] = 1;
  const Grid<PlaneIndex> before = edge.refined.plane_of_pixel;
  edge.Choose();
  for (int y = 0; y < TwoViews::kHeight; ++y)
    for (int x = 0; x < kEdge + 3; ++x) ASSERT_EQ(edge.refined.plane_of_pixel(x, y), before(x, y));
}

TEST(ChoosePlanes, EndsEarlyWhenAskedTo) {
  Edge edge;
  std::stop_source stop;
  stop.request_stop();
  edge.Choose(stop.get_token());
  EXPECT_EQ(edge.refined.plane_of_pixel, edge.segments);
}

TEST(ChoosePlanes, LeavesASmoothSurfaceAlone) {
  Edge edge;
  edge.refined.planes[0] = {0, 0, 2.3F};
  edge.Choose();
  EXPECT_EQ(edge.refined.plane_of_pixel, edge.segments);
}

// The choice written out: all costs anew in each pass, pixel by pixel, in the order of rows.
class PlainChoice {
 public:
  PlainChoice(const YcbcrImage& own, const Grid<SegmentIndex>& segments, const OtherView& other,
              const PriorField* prior, RefinedView& view)
      : own_(own), segments_(segments), others_{other}, prior_(prior), view_(view) {}

  void Choose(const InverseDepthMap& map) {
    Grid<std::uint8_t> open = JumpBand(map, 1);
    for (int pass = 0; pass < 40; ++pass) {
      const Grid<PlaneIndex> before = view_.plane_of_pixel;
      std::map<std::pair<int, int>, std::vector<Option>> options;  // by y, x
      for (int y = 0; y < own_.height(); ++y)
        for (int x = 0; x < own_.width(); ++x)
          if (open(x, y) != 0 && view_.kept[segments_(x, y)] == 0) options[{y, x}] = OptionsAt(x, y);
      std::erase_if(options, [](const auto& pixel) { return pixel.second.size() < 2; });
      if (options.empty()) return;
      for (int sweep = 0; sweep < 3; ++sweep)
        for (const auto& [place, of_pixel] : options) ChooseAt(place.second, place.first, of_pixel, open);
      open = Near(before);
    }
  }

 private:
  struct Option {
    PlaneIndex plane = 0;
    double u = 0;
    double cost = 0;
  };

  // At most five, none like one before it.
  [[nodiscard]] std::vector<Option> OptionsAt(int x, int y) {
    std::vector<std::pair<int, int>> ways{{0, 0}};
    for (int d = 1; d <= 2; ++d)
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, -1}, {1, -1}, {-1, 1}})
        ways.emplace_back(d * dx, d * dy);
    std::vector<Option> options;
    for (const auto& [dx, dy] : ways) {
      if (!own_.Contains(x + dx, y + dy) || options.size() == 5) continue;
      const PlaneIndex plane = view_.plane_of_pixel(x + dx, y + dy);
      const double u = view_.planes[plane].At(x, y);
      if (std::ranges::any_of(options, [&](const Option& known) { return std::abs(known.u - u) <= 0.15; })) continue;
      Option option{plane, u, 0};
      const PixelPosition pixel{x, y};
      PatchCost(own_, others_).Costs(view_.planes[plane], {&pixel, 1}, {&option.cost, 1});
      options.push_back(option);
    }
    return options;
  }

  void ChooseAt(int x, int y, const std::vector<Option>& options, Grid<std::uint8_t>& stale) {
    if (stale(x, y) == 0) return;
    stale(x, y) = 0;
    const std::array<std::pair<int, int>, 4> around{{{x + 1, y}, {x - 1, y}, {x, y + 1}, {x, y - 1}}};
    std::vector<double> costs;
    for (const Option& option : options) {
      double cost = option.cost;
      if (prior_ != nullptr) {
        const std::optional<double> u = prior_->At(x, y);
        if (u) cost += 0.3 * prior_->trust[segments_(x, y)] * std::min(1.0, std::abs(option.u - *u));
      }
      for (const auto& [nx, ny] : around) {
        if (!own_.Contains(nx, ny)) continue;
        const double link = 0.05 * ColourWeight(own_(x, y), own_(nx, ny));
        cost += link * std::min(1.0, std::abs(view_.At(nx, ny) - option.u) / 0.5);
      }
      costs.push_back(cost);
    }
    const PlaneIndex best = options[static_cast<std::size_t>(std::ranges::min_element(costs) - costs.begin())].plane;
    if (best == view_.plane_of_pixel(x, y)) return;
    view_.plane_of_pixel(x, y) = best;
    for (const auto& [nx, ny] : around)
      if (own_.Contains(nx, ny)) stale(nx, ny) = 1;
  }

  // At most two columns and rows from a pixel that had another plane before.
  [[nodiscard]] Grid<std::uint8_t> Near(const Grid<PlaneIndex>& before) const {
    Grid<std::uint8_t> near(own_.width(), own_.height());
    for (int y = 0; y < own_.height(); ++y) {
      for (int x = 0; x < own_.width(); ++x) {
        if (view_.plane_of_pixel(x, y) == before(x, y)) continue;
        for (int dy = -2; dy <= 2; ++dy)
          for (int dx = -2; dx <= 2; ++dx)
            if (near.Contains(x + dx, y + dy)) near(x + dx, y + dy) = 1;
      }
    }
    return near;
  }

  const YcbcrImage& own_;
  const Grid<SegmentIndex>& segments_;
  std::vector<OtherView> others_;
  const PriorField* prior_;
  RefinedView& view_;
};

TEST(ChoosePlanes, IsTheChoiceWrittenOutOnAnyThreads) {
  std::array<int, 2> changed{};  // pixels, without and with a prior
  for (std::uint64_t seed = 0; seed < 24; ++seed) {
    test::Random random(seed);
    const int width = random.Int(2, 50);
    const int height = random.Int(2, 40);
    const RandomViews views(random, width, height);
    const auto real = [&](double most) { return static_cast<float>(most * random.Int(-1000, 1000) / 1000); };
    RefinedView start{.planes = {}, .kept = {}, .plane_of_pixel = {width, height}};
    const int num_segments = random.Int(2, 12);
    for (int s = 0; s < num_segments; ++s) {
      start.planes.push_back({real(0.02), real(0.02), real(6)});
      start.kept.push_back(random.Chance(10) ? 1 : 0);
    }
    const int side = random.Int(1, 7);  // of the pieces that segments consist of
    Grid<SegmentIndex> segments(width, height);
    ViewPrior values{.lowest = -6, .step = 0.01F, .codes = {width, height}, .confidence = {}, .segments = {}};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const bool starts = x % side == 0 && y % side == 0;
        segments(x, y) = starts ? static_cast<SegmentIndex>(random.Int(0, num_segments - 1))
                                : segments(x / side * side, y / side * side);
        values.codes(x, y) = static_cast<std::uint16_t>(random.Chance(30) ? 0 : random.Int(1, 1200));
      }
    }
    start.plane_of_pixel = segments;
    PriorField prior{.planes = {}, .known = {}, .trust = {}, .pixels = &values};
    for (int s = 0; s < num_segments; ++s) prior.trust.push_back(static_cast<float>(random.Int(0, 4)) / 4);
    const PriorField* const said = random.Chance(50) ? &prior : nullptr;
    const InverseDepthMap map = start.Map();
    const std::vector<OtherView> others{views.Other(false)};
    RefinedView plain = start;
    PlainChoice(views.own, segments, others[0], said, plain).Choose(map);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        changed[said != nullptr ? 1 : 0] += plain.plane_of_pixel(x, y) != start.plane_of_pixel(x, y) ? 1 : 0;
    for (const int threads : {1, 3}) {
      RefinedView chosen = start;
      ChoosePlanes(views.own, segments, map, others, said, chosen, {}, threads);
      EXPECT_EQ(chosen.plane_of_pixel, plain.plane_of_pixel) << "seed " << seed << ", " << threads << " threads";
    }
  }
  EXPECT_GT(changed[0], 100);
  EXPECT_GT(changed[1], 100);
}

}  // namespace
}  // namespace depthfarm
