#ifndef DEPTHFARM_TESTS_COMMON_JOB_LINE_SEQUENCE_H_
#define DEPTHFARM_TESTS_COMMON_JOB_LINE_SEQUENCE_H_

#include <string>
#include <vector>

#include "common/job/resolved_job.h"
#include "common/sequence/sequence.h"
#include "tests/support/plane_scene.h"

namespace depthfarm {

inline constexpr double kFocal_px = 297.5;
inline constexpr double kNear = 2;
inline constexpr double kFar = 10;

// Pixels that a point travels between zFar and zNear in parallel views `baseline` apart.
inline double DisparityOf(double baseline) { return kFocal_px * baseline * (1 / kNear - 1 / kFar); }

inline SequenceCamera CameraWithPictures(const Camera& camera, int frames) {
  SequenceCamera result;
  result.camera = camera;
  for (int frame = 0; frame < frames; ++frame) {
    result.images.push_back("/pictures/" + camera.name + "/" + std::to_string(frame) + ".png");
  }
  return result;
}

// Parallel cameras cam0, cam1, ... of 320 x 240 pixels at world x = xs[0], xs[1], ..., which look along +z.
inline Sequence LineSequence(const std::vector<double>& xs, int frames = 5) {
  Sequence sequence;
  sequence.name = "line";
  sequence.z_near = kNear;
  sequence.z_far = kFar;
  for (const double x : xs) {
    const std::string name = "cam" + std::to_string(sequence.cameras.size());
    sequence.cameras.push_back(CameraWithPictures(ForwardCamera(name, x, 0, 320, 240, kFocal_px), frames));
  }
  return sequence;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COMMON_JOB_LINE_SEQUENCE_H_
