#ifndef DEPTHFARM_COMMON_SCENE_TEXTURE_H_
#define DEPTHFARM_COMMON_SCENE_TEXTURE_H_

#include <Eigen/Core>
#include <cstdint>

namespace depthfarm {

// Red, green, blue as displayed (no gamma is modelled), 0 to 255.
using Rgb = Eigen::Vector3d;

// How a surface is painted. All of it is fixed to the surface; nothing depends on the view but the finest detail, which
// fades where a pixel is too large to hold it.
struct Material {
  enum class Pattern {
    kPlain,    // `base` alone: nothing to match
    kNoise,    // noise around `base`, tinted towards `accent` in patches
    kBricks,   // rows of bricks with tones between `base` and `accent`, joints in `line`
    kPlanks,   // long boards with tones between `base` and `accent`, gaps in `line`
    kStripes,  // soft stripes of `base` and `accent` down the surface
    kChecks,   // crossing bands of `base` and `accent` with thin lines in `line`
  };
  Pattern pattern = Pattern::kNoise;
  Rgb base = Rgb::Constant(128);
  Rgb accent = Rgb::Constant(128);
  Rgb line = Rgb::Constant(64);
  double cell_m = 0.2;      // brick height, board width, period of stripes and checks
  double contrast = 0.2;    // standard deviation of the noise over the brightness, about
  double coarsest_m = 0.3;  // lattice of the first noise octave; each further one is half as wide
  std::uint64_t seed = 0;
};

// Band-limited noise of mean 0 and about unit deviation at a point in metres: octaves of value noise from `coarsest_m`
// down, each twice as fine; those whose lattice is finer than two pixels fade and those finer than one are left out, so
// that it does not alias. `footprint_m` > 0 is the width of a pixel (or colour sample) on the surface.
[[nodiscard]] double OctaveNoise(const Eigen::Vector3d& point, double coarsest_m, double footprint_m,
                                 std::uint64_t seed);

// Colour of a surface before lighting. `point` in the shape's frame, `on_surface` as SurfaceCoordinates() gives it,
// metres.
[[nodiscard]] Rgb MaterialColour(const Material& material, const Eigen::Vector3d& point,
                                 const Eigen::Vector2d& on_surface, double footprint_m);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SCENE_TEXTURE_H_
