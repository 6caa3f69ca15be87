#ifndef DEPTHFARM_TESTS_COORDINATOR_FORECAST_SIZED_JOB_H_
#define DEPTHFARM_TESTS_COORDINATOR_FORECAST_SIZED_JOB_H_

#include "tests/coordinator/planned_job.h"

namespace depthfarm {

// MakePlannedJob with pictures of 640x480 and 15,360 segments, so that tasks take a time worth predicting. Points
// travel 50 pixels from a camera to the next, so that all levels are tried.
inline PlannedJob MakeSizedJob(const JobShape& shape) {
  PlannedJob job = MakePlannedJob(shape);
  ResolvedJob& resolved = job.config.resolved;
  for (JobView& view : resolved.views) {
    view.camera.intrinsics << 1000, 0, 319.5, 0, 1000, 239.5, 0, 0, 1;
    view.camera.cam_from_world_translation.x() = -0.1 * static_cast<double>(&view - resolved.views.data());
    view.camera.width = view.source_width = 640;
    view.camera.height = view.source_height = 480;
    view.segments = 15360;
  }
  resolved.reference = resolved.views.front().camera;
  return job;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COORDINATOR_FORECAST_SIZED_JOB_H_
