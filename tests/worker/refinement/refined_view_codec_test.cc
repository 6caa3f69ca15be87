#include "worker/refinement/refined_view_codec.h"

#include <gtest/gtest.h>

#include <limits>

#include "common/compression/zstd_frame.h"

namespace depthfarm {
namespace {

RefinedView SmallView() {
  RefinedView view{.planes = {{0.25F, -1e-3F, 7}, {0, 0, -2.5F}, {1e-20F, 3, 1e6F}, {0.1F, 0.2F, 0.3F}},
                   .kept = {0, 1, 0},
                   .plane_of_pixel = Grid<PlaneIndex>(6, 5)};
  for (std::size_t i = 0; i < view.plane_of_pixel.size(); ++i)
    view.plane_of_pixel.values()[i] = static_cast<PlaneIndex>(i * 7 % 4);
  return view;
}

// Bytes of a well-formed frame with the content of a view's own, changed.
std::string Changed(const RefinedView& view, std::size_t at, char value) {
  const std::string bytes = EncodeRefinedView(view);
  std::string content = ReadZstdFrame(std::string_view(bytes).substr(8), 16, 1 << 20).value();
  content.at(at) = value;
  std::string changed = bytes.substr(0, 8);
  AppendZstdFrame(content, changed);
  return changed;
}

TEST(RefinedViewCodec, GivesBackTheViewToTheBit) {
  const RefinedView view = SmallView();
  const auto decoded = DecodeRefinedView(EncodeRefinedView(view));
  ASSERT_TRUE(decoded.ok()) << decoded.status().message();
  EXPECT_EQ(*decoded, view);
  EXPECT_EQ(EncodeRefinedView(*decoded), EncodeRefinedView(view));
}

TEST(RefinedViewCodec, RefusesEveryTruncation) {
  const std::string bytes = EncodeRefinedView(SmallView());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_EQ(DecodeRefinedView(std::string_view(bytes).substr(0, size)).status().code(), ErrorCode::kCorrupt) << size;
  EXPECT_EQ(DecodeRefinedView(bytes + '\0').status().code(), ErrorCode::kCorrupt);
}

TEST(RefinedViewCodec, NeverGivesAnotherViewForAFlippedBit) {
  const RefinedView view = SmallView();
  const std::string bytes = EncodeRefinedView(view);
  int refused = 0;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string damaged = bytes;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << bit % 8));
    const auto decoded = DecodeRefinedView(damaged);
    refused += decoded.ok() ? 0 : 1;
    if (decoded.ok()) {
      EXPECT_EQ(*decoded, view);
    }
  }
  EXPECT_GT(refused, static_cast<int>(8 * bytes.size() * 9 / 10));
}

TEST(RefinedViewCodec, RefusesWhatNoViewHas) {
  const RefinedView view = SmallView();
  const auto message = [](const std::string& bytes) {
    const auto decoded = DecodeRefinedView(bytes);
    EXPECT_FALSE(decoded.ok());
    return decoded.status().message();
  };
  EXPECT_NE(message(Changed(view, 0, 0)).find("expected sides of 1 to"), std::string::npos);
  EXPECT_NE(message(Changed(view, 3, 0x7f)).find("expected sides of 1 to"), std::string::npos);
  EXPECT_NE(message(Changed(view, 8, 0)).find("0 segments"), std::string::npos);
  EXPECT_NE(message(Changed(view, 8, 5)).find("5 segments and 4 planes"), std::string::npos);
  EXPECT_NE(message(Changed(view, 15, 1)).find("planes do not fit 30 pixels"), std::string::npos);
  EXPECT_NE(message(Changed(view, 16, 2)).find("kept flag is 2"), std::string::npos);
  EXPECT_NE(message(Changed(view, 12, 3)).find("refined view"), std::string::npos);
  RefinedView infinite = view;
  infinite.planes[3].b = std::numeric_limits<float>::infinity();
  EXPECT_NE(message(EncodeRefinedView(infinite)).find("plane 3 is not finite"), std::string::npos);
  RefinedView beyond = view;
  beyond.plane_of_pixel(2, 3) = 4;
  EXPECT_NE(message(EncodeRefinedView(beyond)).find("label at (2, 3)"), std::string::npos);
  std::string other_version = EncodeRefinedView(view);
  other_version[4] = 9;
  EXPECT_EQ(DecodeRefinedView(other_version).status().code(), ErrorCode::kIncompatible);
}

}  // namespace
}  // namespace depthfarm
