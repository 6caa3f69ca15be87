#ifndef DEPTHFARM_TESTS_COORDINATOR_PLANNED_JOB_H_
#define DEPTHFARM_TESTS_COORDINATOR_PLANNED_JOB_H_

#include <string>

#include "coordinator/planning/job_plan.h"

namespace depthfarm {

struct JobShape {
  std::uint64_t id = 1;
  int frames = 4;
  int gop = 2;
  int views = 2;
  int blocks_i = 2;
  int blocks_p = 1;
  int refine = 0;
  bool confidence = false;
  Anchor anchor = Anchor::kGop;
  bool keeps_results = false;
};

// `count` views of a camera as small as can be.
inline std::vector<VirtualPicture> MakeViews(int count) {
  std::vector<VirtualPicture> views;
  for (int i = 0; i < count; ++i) {
    VirtualPicture view;
    view.frame = i;
    view.sources = {"cam0", "cam1"};
    view.number = i;
    view.camera.name = "virtual";
    view.camera.width = view.camera.height = 16;
    view.camera.intrinsics << 20, 0, 7.5, 0, 20, 7.5, 0, 0, 1;
    views.push_back(view);
  }
  return views;
}

// A job that renders `count` views.
inline PlannedJob MakeRenderingJob(std::uint64_t id, int count) {
  PlannedJob job;
  job.config.job = JobId(id);
  job.config.output_dir = "/out/" + std::to_string(id);
  job.config.sequence_file = "/in/sequence.json";
  job.config.render = RenderSource{"/depth", {}};
  job.views = MakeViews(count);
  job.config.resolved = PartsOnly(NumParts(job.views.size()));
  return job;
}

// A job of the wanted shape whose cameras and numbers are as small as can be.
inline PlannedJob MakePlannedJob(const JobShape& shape) {
  PlannedJob job;
  job.config.job = JobId(shape.id);
  job.config.keeps_results = shape.keeps_results;
  if (!shape.keeps_results) job.config.output_dir = "/out/" + std::to_string(shape.id);
  ResolvedJob& resolved = job.config.resolved;
  resolved.params.gop = shape.gop;
  resolved.params.anchor = shape.anchor;
  resolved.params.levels = 16;
  resolved.params.z_near = 1;
  resolved.params.z_far = 2;
  resolved.params.refine_rounds = shape.refine;
  resolved.params.confidence = shape.confidence;
  resolved.params.end_frame = shape.frames;
  resolved.num_frames = shape.frames;
  resolved.level_blocks_i = shape.blocks_i;
  resolved.level_blocks_p = shape.blocks_p;
  for (int view = 0; view < shape.views; ++view) {
    JobView job_view;
    job_view.camera.name = "cam" + std::to_string(view);
    job_view.camera.width = job_view.camera.height = 16;
    job_view.neighbours = {(view + 1) % shape.views};
    job_view.compared = job_view.neighbours;
    resolved.views.push_back(job_view);
    job.pictures.emplace_back();
    for (int frame = 0; frame < shape.frames; ++frame) {
      job.pictures.back().push_back("/in/cam" + std::to_string(view) + "/" + std::to_string(frame) + ".png");
    }
  }
  resolved.reference = resolved.views[0].camera;
  return job;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_COORDINATOR_PLANNED_JOB_H_
