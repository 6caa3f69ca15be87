#ifndef DEPTHFARM_TESTS_SIMULATION_TASK_MODEL_H_
#define DEPTHFARM_TESTS_SIMULATION_TASK_MODEL_H_

#include <string>
#include <vector>

#include "common/job/task_spec.h"

namespace depthfarm::simulation {

// What a task makes, without making it: every result is a digest of what was read, so that whoever reads the wrong
// thing makes something else. Equal tasks make equal results.

// The name that Analyse finds for its result: of the picture and of what it refers to.
[[nodiscard]] ArtifactKey AnalysisKeyOf(const TaskSpec& spec);
[[nodiscard]] ContentDigest PictureDigestOf(const TaskSpec& spec);

// The artifact of a task of a kind that makes one.
[[nodiscard]] ArtifactInfo ArtifactOf(const TaskSpec& spec, const ArtifactKey& key);

// A file that Emit or Render writes.
struct MadeFile {
  std::string path;
  std::string bytes;
};
[[nodiscard]] std::vector<MadeFile> FilesOf(const TaskSpec& spec, const JobConfig& config);
[[nodiscard]] std::vector<OutputFile> Describe(const std::vector<MadeFile>& files);

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_TASK_MODEL_H_
