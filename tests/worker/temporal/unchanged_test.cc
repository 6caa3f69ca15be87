#include "worker/temporal/unchanged.h"

#include <gtest/gtest.h>

#include <utility>

namespace depthfarm {
namespace {

// Segments that are the columns of a 4 x 1 picture, with the given grey means (in 1/64 grey).
SegmentMap Columns(const std::vector<int>& means_64) {
  SegmentMap map;
  map.labels = Grid<SegmentIndex>(static_cast<int>(means_64.size()), 1);
  for (std::size_t i = 0; i < means_64.size(); ++i) {
    map.labels.values()[i] = static_cast<SegmentIndex>(i);
    map.centers.push_back({static_cast<std::int32_t>(i), 0});
    map.means.push_back({means_64[i], 0, 0});
  }
  return map;
}

TEST(FindUnchanged, TakesThePreviousFrameBelowItsThreshold) {  // III-E, T_P = 3
  const SegmentMap i_frame = Columns({0, 0, 0, 0});
  const SegmentMap previous = Columns({6400, 6400, 6400, 6400});
  const SegmentMap current = Columns({6400 + 3 * 64 - 1, 6400 + 3 * 64, 6400 - 3 * 64 + 1, 6400 - 3 * 64});
  const std::vector<AdoptedSegment> adopted = FindUnchanged(current, previous, i_frame, 3, 1);
  EXPECT_EQ(adopted[0].source, DepthSource::kPrevious);
  EXPECT_EQ(adopted[1].source, DepthSource::kEstimated);  // "changed less than": exactly the threshold is a change
  EXPECT_EQ(adopted[2].source, DepthSource::kPrevious);
  EXPECT_EQ(adopted[3].source, DepthSource::kEstimated);
}

TEST(FindUnchanged, PrefersTheIFrameWhereBothHold) {
  const SegmentMap i_frame = Columns({6400, 6400});
  const SegmentMap previous = Columns({6410, 6500});
  const SegmentMap current = Columns({6420, 6500});
  const std::vector<AdoptedSegment> adopted = FindUnchanged(current, previous, i_frame, 3, 1);
  EXPECT_EQ(adopted[0].source, DepthSource::kIFrame);    // 20/64 < 1
  EXPECT_EQ(adopted[1].source, DepthSource::kPrevious);  // 100/64 >= 1
}

TEST(FindUnchanged, ComparesEveryComponent) {
  SegmentMap current = Columns({6400});
  const SegmentMap same = current;
  current.means[0].cr = 4 * 64;
  EXPECT_EQ(FindUnchanged(current, same, same, 3, 1)[0].source, DepthSource::kEstimated);
}

TEST(FindUnchanged, CollocatedIsTheSegmentUnderTheCentre) {
  SegmentMap reference = Columns({0, 6400, 6400, 0});
  std::swap(reference.labels.values()[1], reference.labels.values()[2]);
  const SegmentMap current = Columns({0, 6400, 6400, 0});
  const std::vector<AdoptedSegment> adopted =
      FindUnchanged(current, reference, Columns({9999, 9999, 9999, 9999}), 3, 1);
  EXPECT_EQ(adopted[1].collocated, 2U);
  EXPECT_EQ(adopted[2].collocated, 1U);
}

TEST(FindUnchanged, AThresholdOfZeroTurnsAConditionOff) {
  const SegmentMap map = Columns({6400});
  EXPECT_EQ(FindUnchanged(map, map, map, 0, 0)[0].source, DepthSource::kEstimated);
  EXPECT_EQ(FindUnchanged(map, map, map, 3, 0)[0].source, DepthSource::kPrevious);
}

}  // namespace
}  // namespace depthfarm
