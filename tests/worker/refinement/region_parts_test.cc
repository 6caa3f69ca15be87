#include "worker/refinement/region_parts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "worker/refinement/plain_regions.h"
#include "worker/refinement/region_plane.h"
#include "worker/segmentation/describe.h"

namespace depthfarm {
namespace {

// A wall and, from kFoot downwards, a floor that comes nearer, of one colour and with little texture, between two
// views; left of kStrip there is more.
class Room {
 public:
  static constexpr int kWidth = 192;
  static constexpr int kHeight = 144;
  static constexpr int kCell = 6;
  static constexpr int kFoot = 78;
  static constexpr int kStrip = 24;
  static constexpr double kWall = 4;

  // `slope`: of the floor, pixels of u each row; `contrast`: of the texture, grey levels.
  explicit Room(double slope, double contrast = 8) : slope_(slope), contrast_(contrast) {
    picture = YcbcrImage(kWidth, kHeight);
    Grid<SegmentIndex> cells(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        picture(x, y) = SeenAt(x, y, 0);
        cells(x, y) = static_cast<SegmentIndex>(y / kCell * (kWidth / kCell) + x / kCell);
      }
    }
    segments = DescribeSegments(std::move(cells), picture);
    for (const int side : {-1, 1}) {
      PairGeometry pair;
      pair.m = Eigen::Matrix3d::Identity();
      pair.e = {static_cast<double>(side), 0, 0};
      pair.other_scale = 1;
      pairs.push_back(pair);
      YcbcrImage colour(kWidth, kHeight);
      for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) colour(x, y) = SeenAt(x, y, side);
      colours.push_back(colour);
    }
  }
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

  [[nodiscard]] double DepthAt(int y) const { return kWall + std::max(0, y - kFoot) * slope_; }

  [[nodiscard]] std::vector<OtherView> Others() const {
    std::vector<OtherView> others;
    for (std::size_t i = 0; i < pairs.size(); ++i)
      others.push_back({.pair = &pairs[i], .colour = colours[i], .map = &nothing_});
    return others;
  }

  // The strip is where it is, all else a wall.
  [[nodiscard]] RefinedView View() const {
    RefinedView view{
        .planes = {}, .kept = std::vector<std::uint8_t>(segments.centers.size()), .plane_of_pixel = segments.labels};
    for (const auto& [x, y] : segments.centers)
      view.planes.push_back({0, 0, static_cast<float>(x < kStrip ? DepthAt(y) : kWall)});
    return view;
  }

  // The parts of what was taken for a wall, by each judged_each-th pixel.
  [[nodiscard]] std::vector<RegionPart> Parts(std::size_t judged_each = 1) const {
    const std::vector<OtherView> others = Others();
    std::vector<SegmentIndex> region(segments.centers.size());
    std::iota(region.begin(), region.end(), SegmentIndex{0});
    std::vector<PixelPosition> pixels;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) pixels.push_back({x, y});
    const std::vector<SlantedPlane> planes(region.size(), {0, 0, static_cast<float>(kWall)});
    std::vector<PixelPosition> judged;
    for (std::size_t i = 0; i < pixels.size(); i += judged_each) judged.push_back(pixels[i]);
    return FindNearerParts(RegionFit(picture, others), segments, region, pixels, judged, planes);
  }

  YcbcrImage picture;
  SegmentMap segments;
  std::vector<PairGeometry> pairs;
  std::vector<YcbcrImage> colours;

 private:
  [[nodiscard]] Ycbcr SeenAt(double x, int y, int side) const {
    const double at = x - side * DepthAt(y);
    if (at < kStrip) return {static_cast<std::uint8_t>(std::lround(120 + 60 * std::sin(0.9 * at + 0.8 * y))), 128, 128};
    const double value = 120 + contrast_ * std::sin(0.09 * at + 0.05 * y) * std::cos(0.07 * y - 0.04 * at);
    return {static_cast<std::uint8_t>(std::lround(value)), 128, 128};
  }

  double slope_;
  double contrast_;
  InverseDepthMap nothing_{kWidth, kHeight, -1e9F};
};

TEST(FindNearerParts, AFloorIsFoundBeforeAWallOfItsColour) {
  const Room room(0.12);
  const std::vector<RegionPart> parts = room.Parts();
  ASSERT_EQ(parts.size(), 1U);
  int floor = 0;
  for (const SegmentIndex s : parts.front().segments) {
    const auto [x, y] = room.segments.centers[s];
    EXPECT_NEAR(parts.front().plane.At(x, y), room.DepthAt(y), 0.5) << x << "," << y;
    floor += y > Room::kFoot + 10 ? 1 : 0;
  }
  const int all = (Room::kHeight - Room::kFoot - 10) / Room::kCell * (Room::kWidth / Room::kCell);
  EXPECT_GT(floor, all * 9 / 10);
}

TEST(FindNearerParts, AFloorIsFoundByFewOfItsPixels) {
  const Room room(0.12);
  const std::vector<RegionPart> parts = room.Parts(97);
  ASSERT_EQ(parts.size(), 1U);
  for (const SegmentIndex s : parts.front().segments) {
    const auto [x, y] = room.segments.centers[s];
    EXPECT_NEAR(parts.front().plane.At(x, y), room.DepthAt(y), 0.7) << x << "," << y;
  }
}

TEST(FindNearerParts, AWallHasNone) { EXPECT_TRUE(Room(0).Parts().empty()); }

TEST(FindNearerParts, NothingTellsWithoutTexture) { EXPECT_TRUE(Room(0.12, 0).Parts().empty()); }

// What fits better behind the surfaces around may be hidden where it does not.
TEST(FindNearerParts, WhatIsFartherIsNoPart) { EXPECT_TRUE(Room(-0.12).Parts().empty()); }

// A post before the wall that only the others see: nearer, the wall would be beside it.
TEST(FindNearerParts, AnEdgeIsNoPart) {
  Room room(0, 0);
  for (YcbcrImage& colours : room.colours) {
    for (int y = 0; y < Room::kHeight; ++y)
      for (int x = 57; x < 61; ++x) colours(x, y).y = 20;
  }
  EXPECT_TRUE(room.Parts().empty());
}

TEST(DecidePlainRegions, AFloorBeforeAWallOfItsColourIsDecidedByItself) {
  const Room room(0.12);
  const std::vector<OtherView> others = room.Others();
  const std::vector<std::uint8_t> plain = PlainSegments(Blurred(room.picture), room.segments);
  const RefinedView before = room.View();
  const std::vector<PlainRegion> regions = FindPlainRegions(room.segments, plain, before);
  ASSERT_EQ(regions.size(), 1U);
  RefinedView view = before;
  DecidePlainRegions(room.picture, room.segments, regions, others, nullptr, view);
  int right = 0;
  for (const SegmentIndex s : regions.front().segments) {
    const auto [x, y] = room.segments.centers[s];
    right += std::abs(view.planes[s].At(x, y) - room.DepthAt(y)) < 0.7 ? 1 : 0;
  }
  EXPECT_GT(right, static_cast<int>(regions.front().segments.size()) * 9 / 10);
  RefinedView on_three = before;
  DecidePlainRegions(room.picture, room.segments, regions, others, nullptr, on_three, {}, 3);
  EXPECT_EQ(on_three, view);
}

}  // namespace
}  // namespace depthfarm
