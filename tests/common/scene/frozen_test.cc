// Scene set v1 (tests/experiments/scenes_v1.json) is frozen: figures recorded on it stay comparable. A generator that
// draws other pictures makes scene set v2, with new lists and new records.

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "common/scene/array.h"
#include "common/scene/render.h"

namespace depthfarm {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 72;
constexpr int kBlock = 24;  // pixels a side: 4 x 3 blocks

// Means over a block of a view's luma and of 1/z, and over all blocks in reading order.
struct Block {
  double luma;
  double inverse_depth;
};
using Blocks = std::array<Block, 12>;

Blocks BlocksOf(const RenderedView& view) {
  Blocks blocks = {};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      Block& block = blocks[static_cast<std::size_t>(y / kBlock * (kWidth / kBlock) + x / kBlock)];
      const auto [r, g, b] = view.rgb(x, y);
      block.luma += (0.299 * r + 0.587 * g + 0.114 * b) / (kBlock * kBlock);
      block.inverse_depth += 1.0 / view.depth(x, y) / (kBlock * kBlock);
    }
  }
  return blocks;
}

struct Golden {
  ArrayKind kind;
  int seed;
  int frame;
  Blocks blocks;  // of cam1 of three, with the default noise and gain
};

// Made by this generator on the day the set was frozen (2026-11-27). Block means, not bytes, and room for a pixel:
// mathematical functions of other machines may round otherwise.
const std::vector<Golden> kGolden = {
    {ArrayKind::kArc,
     101,
     0,
     {{{98.1632, 0.157713},
       {138.4202, 0.153296},
       {132.7620, 0.146263},
       {137.2932, 0.151257},
       {90.7608, 0.164418},
       {120.4777, 0.172911},
       {130.7961, 0.160529},
       {125.7753, 0.160739},
       {109.8555, 0.231289},
       {111.6559, 0.232620},
       {116.1446, 0.233330},
       {115.6723, 0.226694}}}},
    {ArrayKind::kIrregular,
     204,
     7,
     {{{88.1548, 0.157979},
       {131.1719, 0.149932},
       {128.4835, 0.147514},
       {132.9077, 0.155459},
       {87.2387, 0.161702},
       {124.5584, 0.160628},
       {118.6163, 0.173426},
       {118.5801, 0.170153},
       {118.3371, 0.221737},
       {114.8601, 0.225161},
       {118.5690, 0.223940},
       {119.0433, 0.220367}}}},
};

TEST(SceneSetV1, TheGeneratorStillDrawsIt) {
  for (const Golden& golden : kGolden) {
    const std::vector<Camera> cameras = MakeArray(golden.kind, 3, kWidth, kHeight, golden.seed);
    const Blocks blocks = BlocksOf(RenderView(MakeScene(golden.seed), cameras[1], golden.frame, RenderOptions()));
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const std::string where = "seed " + std::to_string(golden.seed) + ", block " + std::to_string(i);
      EXPECT_NEAR(blocks[i].luma, golden.blocks[i].luma, 0.2) << where << ": another generator is another scene set";
      EXPECT_NEAR(blocks[i].inverse_depth, golden.blocks[i].inverse_depth, 3e-4) << where;
    }
  }
}

}  // namespace
}  // namespace depthfarm
