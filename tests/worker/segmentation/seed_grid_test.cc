#include "worker/segmentation/seed_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <random>
#include <set>
#include <utility>

#include "worker/segmentation/picture_size.h"

namespace depthfarm {
namespace {

SeedGrid Grid_(int width, int height, int requested) { return SeedGrid::Create(width, height, requested).value(); }

TEST(SeedGrid, MeetsThePapersNumbersExactly) {
  EXPECT_EQ(Grid_(1920, 1080, 100'000).num_segments(), 100'000);
  EXPECT_EQ(Grid_(1024, 768, 50'000).num_segments(), 50'000);
}

TEST(SeedGrid, PutsOneSeedOfOneSegmentAtTheCenter) {
  const SeedGrid grid = Grid_(9, 5, 1);
  EXPECT_EQ(grid.num_segments(), 1);
  EXPECT_EQ(grid.Seed(0), (PixelPosition{4, 2}));
}

TEST(SeedGrid, NumbersSeedsRowByRow) {
  const SeedGrid grid = Grid_(30, 20, 6);
  ASSERT_EQ(grid.columns(), 3);
  ASSERT_EQ(grid.rows(), 2);
  EXPECT_EQ(grid.Seed(0), (PixelPosition{5, 5}));
  EXPECT_EQ(grid.Seed(2), (PixelPosition{25, 5}));
  EXPECT_EQ(grid.Seed(3), (PixelPosition{5, 15}));
}

TEST(SeedGrid, PrefersSquareCellsThenFewerRows) {
  // 12 = 3 x 4 = 4 x 3: the cells of a wide picture are squarer with more columns.
  EXPECT_EQ(Grid_(40, 30, 12).columns(), 4);
  EXPECT_EQ(Grid_(30, 40, 12).columns(), 3);
  // 2 = 1 x 2 = 2 x 1, equally square on a square picture.
  EXPECT_EQ(Grid_(10, 10, 2).rows(), 1);
}

TEST(SeedGrid, ClampsToOneSegmentAPixel) {
  const SeedGrid grid = Grid_(7, 5, 1'000'000);
  EXPECT_EQ(grid.num_segments(), 35);
  for (int index = 0; index < 35; ++index) EXPECT_EQ(grid.Seed(index), (PixelPosition{index % 7, index / 7}));
}

TEST(SeedGrid, NeverHasMoreRowsThanSegmentsInANarrowPicture) {
  const SeedGrid grid = Grid_(1, 150, 11);
  EXPECT_EQ(grid.columns(), 1);
  EXPECT_EQ(grid.rows(), 11);
  EXPECT_EQ(Grid_(150, 1, 11).columns(), 11);
}

// No grid with rows within 10 % of the square one is nearer to the request.
TEST(SeedGrid, IsTheNearestOfNearSquareGrids) {
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    const int width = 1 + static_cast<int>(random() % 90);
    const int height = 1 + static_cast<int>(random() % 90);
    const int requested = 1 + static_cast<int>(random() % (width * height));
    const SeedGrid grid = Grid_(width, height, requested);
    const int miss = std::abs(grid.num_segments() - requested);
    for (int rows = 1; rows <= std::min(height, requested); ++rows) {
      const double relative = rows * static_cast<double>(rows) * width / (static_cast<double>(requested) * height);
      if (relative < 0.82 || relative > 1.20) continue;  // a little inside 0.9^2..1.1^2: rounding is not the subject
      for (int columns = 1; columns <= width; ++columns) {
        ASSERT_LE(miss, std::abs(columns * rows - requested))
            << width << " x " << height << ", " << requested << " requested: " << columns << " x " << rows;
      }
    }
  }
}

TEST(SeedGrid, SeedsAreDistinctPixelsInRowMajorOrder) {
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const int width = 1 + static_cast<int>(random() % 60);
    const int height = 1 + static_cast<int>(random() % 60);
    const SeedGrid grid = Grid_(width, height, 1 + static_cast<int>(random() % 4000));
    std::set<std::pair<int, int>> seen;
    for (int index = 0; index < grid.num_segments(); ++index) {
      const PixelPosition seed = grid.Seed(index);
      ASSERT_TRUE(seed.x >= 0 && seed.x < width && seed.y >= 0 && seed.y < height);
      ASSERT_TRUE(seen.empty() || *seen.rbegin() < std::pair(seed.y, seed.x));
      seen.insert({seed.y, seed.x});
    }
  }
}

TEST(SeedGrid, RefusesWhatItCannotDivide) {
  for (const auto& [width, height] : {std::pair{0, 5}, {5, 0}, {-1, 5}, {kMaxPictureSide + 1, 1}}) {
    EXPECT_EQ(SeedGrid::Create(width, height, 1).status().code(), ErrorCode::kInvalidArgument);
  }
  const Status status = SeedGrid::Create(5, 5, 0).status();
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(status.message(), "number of segments is 0, expected at least 1");
}

TEST(SeedGrid, HandlesTheLargestPicture) {
  const SeedGrid grid = Grid_(kMaxPictureSide, kMaxPictureSide, kMaxPictureSide * kMaxPictureSide);
  EXPECT_EQ(grid.num_segments(), kMaxPictureSide * kMaxPictureSide);
  EXPECT_EQ(grid.Seed(grid.num_segments() - 1), (PixelPosition{kMaxPictureSide - 1, kMaxPictureSide - 1}));
}

}  // namespace
}  // namespace depthfarm
