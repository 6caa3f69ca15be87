#ifndef DEPTHFARM_COMMON_SYNTHESIS_SAMPLE_SURFACE_H_
#define DEPTHFARM_COMMON_SYNTHESIS_SAMPLE_SURFACE_H_

#include "common/image/colour.h"
#include "common/synthesis/surface.h"

namespace depthfarm {

// A colour between pixels.
struct SampledColour {
  Colour colour = {};
  bool clean = true;  // false: a background sample beside a foreground edge, which may hold its colour
};

// Colour of the surface point that projects to pixel (x, y) of the source picture with `inverse_depth` = 1/z along the
// source's axis. Cubic (Catmull-Rom) inside one surface; near tears bilinear over those of the four pixels that lie on
// the same surface, so that no colour leaks across a depth jump. (x, y) is clamped to the picture.
[[nodiscard]] SampledColour SampleSurface(const YcbcrImage& picture, const Surface& surface, float x, float y,
                                          float inverse_depth);

// Bilinear, at (x, y) clamped to the picture.
[[nodiscard]] Colour SampleBilinear(const YcbcrImage& picture, double x, double y);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SYNTHESIS_SAMPLE_SURFACE_H_
