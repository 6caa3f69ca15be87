#include "common/geometry/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "tests/common/geometry/plain_geometry.h"
#include "tests/support/plane_scene.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Camera GoodCamera() { return ForwardCamera("left", 1, 2, 320, 240, 300); }

struct BadCamera {
  std::string what;
  std::function<void(Camera&)> spoil;
  std::string message_part;
};

TEST(ValidateCamera, RefusesWhatIsNoPinholeCameraAndSaysWhy) {
  const BadCamera cases[] = {
      {"no width", [](Camera& c) { c.width = 0; }, "size is 0x240"},
      {"negative height", [](Camera& c) { c.height = -1; }, "size is 320x-1"},
      {"too wide", [](Camera& c) { c.width = 32769; }, "1 to 32768"},
      {"too high", [](Camera& c) { c.height = 32769; }, "1 to 32768"},
      {"K NaN", [](Camera& c) { c.intrinsics(0, 2) = kNaN; }, "K holds"},
      {"K infinite", [](Camera& c) { c.intrinsics(0, 0) = kInfinity; }, "K holds"},
      {"focal x 0", [](Camera& c) { c.intrinsics(0, 0) = 0; }, "focal lengths are 0 and 300"},
      {"focal y negative", [](Camera& c) { c.intrinsics(1, 1) = -1.5; }, "focal lengths are 300 and -1.5"},
      {"K below the diagonal", [](Camera& c) { c.intrinsics(1, 0) = 0.1; }, "upper triangular"},
      {"K last row, left", [](Camera& c) { c.intrinsics(2, 0) = 1; }, "last row 0 0 1"},
      {"K last row, middle", [](Camera& c) { c.intrinsics(2, 1) = 1; }, "last row 0 0 1"},
      {"K last row, right", [](Camera& c) { c.intrinsics(2, 2) = 2; }, "last row 0 0 1"},
      {"R NaN", [](Camera& c) { c.cam_from_world_rotation(2, 1) = kNaN; }, "R holds"},
      {"t NaN", [](Camera& c) { c.cam_from_world_translation[1] = kNaN; }, "t holds"},
      {"t infinite", [](Camera& c) { c.cam_from_world_translation[2] = kInfinity; }, "t holds"},
      {"R scaled", [](Camera& c) { c.cam_from_world_rotation *= 1.01; }, "rows 0 and 0"},
      {"R sheared", [](Camera& c) { c.cam_from_world_rotation(1, 2) = 0.01; }, "rows 1 and 2"},
      {"R zero", [](Camera& c) { c.cam_from_world_rotation.setZero(); }, "rows 0 and 0 have the product 0"},
      {"R mirrors", [](Camera& c) { c.cam_from_world_rotation(1, 1) = -1; }, "determinant -1"},
  };
  for (const BadCamera& bad : cases) {
    Camera camera = GoodCamera();
    bad.spoil(camera);
    const Status status = ValidateCamera(camera);
    EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument) << bad.what;
    EXPECT_THAT(status.message(), HasSubstr("camera 'left'")) << bad.what;
    EXPECT_THAT(status.message(), HasSubstr(bad.message_part)) << bad.what;
  }
}

TEST(ValidateCamera, AcceptsAnyRotationSkewAndSize) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 100; ++i) {
    const Camera camera = AnyCamera(random, "any", std::numbers::pi, 1e6);
    EXPECT_TRUE(ValidateCamera(camera).ok()) << ValidateCamera(camera).message();
  }
  Camera extreme = GoodCamera();
  extreme.width = 32768;
  extreme.height = 1;
  EXPECT_TRUE(ValidateCamera(extreme).ok());
}

TEST(ValidateCamera, ForgivesARotationWrittenWithFewDigits) {
  Camera camera = GoodCamera();
  camera.cam_from_world_rotation(0, 1) = 9e-4;
  EXPECT_TRUE(ValidateCamera(camera).ok());
  camera.cam_from_world_rotation(0, 1) = 1.1e-3;
  EXPECT_FALSE(ValidateCamera(camera).ok());
}

TEST(Camera, CenterIsTheOriginOfTheCameraFrameAndTheAxisItsZ) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 100; ++i) {
    const Camera camera = AnyCamera(random, "any", std::numbers::pi, 10);
    const Eigen::Vector3d center = CenterInWorld(camera);
    EXPECT_LT(PointInCamera(camera, center).norm(), 1e-12);
    const Eigen::Vector3d ahead = PointInCamera(camera, center + 2 * OpticalAxisInWorld(camera));
    EXPECT_LT((ahead - Eigen::Vector3d(0, 0, 2)).norm(), 1e-12);
  }
}

TEST(Downscaled, KeepsTheOuterEdgesOfThePicture) {
  // Pixels are squares around their centres: the left edge is at -0.5 on every scale.
  const Camera full = GoodCamera();
  for (const int factor : {1, 2, 4, 8}) {
    const Camera small = Downscaled(full, factor);
    EXPECT_EQ(small.width, 320 / factor);
    EXPECT_EQ(small.height, 240 / factor);
    EXPECT_DOUBLE_EQ(small.intrinsics(0, 0), 300.0 / factor);
    EXPECT_DOUBLE_EQ(small.intrinsics(1, 1), 300.0 / factor);
    EXPECT_DOUBLE_EQ(small.intrinsics(0, 2), (159.5 + 0.5) / factor - 0.5);
    EXPECT_DOUBLE_EQ(small.intrinsics(1, 2), (119.5 + 0.5) / factor - 0.5);
    EXPECT_EQ(small.name, full.name);
    EXPECT_EQ(small.cam_from_world_rotation, full.cam_from_world_rotation);
    EXPECT_EQ(small.cam_from_world_translation, full.cam_from_world_translation);
  }
}

TEST(Downscaled, EveryPointMovesToItsPixelOfTheSmallerPicture) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 100; ++i) {
    const Camera full = AnyCamera(random, "any", std::numbers::pi, 10);
    const Eigen::Vector3d point = PointAt(full, Uniform(random, 0, 23), Uniform(random, 0, 15), Uniform(random, 1, 50));
    for (const int factor : {2, 4}) {
      const Eigen::Vector2d expected =
          (PixelOf(full, point) + Eigen::Vector2d(0.5, 0.5)) / factor - Eigen::Vector2d(0.5, 0.5);
      EXPECT_LT((PixelOf(Downscaled(full, factor), point) - expected).norm(), 1e-9);
    }
  }
}

TEST(Downscaled, RoundsOddSizesDown) {
  Camera camera = GoodCamera();
  camera.width = 323;
  camera.height = 241;
  EXPECT_EQ(Downscaled(camera, 4).width, 80);
  EXPECT_EQ(Downscaled(camera, 4).height, 60);
}

TEST(InverseIntrinsics, UndoesFocalLengthsSkewAndPrincipalPoint) {
  Eigen::Matrix3d k;
  k << 2, 1, 3, 0, 4, 8, 0, 0, 1;
  Eigen::Matrix3d expected;  // by hand: y = (v - 8) / 4, x = (u - 3 - y) / 2
  expected << 0.5, -0.125, -0.5, 0, 0.25, -2, 0, 0, 1;
  EXPECT_EQ(InverseIntrinsics(k), expected);
  std::mt19937_64 random(4);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix3d any = AnyCamera(random, "any", 1, 1).intrinsics;
    EXPECT_LT((InverseIntrinsics(any) * any - Eigen::Matrix3d::Identity()).norm(), 1e-13);
  }
}

TEST(OrderedProducts, AreTheProducts) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Matrix3d a = AnyCamera(random, "a", std::numbers::pi, 1).cam_from_world_rotation;
    const Eigen::Matrix3d b = AnyCamera(random, "b", 1, 1).intrinsics;
    const Eigen::Vector3d v = AnyDirection(random);
    EXPECT_LT((OrderedProduct(a, b) - a * b).norm(), 1e-13);
    EXPECT_LT((OrderedProduct(b, v) - b * v).norm(), 1e-13);
    EXPECT_NEAR(OrderedDot(v, a.col(0)), v.dot(a.col(0)), 1e-15);
  }
}

}  // namespace
}  // namespace depthfarm
