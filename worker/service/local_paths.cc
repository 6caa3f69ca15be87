#include "worker/service/local_paths.h"

#include <utility>

namespace depthfarm {

JobConfig WithLocalPaths(JobConfig config, const PathMap& map) {
  config.output_dir = map.Map(config.output_dir);
  config.sequence_file = map.Map(config.sequence_file);
  if (config.render) config.render->depth_dir = map.Map(config.render->depth_dir);
  return config;
}

TaskSpec WithLocalPaths(TaskSpec spec, const PathMap& map) {
  if (spec.uploads) return spec;  // names of files of another machine
  spec.picture = map.Map(spec.picture);
  spec.guides.mask = map.Map(spec.guides.mask);
  spec.guides.prior = map.Map(spec.guides.prior);
  spec.guides.prior_confidence = map.Map(spec.guides.prior_confidence);
  return spec;
}

}  // namespace depthfarm
