#include "common/geometry/camera_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;

// On a circle of radius 2 around the origin, looking inwards.
Camera OnCircle(const std::string& name, double angle) {
  Camera camera = ForwardCamera(name, 0, 0, 64, 48, 50);
  camera.cam_from_world_rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
  camera.cam_from_world_translation = {0, 0, 2};
  return camera;
}

TEST(CameraPath, StopsAreTheStopsToTheBit) {
  const CameraPath path = CameraPath::Create({OnCircle("a", 0), OnCircle("b", 0.2), OnCircle("c", 0.5)}).value();
  for (const double angle : {0.0, 0.2, 0.5}) {
    const int position = angle == 0 ? 0 : (angle == 0.2 ? 1 : 2);
    const Camera camera = path.At(position, "v");
    EXPECT_EQ(camera.name, "v");
    EXPECT_EQ(camera.cam_from_world_rotation, OnCircle("x", angle).cam_from_world_rotation);
    EXPECT_EQ(camera.cam_from_world_translation, OnCircle("x", angle).cam_from_world_translation);
  }
  EXPECT_EQ(path.At(-1, "").cam_from_world_rotation, OnCircle("a", 0).cam_from_world_rotation);
  EXPECT_EQ(path.At(9, "").cam_from_world_rotation, OnCircle("c", 0.5).cam_from_world_rotation);
}

TEST(CameraPath, BetweenTwoStopsIsAStraightLineAtTheHalfwayTurn) {
  Camera right = OnCircle("b", 0.4);
  right.intrinsics(0, 0) = 60;
  const Camera left = OnCircle("a", 0);
  const Camera middle = CameraPath::Create({left, right}).value().At(0.5, "m");
  EXPECT_LT((CenterInWorld(middle) - 0.5 * (CenterInWorld(left) + CenterInWorld(right))).norm(), 1e-12);
  EXPECT_LT((middle.cam_from_world_rotation - OnCircle("m", 0.2).cam_from_world_rotation).norm(), 1e-12);
  EXPECT_EQ(middle.intrinsics(0, 0), 55);
  EXPECT_TRUE(ValidateCamera(middle).ok());
}

TEST(CameraPath, FollowsAnArcAndHasNoKinks) {
  std::vector<Camera> stops;
  stops.reserve(6);
  for (int i = 0; i < 6; ++i) stops.push_back(OnCircle("s", 0.2 * i));
  const CameraPath path = CameraPath::Create(stops).value();
  EXPECT_NEAR(CenterInWorld(path.At(2.5, "")).norm(), 2, 2e-3);  // the chord's middle is at 1.99
  const auto speed = [&](double at) {
    return Eigen::Vector3d((CenterInWorld(path.At(at + 1e-4, "")) - CenterInWorld(path.At(at, ""))) / 1e-4);
  };
  EXPECT_LT((speed(2 - 1.5e-4) - speed(2 + 0.5e-4)).norm(), 1e-3);
}

TEST(CameraPath, SamplesFromEndToEnd) {
  const CameraPath path = CameraPath::Create({OnCircle("a", 0), OnCircle("b", 0.2), OnCircle("c", 0.4)}).value();
  const std::vector<Camera> cameras = path.Sample(5);
  ASSERT_EQ(cameras.size(), 5U);
  EXPECT_EQ(cameras[0].name, "view 0");
  EXPECT_EQ(cameras[4].name, "view 4");
  EXPECT_EQ(cameras[2].cam_from_world_rotation, OnCircle("b", 0.2).cam_from_world_rotation);
  EXPECT_EQ(cameras[4].cam_from_world_rotation, OnCircle("c", 0.4).cam_from_world_rotation);
  EXPECT_EQ(path.Sample(1)[0].cam_from_world_rotation, OnCircle("b", 0.2).cam_from_world_rotation);
}

TEST(CameraPath, RefusesStopsThatDoNotFit) {
  EXPECT_THAT(CameraPath::Create({OnCircle("a", 0)}).status().message(), HasSubstr("at least two"));
  Camera larger = OnCircle("b", 0.2);
  larger.width = 128;
  EXPECT_THAT(CameraPath::Create({OnCircle("a", 0), larger}).status().message(), HasSubstr("'a' is 64x48, 'b' 128x48"));
}

}  // namespace
}  // namespace depthfarm
