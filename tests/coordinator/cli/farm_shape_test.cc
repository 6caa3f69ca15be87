#include "coordinator/cli/farm_shape.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

TEST(FarmShape, SlotsOnAllCoresFewToAProcess) {
  for (const auto& [cores, shape] : {std::pair{1, FarmShape{1, 1}},
                                     {2, {1, 2}},
                                     {3, {1, 3}},
                                     {4, {1, 4}},
                                     {6, {2, 3}},
                                     {7, {7, 1}},
                                     {8, {2, 4}},
                                     {10, {5, 2}},
                                     {64, {16, 4}}}) {
    EXPECT_EQ(ShapeOfFarm(0, 0, cores), shape) << cores << " cores";
  }
}

TEST(FarmShape, AsNamed) {
  EXPECT_EQ(ShapeOfFarm(3, 0, 8), (FarmShape{3, 1}));
  EXPECT_EQ(ShapeOfFarm(3, 2, 8), (FarmShape{3, 2}));
  EXPECT_EQ(ShapeOfFarm(0, 8, 8), (FarmShape{1, 8}));
  EXPECT_EQ(ShapeOfFarm(0, 3, 8), (FarmShape{2, 3}));
  EXPECT_EQ(ShapeOfFarm(0, 16, 8), (FarmShape{1, 16}));
}

}  // namespace
}  // namespace depthfarm
