#include "common/scene/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "common/geometry/neighbours.h"
#include "common/scene/array.h"
#include "common/scene/render.h"

namespace depthfarm {
namespace {

constexpr RenderOptions kFast{.noise = 0, .gain = 0, .samples_per_side = 1};

struct Case {
  ArrayKind kind;
  int cameras;
  std::uint64_t seed;
};
constexpr Case kCases[] = {{ArrayKind::kArc, 8, 1},  {ArrayKind::kArc, 5, 2},       {ArrayKind::kLine, 8, 3},
                           {ArrayKind::kGrid, 9, 4}, {ArrayKind::kIrregular, 6, 5}, {ArrayKind::kMixed, 6, 6},
                           {ArrayKind::kArc, 24, 7}};

double Share(const ZoneMap& zones, Zone zone) {
  const auto count = std::count(zones.values().begin(), zones.values().end(), static_cast<std::uint8_t>(zone));
  return static_cast<double>(count) / static_cast<double>(zones.size());
}

TEST(Scene, EveryViewShowsEveryZoneAndNothingElse) {
  for (const Case& c : kCases) {
    const Scene scene = MakeScene(c.seed);
    for (const Camera& camera : MakeArray(c.kind, c.cameras, 160, 120, c.seed)) {
      const ZoneMap zones = RenderView(scene, camera, 0, kFast).zones;
      SCOPED_TRACE(testing::Message() << "seed " << c.seed << " " << camera.name);
      EXPECT_EQ(Share(zones, Zone::kUnknown), 0);
      EXPECT_GT(Share(zones, Zone::kTextured), 0.1);
      EXPECT_GT(Share(zones, Zone::kSlanted), 0.1);
      EXPECT_GT(Share(zones, Zone::kCurved), 0.01);
      EXPECT_GT(Share(zones, Zone::kThin), 0.002);
      EXPECT_GT(Share(zones, Zone::kPerson), 0.03);
      EXPECT_GT(Share(zones, Zone::kBox), 0.01);
    }
  }
}

TEST(Scene, PanelTakesAboutATenthOfThePictureInAllFrames) {
  for (const Case& c : kCases) {
    const Scene scene = MakeScene(c.seed);
    const std::vector<Camera> cameras = MakeArray(c.kind, c.cameras, 160, 120, c.seed);
    for (const int frame : {0, 16, 40}) {
      for (const Camera& camera : {cameras.front(), cameras.back()}) {
        const double share = Share(RenderView(scene, camera, frame, kFast).zones, Zone::kPanel);
        EXPECT_GE(share, 0.08) << "seed " << c.seed << " " << camera.name;
        EXPECT_LE(share, 0.13) << "seed " << c.seed << " " << camera.name;
      }
    }
  }
}

TEST(Scene, PanelIsPartlyBehindThePersonWhoWalks) {
  const Scene scene = MakeScene(1);
  const std::vector<Camera> cameras = MakeArray(ArrayKind::kArc, 3, 320, 240, 1);
  Scene empty = scene;
  empty.persons.clear();
  for (const int frame : {0, 16, 32, 48}) {
    const double behind = Share(RenderView(scene, cameras[1], frame, kFast).zones, Zone::kPanel);
    const double alone = Share(RenderView(empty, cameras[1], frame, kFast).zones, Zone::kPanel);
    EXPECT_LT(behind, 0.97 * alone);
  }
}

TEST(Scene, ThinThingsAreTwoToFivePixelsWide) {
  const Scene scene = MakeScene(1);
  const Camera camera = MakeArray(ArrayKind::kArc, 3, 1024, 768, 1)[1];
  int thin = 0;
  for (const Shape& shape : scene.still) {
    if (shape.zone != Zone::kThin) continue;
    ++thin;
    const double depth = (camera.cam_from_world_rotation * shape.center + camera.cam_from_world_translation).z();
    const double width_px = 2 * shape.extent.x() / depth * camera.intrinsics(0, 0);
    EXPECT_GE(width_px, 2);
    EXPECT_LE(width_px, 6);
  }
  EXPECT_GE(thin, 10);
}

TEST(Scene, EverythingVisibleLiesBetweenNearAndFar) {
  constexpr int kFrames = 40;
  for (const Case& c : kCases) {
    const Scene scene = MakeScene(c.seed);
    const std::vector<Camera> cameras = MakeArray(c.kind, c.cameras, 160, 120, c.seed);
    const Camera& reference = cameras[CentreCamera(cameras)];
    const Result<DepthRange> range = SceneDepthRange(scene, cameras, reference, kFrames);
    ASSERT_TRUE(range.ok()) << range.status().message();
    const DepthLevels levels = DepthLevels::Create(reference, range->z_near, range->z_far, 2).value();
    double nearest = range->z_far;
    double farthest = range->z_near;
    for (const int frame : {0, 39}) {
      for (const Camera& camera : cameras) {
        const LevelsInView in_view(camera, levels);
        const DepthMap depth = RenderView(scene, camera, frame, kFast).depth;
        for (int y = 0; y < depth.height(); ++y) {
          for (int x = 0; x < depth.width(); ++x) {
            const double depth_in_ref = in_view.DepthInRef(x, y, depth(x, y));
            nearest = std::min(nearest, depth_in_ref);
            farthest = std::max(farthest, depth_in_ref);
          }
        }
      }
    }
    EXPECT_GT(nearest, range->z_near);
    EXPECT_LT(farthest, range->z_far);
    // A loose range would waste depth levels.
    EXPECT_LT(nearest, 1.1 * range->z_near) << "seed " << c.seed;
    EXPECT_GT(farthest, 0.95 * range->z_far) << "seed " << c.seed;
  }
}

TEST(Scene, DepthRangeThatReachesBehindTheReferenceIsRefused) {
  const Scene scene = MakeScene(1);
  std::vector<Camera> cameras = MakeArray(ArrayKind::kArc, 2, 160, 120, 1);
  cameras[0].cam_from_world_translation.z() -= 6.5;  // far into the room
  const Result<DepthRange> range = SceneDepthRange(scene, cameras, cameras[0], 1);
  ASSERT_FALSE(range.ok());
  EXPECT_NE(range.status().message().find("'cam0'"), std::string::npos);
}

TEST(Scene, SeedsChangeLayoutAndTexture) {
  const Camera camera = MakeArray(ArrayKind::kArc, 3, 160, 120, 1)[1];
  const RenderedView one = RenderView(MakeScene(1), camera, 0, kFast);
  const RenderedView two = RenderView(MakeScene(2), camera, 0, kFast);
  EXPECT_NE(one.rgb, two.rgb);
  EXPECT_NE(one.depth, two.depth);
}

TEST(Scene, PosesRepeatWithNoJumpAndDependOnTheFrameAlone) {
  const Scene scene = MakeScene(1);
  for (const Person& person : scene.persons) {
    for (int frame = 0; frame < 100; ++frame) {
      const std::vector<Shape> now = PosedPerson(person, frame);
      const std::vector<Shape> next = PosedPerson(person, frame + 1);
      ASSERT_EQ(now.size(), next.size());
      for (std::size_t i = 0; i < now.size(); ++i) {
        // The fastest part, a swinging foot or waving hand, at 25 frames per second.
        EXPECT_LT((now[i].center - next[i].center).norm(), 0.15);
        EXPECT_EQ(now[i].zone, Zone::kPerson);
      }
    }
  }
}

}  // namespace
}  // namespace depthfarm
