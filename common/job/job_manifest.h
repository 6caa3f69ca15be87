#ifndef DEPTHFARM_COMMON_JOB_JOB_MANIFEST_H_
#define DEPTHFARM_COMMON_JOB_JOB_MANIFEST_H_

#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "common/sequence/depth_manifest.h"

namespace depthfarm {

// "depth/<camera>/<number>.<extension of the job's format>"; `in_sequence`: the frame's position in the sequence.
[[nodiscard]] std::string DepthFileOf(const ResolvedJob& job, const JobView& view, int in_sequence);

// The files of a frame of a job that estimates depth, relative to its output folder: the depth of each view, then the
// confidence of each where it is asked for. Numbers are the frame's position in the sequence, of four digits or more.
[[nodiscard]] std::vector<std::string> FilesOfFrame(const ResolvedJob& job, int frame);

// depth.json of a job from its depth files and the digests of its pictures, both by frame, then view. A function of the
// job alone: nothing of when, where and by how many workers it was run. kInvalidArgument when the lists are not frames
// x views long or a file is not in its camera's folder.
[[nodiscard]] Result<DepthManifest> ManifestOf(const JobConfig& config, const std::vector<OutputFile>& files,
                                               const std::vector<ContentDigest>& picture_digests);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_JOB_JOB_MANIFEST_H_
