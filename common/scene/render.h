#ifndef DEPTHFARM_COMMON_SCENE_RENDER_H_
#define DEPTHFARM_COMMON_SCENE_RENDER_H_

#include "common/geometry/camera.h"
#include "common/image/picture.h"
#include "common/scene/scene.h"

namespace depthfarm {

struct RenderOptions {
  double noise = 1.5;        // standard deviation of the sensor noise, 8-bit units; 0 = none
  double gain = 0.01;        // standard deviation of the cameras' gains; 0 = all cameras alike
  int samples_per_side = 2;  // colour is the mean of this number squared of rays per pixel
};

struct RenderedView {
  RgbImage rgb;
  DepthMap depth;  // z along the view's own axis of what the centre of each pixel shows, exact to float
  ZoneMap zones;   // Zone values at the centre of each pixel
};

// What `camera` sees of the scene in frame `frame` >= 0. Noise and gain are functions of the scene's seed, the camera's
// name, the frame and the pixel: any view can be rendered alone and gives the same bytes. Without noise, pixels that
// show no person are the same in all frames. About a second for 1024 x 768; memory 8 bytes per pixel beside the
// result's.
[[nodiscard]] RenderedView RenderView(const Scene& scene, const Camera& camera, int frame,
                                      const RenderOptions& options);

// Full-range BT.601 at full chroma resolution.
[[nodiscard]] YcbcrImage ToYcbcr(const RgbImage& rgb);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SCENE_RENDER_H_
