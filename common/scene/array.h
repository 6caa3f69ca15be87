#ifndef DEPTHFARM_COMMON_SCENE_ARRAY_H_
#define DEPTHFARM_COMMON_SCENE_ARRAY_H_

#include <cstdint>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"

namespace depthfarm {

// How the cameras of a rendered sequence stand.
enum class ArrayKind {
  kArc,        // on a circle, all looking at its centre, as in free-viewpoint television; ordered left to right
  kLine,       // parallel, on a line along their x axis; ordered left to right
  kGrid,       // parallel, about as many rows as columns; row by row
  kIrregular,  // jittered in position, direction, roll and focal length; in no order
  kMixed,      // kIrregular with pictures of different sizes
};

// "arc", "line", "grid", "irregular" or "mixed"; kInvalidArgument lists them.
[[nodiscard]] Result<ArrayKind> ParseArrayKind(std::string_view name);

// `cameras` >= 1 cameras called cam0, cam1, ... with pictures of `width` x `height` pixels (kMixed: at most that, at
// least 16 a side), looking into the room of MakeScene() from around the world's origin. Unit of length: metre. All
// pictures show about the same part of the scene whatever their aspect ratio. Neighbours of an arc are 3.5 degrees
// apart and those of a line or grid 0.25 m, which is a disparity range of about 50 pixels at 1024 x 768; large arrays
// stay within 56 degrees (1.9 m) and so stand closer. `seed` decides the jitter of the irregular kinds and changes
// nothing else.
[[nodiscard]] std::vector<Camera> MakeArray(ArrayKind kind, int cameras, int width, int height, std::uint64_t seed);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SCENE_ARRAY_H_
