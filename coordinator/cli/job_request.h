#ifndef DEPTHFARM_COORDINATOR_CLI_JOB_REQUEST_H_
#define DEPTHFARM_COORDINATOR_CLI_JOB_REQUEST_H_

#include <string>

#include "common/base/status.h"
#include "common/job/resolved_job.h"
#include "common/sequence/sequence.h"
#include "coordinator/cli/arguments.h"

namespace depthfarm {

// A job that was looked at as far as its submitter can: it will not fail for a wrong option or a missing file.
struct JobRequest {
  Sequence sequence;
  EstimationParams params;  // as asked, autos still open: the coordinator resolves them again
  ResolvedJob resolved;
  std::string output_dir;  // absolute
};

// Reads sequence and parameters, resolves the job and looks at every picture and mask of its frames; the output folder
// is left out. Errors (kInvalidArgument): whatever is wrong with any of them, naming option, or file, camera and frame.
[[nodiscard]] Result<JobRequest> ReadJobRequest(const JobArguments& arguments);

// The same, and looks at the output folder.
[[nodiscard]] Result<JobRequest> PrepareJobRequest(const JobArguments& arguments);

// That every picture and mask of the job's views and frames is a regular file that can be read and is not empty.
// kInvalidArgument names file, camera and frame.
[[nodiscard]] Status CheckPictures(const Sequence& sequence, const ResolvedJob& job);

// That depth may be written below `output_dir`: it is not there yet, or a folder that holds no depth but ours.
[[nodiscard]] Status CheckOutputFolder(const std::string& output_dir);

// One line: "5 views 1024x768, 196,608 segments, 250 levels, n = 2 interleaved, frames 0 to 49".
[[nodiscard]] std::string DescribeJob(const ResolvedJob& job);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_JOB_REQUEST_H_
