#include <gtest/gtest.h>

#include "common/quality/masks.h"
#include "common/quality/psnr.h"
#include "common/scene/array.h"
#include "common/scene/render.h"
#include "common/scene/scene.h"
#include "common/synthesis/synthesize_view.h"

namespace depthfarm {
namespace {

// At this size most pixels of thin things are mixed colours: the floors are 3 dB below what 1024 x 768 gives (37 dB and
// 38.4 dB outside holes), where the noise alone, sigma 1.5, would be 44 dB.
TEST(SynthesizeView, ExactDepthOfARenderedArcIsNearlyPerfect) {
  const Scene scene = MakeScene(3);
  const std::vector<Camera> cameras = MakeArray(ArrayKind::kArc, 8, 480, 360, 3);
  const RenderOptions options = {.noise = 1.5, .gain = 0};
  const RenderedView left = RenderView(scene, cameras[2], 0, options);
  const RenderedView real = RenderView(scene, cameras[3], 0, options);
  const RenderedView right = RenderView(scene, cameras[4], 0, options);
  const YcbcrImage left_picture = ToYcbcr(left.rgb);
  const YcbcrImage right_picture = ToYcbcr(right.rgb);
  const YcbcrImage real_picture = ToYcbcr(real.rgb);
  const Result<SynthesizedView> view = SynthesizeView(
      {{&left_picture, &left.depth, cameras[2]}, {&right_picture, &right.depth, cameras[4]}}, cameras[3]);
  ASSERT_TRUE(view.ok());
  const PixelMask seen = Inverted(view->holes);
  EXPECT_GT(PsnrVideoRange(MeasureLumaError(view->picture, real_picture)), 33.5);
  EXPECT_GT(PsnrVideoRange(MeasureLumaError(view->picture, real_picture, &seen)), 35);
  EXPECT_LT(ShareSet(view->holes), 0.02);
}

}  // namespace
}  // namespace depthfarm
