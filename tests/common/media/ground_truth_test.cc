#include "common/media/ground_truth.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/media/grey_picture.h"
#include "common/media/pfm.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing_support::TemporaryFolder;
using Encoding = GroundTruthView::Encoding;

template <typename T>
Grid<T> Row(std::vector<T> values) {
  Grid<T> grid(static_cast<int>(values.size()), 1);
  grid.values() = std::move(values);
  return grid;
}

TEST(GroundTruth, DisparityOfAPictureIsScaledAndZeroIsUnknown) {
  const TemporaryFolder folder;
  GroundTruthView view;
  view.encoding = Encoding::kDisparityPng;
  view.scale = 450;
  view.divisor = 4;
  view.depth = {folder.Write("d.png", *EncodeGreyPng(Row<std::uint8_t>({0, 4, 180})))};
  view.nonoccluded_mask = folder.Write("m.png", *EncodeGreyPng(Row<std::uint8_t>({255, 128, 0})));
  const auto truth = ReadGroundTruth(view, 0, 3, 1);
  ASSERT_TRUE(truth.ok()) << truth.status().message();
  EXPECT_THAT(truth->depth.values(), ElementsAre(0.0F, 450.0F, 10.0F));
  EXPECT_THAT(truth->nonoccluded.values(), ElementsAre(1, 0, 0));
  EXPECT_TRUE(truth->zones.empty());
}

TEST(GroundTruth, DisparityOfAPfmHasItsOffset) {
  const TemporaryFolder folder;
  GroundTruthView view;
  view.encoding = Encoding::kDisparityPfm;
  view.scale = 1000;
  view.offset = 8;
  view.depth = {folder.Write("d.pfm", EncodePfm(Row<float>({0, 2, -8, -9, std::numeric_limits<float>::infinity()})))};
  const auto truth = ReadGroundTruth(view, 0, 5, 1);
  ASSERT_TRUE(truth.ok()) << truth.status().message();
  EXPECT_THAT(truth->depth.values(), ElementsAre(125.0F, 100.0F, 0.0F, 0.0F, 0.0F));
}

TEST(GroundTruth, DepthAndZonesAreThoseOfTheFrame) {
  const TemporaryFolder folder;
  GroundTruthView view;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  view.depth = {folder.Write("0.pfm", EncodePfm(Row<float>({1, 1, 1}))),
                folder.Write("1.pfm", EncodePfm(Row<float>({2.5F, -1, nan})))};
  view.zones = {folder.Write("0.png", *EncodeGreyPng(Row<std::uint8_t>({1, 1, 1}))),
                folder.Write("1.png", *EncodeGreyPng(Row<std::uint8_t>({3, 2, 0})))};
  const auto truth = ReadGroundTruth(view, 1, 3, 1);
  ASSERT_TRUE(truth.ok()) << truth.status().message();
  EXPECT_THAT(truth->depth.values(), ElementsAre(2.5F, 0.0F, 0.0F));
  EXPECT_THAT(truth->zones.values(), ElementsAre(3, 2, 0));
  EXPECT_TRUE(truth->nonoccluded.empty());
}

TEST(GroundTruth, ErrorsNameTheFileOrTheFrame) {
  const TemporaryFolder folder;
  GroundTruthView view;
  view.view = "cam0";
  view.depth = {folder.Write("0.pfm", EncodePfm(Row<float>({1, 1, 1})))};
  EXPECT_THAT(ReadGroundTruth(view, 0, 3, 2).status().message(), HasSubstr(view.depth[0] + ": has 3x1 pixels"));
  EXPECT_THAT(ReadGroundTruth(view, 1, 3, 1).status().message(), HasSubstr("'cam0' has 1 frames"));
  EXPECT_FALSE(ReadGroundTruth(view, -1, 3, 1).ok());
  view.zones = {folder.Write("z.png", *EncodeGreyPng(Row<std::uint16_t>({1, 1, 1})))};
  EXPECT_THAT(ReadGroundTruth(view, 0, 3, 1).status().message(), HasSubstr("z.png: has 16 bits"));
}

}  // namespace
}  // namespace depthfarm
