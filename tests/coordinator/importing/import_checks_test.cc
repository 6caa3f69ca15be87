#include "coordinator/importing/import_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Camera At(const std::string& name, double x, double z_of_axis = 1) {
  Camera camera{.name = name, .width = 640, .height = 480};
  camera.intrinsics << 500, 0, 319.5, 0, 500, 239.5, 0, 0, 1;
  camera.cam_from_world_rotation << z_of_axis, 0, 0, 0, 1, 0, 0, 0, z_of_axis;  // +1, or -1: turned round
  camera.cam_from_world_translation = -camera.cam_from_world_rotation * Eigen::Vector3d(x, 0, 0);
  return camera;
}

TEST(LookAtArray, TellsBaselineAndDisparity) {
  const auto overview = LookAtArray({At("a", 0), At("b", 1), At("c", 1.5)}, 1, {.z_near = 5, .z_far = 50});
  ASSERT_TRUE(overview.ok()) << overview.status().message();
  EXPECT_EQ(overview->nearest, "c");
  EXPECT_DOUBLE_EQ(overview->baseline, 0.5);
  EXPECT_DOUBLE_EQ(overview->disparity_near, 50);
  EXPECT_DOUBLE_EQ(overview->disparity_far, 5);
  EXPECT_THAT(overview->lonely, IsEmpty());
}

TEST(LookAtArray, NamesACameraThatLooksElsewhere) {
  const auto overview = LookAtArray({At("a", 0), At("b", 1), At("away", 0.5, -1)}, 0, {.z_near = 5, .z_far = 50});
  ASSERT_TRUE(overview.ok()) << overview.status().message();
  EXPECT_THAT(overview->lonely, ElementsAre("away"));
}

TEST(LookAtArray, OneCameraHasNoNeighbour) {
  const auto overview = LookAtArray({At("a", 0)}, 0, {.z_near = 5, .z_far = 50});
  ASSERT_TRUE(overview.ok()) << overview.status().message();
  EXPECT_EQ(overview->nearest, "");
}

TEST(LookAtArray, RefusesWhatShowsNothingInCommon) {
  const auto apart = LookAtArray({At("a", 0), At("b", 1000)}, 0, {.z_near = 5, .z_far = 50});
  EXPECT_THAT(apart.status().message(),
              HasSubstr("no two cameras see the same part of the scene at depths of 5 to 50"));
  const auto back_to_back = LookAtArray({At("a", 0), At("b", 1, -1)}, 0, {.z_near = 5, .z_far = 50});
  EXPECT_THAT(back_to_back.status().message(), HasSubstr("no two cameras"));
  const auto one_place = LookAtArray({At("a", 2), At("b", 2)}, 0, {.z_near = 5, .z_far = 50});
  EXPECT_THAT(one_place.status().message(), HasSubstr("at one place"));
  EXPECT_EQ(LookAtArray({At("a", 0), At("b", 1)}, 0, {.z_near = 50, .z_far = 5}).status().code(),
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
