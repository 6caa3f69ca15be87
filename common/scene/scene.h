#ifndef DEPTHFARM_COMMON_SCENE_SCENE_H_
#define DEPTHFARM_COMMON_SCENE_SCENE_H_

#include <cstdint>
#include <span>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"
#include "common/geometry/depth_levels.h"
#include "common/scene/person.h"
#include "common/scene/shape.h"
#include "common/scene/texture.h"

namespace depthfarm {

// A small studio whose depth is known everywhere: a brick wall with a plain panel, a boarded floor, a slanted side
// wall, crates, round things, a lamp with a boom, a railing, a person who walks and one who stands and waves. World
// frame: x right, y down, z forward, metres; cameras around the origin, the floor 1.35 below, the back wall 7 in front.
struct Scene {
  std::uint64_t seed = 0;
  std::vector<Material> materials;
  std::vector<Shape> still;  // the room and all that never moves
  std::vector<Person> persons;
};

// The scene of a seed: the layout is always the one above, its places, sizes, colours and textures differ.
[[nodiscard]] Scene MakeScene(std::uint64_t seed);

// Everything in the scene at frame `frame` >= 0.
[[nodiscard]] std::vector<Shape> ShapesAt(const Scene& scene, int frame);

// zNear and zFar of a sequence: the depths, in the camera `reference`, between which everything lies that `cameras` see
// in frames 0 to frames - 1, with a margin of 2 %. Room surfaces are sampled over each picture, objects bounded
// exactly. kInvalidArgument if something visible lies behind the reference camera: its depth planes cannot hold the
// scene.
[[nodiscard]] Result<DepthRange> SceneDepthRange(const Scene& scene, std::span<const Camera> cameras,
                                                 const Camera& reference, int frames);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SCENE_SCENE_H_
