#ifndef DEPTHFARM_TESTS_COORDINATOR_SERVICE_SMALL_SEQUENCE_H_
#define DEPTHFARM_TESTS_COORDINATOR_SERVICE_SMALL_SEQUENCE_H_

#include <string>

#include "common/sequence/sequence.h"

namespace depthfarm {

// Cameras side by side, 64 x 48; the pictures need not exist for planning.
inline Sequence SmallSequence(int views, int frames) {
  Sequence sequence;
  sequence.name = "line";
  sequence.z_near = 2;
  sequence.z_far = 8;
  for (int view = 0; view < views; ++view) {
    SequenceCamera camera;
    camera.camera.name = "cam" + std::to_string(view);
    camera.camera.width = 64;
    camera.camera.height = 48;
    camera.camera.intrinsics << 60, 0, 31.5, 0, 60, 23.5, 0, 0, 1;
    camera.camera.cam_from_world_translation << -0.2 * view, 0, 0;
    for (int frame = 0; frame < frames; ++frame) {
      camera.images.push_back("/in/cam" + std::to_string(view) + "/" + std::to_string(frame) + ".png");
    }
    sequence.cameras.push_back(camera);
  }
  return sequence;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COORDINATOR_SERVICE_SMALL_SEQUENCE_H_
