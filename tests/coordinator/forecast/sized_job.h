#ifndef DEPTHFARM_TESTS_COORDINATOR_FORECAST_SIZED_JOB_H_
#define DEPTHFARM_TESTS_COORDINATOR_FORECAST_SIZED_JOB_H_

#include "tests/coordinator/planned_job.h"

namespace depthfarm {

// MakePlannedJob with pictures of 640x480 and 15,360 segments, so that tasks take a time worth predicting.
inline PlannedJob MakeSizedJob(const JobShape& shape) {
  PlannedJob job = MakePlannedJob(shape);
  for (JobView& view : job.config.resolved.views) {
    view.camera.width = view.source_width = 640;
    view.camera.height = view.source_height = 480;
    view.segments = 15360;
  }
  return job;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COORDINATOR_FORECAST_SIZED_JOB_H_
