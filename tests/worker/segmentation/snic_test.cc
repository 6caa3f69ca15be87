#include "worker/segmentation/snic.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <queue>
#include <random>
#include <set>
#include <stop_token>
#include <tuple>
#include <vector>

#include "tests/worker/segmentation/test_pictures.h"
#include "worker/segmentation/describe.h"
#include "worker/segmentation/seed_grid.h"

namespace depthfarm {
namespace {

constexpr double kCompactness = 5;

// The published algorithm as it stands: every unlabelled neighbour is queued with the label that saw it.
Grid<SegmentIndex> PublishedSnic(const YcbcrImage& picture, int num_segments, double compactness) {
  constexpr SegmentIndex kNone = std::numeric_limits<SegmentIndex>::max();
  using Element = std::tuple<double, std::uint64_t, int, int, SegmentIndex>;  // distance, sequence, x, y, label
  struct Sums {
    double x = 0, y = 0, luma = 0, cb = 0, cr = 0, matte = 0, n = 0;
  };
  const SeedGrid seeds = SeedGrid::Create(picture.width(), picture.height(), num_segments).value();
  const double weight = compactness * compactness / (static_cast<double>(picture.size()) / seeds.num_segments());
  std::priority_queue<Element, std::vector<Element>, std::greater<>> queue;
  std::uint64_t sequence = 0;
  for (int i = 0; i < seeds.num_segments(); ++i) {
    queue.push({0.0, sequence++, seeds.Seed(i).x, seeds.Seed(i).y, static_cast<SegmentIndex>(i)});
  }
  std::vector<Sums> clusters(static_cast<std::size_t>(seeds.num_segments()));
  Grid<SegmentIndex> labels(picture.width(), picture.height(), kNone);
  while (!queue.empty()) {
    const auto [distance, order, x, y, label] = queue.top();
    queue.pop();
    if (labels(x, y) != kNone) continue;
    labels(x, y) = label;
    Sums& c = clusters[label];
    const Ycbcr& color = picture(x, y);
    c = {c.x + x, c.y + y, c.luma + color.y, c.cb + color.cb, c.cr + color.cr, c.matte + color.matte, c.n + 1};
    for (int ny = y - 1; ny <= y + 1; ++ny) {
      for (int nx = x - 1; nx <= x + 1; ++nx) {
        if (!labels.Contains(nx, ny) || labels(nx, ny) != kNone) continue;
        const Ycbcr& other = picture(nx, ny);
        const double dx = nx - c.x / c.n;
        const double dy = ny - c.y / c.n;
        const double dl = other.y - c.luma / c.n;
        const double db = other.cb - c.cb / c.n;
        const double dr = other.cr - c.cr / c.n;
        const double dm = other.matte - c.matte / c.n;
        queue.push({(dl * dl + db * db + dr * dr + dm * dm) + (dx * dx + dy * dy) * weight, sequence++, nx, ny, label});
      }
    }
  }
  return labels;
}

class SnicProperty : public testing::TestWithParam<NamedPicture> {};
INSTANTIATE_TEST_SUITE_P(Pictures, SnicProperty, testing::ValuesIn(PropertyPictures()),
                         [](const auto& param_info) { return std::string(param_info.param.name); });

TEST_P(SnicProperty, GivesThePromisedNumberOfConnectedSegments) {
  const auto& [name, picture, num_segments] = GetParam();
  const Grid<SegmentIndex> labels = SegmentSnic(picture, num_segments, kCompactness).value();
  ASSERT_EQ(labels.width(), picture.width());
  ASSERT_EQ(labels.height(), picture.height());
  const Status status = ValidateLabels(labels);
  EXPECT_TRUE(status.ok()) << status.message();
  const std::set<SegmentIndex> used(labels.values().begin(), labels.values().end());
  const SeedGrid seeds = SeedGrid::Create(picture.width(), picture.height(), num_segments).value();
  EXPECT_EQ(used.size(), static_cast<std::size_t>(seeds.num_segments()));
}

TEST_P(SnicProperty, EachSegmentKeepsItsSeed) {
  const auto& [name, picture, num_segments] = GetParam();
  const Grid<SegmentIndex> labels = SegmentSnic(picture, num_segments, kCompactness).value();
  const SeedGrid seeds = SeedGrid::Create(picture.width(), picture.height(), num_segments).value();
  for (int i = 0; i < seeds.num_segments(); ++i) {
    EXPECT_EQ(labels(seeds.Seed(i).x, seeds.Seed(i).y), static_cast<SegmentIndex>(i));
  }
}

TEST_P(SnicProperty, EqualsThePublishedAlgorithm) {
  const auto& [name, picture, num_segments] = GetParam();
  for (const double compactness : {0.5, kCompactness, 40.0}) {
    EXPECT_EQ(SegmentSnic(picture, num_segments, compactness).value(),
              PublishedSnic(picture, num_segments, compactness));
  }
}

// Few grey levels give equal distances, many give none; sides of one and two pixels have no or half a neighbourhood.
TEST(Snic, EqualsThePublishedAlgorithmOnRandomPictures) {
  std::mt19937 random(1);
  const auto up_to = [&random](std::uint32_t most) { return 1 + static_cast<int>(random() % most); };
  for (int trial = 0; trial < 300; ++trial) {
    const int width = up_to(trial % 3 == 0 ? 2 : 40);
    const int height = up_to(trial % 3 == 1 ? 2 : 40);
    const std::uint32_t levels = trial % 2 == 0 ? 3 : 256;
    YcbcrImage picture(width, height);
    for (Ycbcr& pixel : picture.values()) {
      const auto level = [&] { return static_cast<std::uint8_t>(random() % levels); };
      pixel = {level(), level(), level(),
               static_cast<std::uint8_t>(trial % 5 == 0 ? random() % 2 * kForegroundMatte : 0)};
    }
    const int num_segments = up_to(static_cast<std::uint32_t>(width * height));
    const double compactness = std::ldexp(1.0, up_to(18) - 9);
    EXPECT_EQ(SegmentSnic(picture, num_segments, compactness).value(),
              PublishedSnic(picture, num_segments, compactness))
        << width << "x" << height << ", " << num_segments << " segments, compactness " << compactness;
  }
}

// Large enough for buckets of thousands, of which most elements are overtaken.
TEST(Snic, EqualsThePublishedAlgorithmOnALargePicture) {
  const YcbcrImage picture = ScenePicture(400, 300, 11);
  for (const int num_segments : {30, 6000})
    EXPECT_EQ(SegmentSnic(picture, num_segments, kCompactness).value(),
              PublishedSnic(picture, num_segments, kCompactness));
}

TEST_P(SnicProperty, GivesTheSameLabelsAgain) {
  const auto& [name, picture, num_segments] = GetParam();
  EXPECT_EQ(SegmentSnic(picture, num_segments, kCompactness).value(),
            SegmentSnic(picture, num_segments, kCompactness).value());
}

// A border of many grey levels that runs along no cell of the seeds: no segment may cross it.
TEST(Snic, SegmentsRespectTheBordersOfATwoColorPicture) {
  YcbcrImage picture(80, 60);
  const auto inside = [](int x, int y) { return (x - 43) * (x - 43) + (y - 28) * (y - 28) < 400; };
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) picture(x, y) = inside(x, y) ? Ycbcr{200, 90, 160} : Ycbcr{40, 140, 100};
  }
  const Grid<SegmentIndex> labels = SegmentSnic(picture, 192, kCompactness).value();
  std::vector<int> pixels_inside(192, 0);
  std::vector<int> pixels(192, 0);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      ++pixels[labels(x, y)];
      if (inside(x, y)) ++pixels_inside[labels(x, y)];
    }
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    EXPECT_TRUE(pixels_inside[i] == 0 || pixels_inside[i] == pixels[i]) << "segment " << i << " crosses the border";
  }
}

// Where colours tell nothing a mask's contours do: they are straight here, between the columns of seeds.
TEST(Snic, SegmentsRespectTheContoursOfAMask) {
  YcbcrImage picture = ConstantPicture(60, 40);
  constexpr int kContour = 33;
  for (int y = 0; y < 40; ++y)
    for (int x = kContour; x < 60; ++x) picture(x, y).matte = kForegroundMatte;
  const Grid<SegmentIndex> labels = SegmentSnic(picture, 24, kCompactness).value();
  std::vector<int> sides(24, 0);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 60; ++x) sides[labels(x, y)] |= x < kContour ? 1 : 2;
  for (const int side : sides) EXPECT_NE(side, 3) << "a segment is on both sides";
}

TEST(Snic, CutsAConstantPictureIntoCompactSegments) {
  const Grid<SegmentIndex> labels = SegmentSnic(ConstantPicture(60, 40), 24, kCompactness).value();
  const SegmentMap map = DescribeSegments(labels, ConstantPicture(60, 40));
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 60; ++x) {
      const PixelPosition center = map.centers[labels(x, y)];
      // 10 x 10 cells: half a diagonal and a pixel or two
      EXPECT_LE(std::hypot(x - center.x, y - center.y), 9.5) << x << ", " << y;
    }
  }
}

TEST(Snic, LargerCompactnessKeepsPixelsNearerToTheirCenters) {
  const YcbcrImage picture = NoisePicture(90, 90, 9);
  const auto spread = [&](double compactness) {
    const Grid<SegmentIndex> labels = SegmentSnic(picture, 81, compactness).value();
    const SegmentMap map = DescribeSegments(labels, picture);
    double sum = 0;
    for (int y = 0; y < 90; ++y) {
      for (int x = 0; x < 90; ++x) {
        const PixelPosition center = map.centers[labels(x, y)];
        sum += std::hypot(x - center.x, y - center.y);
      }
    }
    return sum;
  };
  EXPECT_LT(spread(500), spread(5));
}

TEST(Snic, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const auto labels = SegmentSnic(ConstantPicture(40, 40), 16, kCompactness, stop.get_token());
  EXPECT_EQ(labels.status().code(), ErrorCode::kCancelled);
}

TEST(Snic, RefusesParametersOutOfBounds) {
  const YcbcrImage picture = ConstantPicture(8, 8);
  for (const double compactness :
       {0.0, -1.0, 1001.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(SegmentSnic(picture, 4, compactness).status().code(), ErrorCode::kInvalidArgument) << compactness;
  }
  EXPECT_EQ(SegmentSnic(picture, 0, kCompactness).status().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(SegmentSnic(YcbcrImage(), 4, kCompactness).status().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
