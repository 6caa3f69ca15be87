#ifndef DEPTHFARM_COORDINATOR_SERVICE_RESULTS_PAGE_H_
#define DEPTHFARM_COORDINATOR_SERVICE_RESULTS_PAGE_H_

#include <cstdint>
#include <functional>
#include <vector>

#include "common/wire/envelope.h"
#include "coordinator/scheduling/job_results.h"

namespace depthfarm {

// Where an artifact can be fetched now.
using Locate = std::function<std::vector<ArtifactLocation>(const ArtifactKey&)>;

// What is done of a job that keeps its results, from a frame on: as many frames as have some 20,000 files, so that an
// answer stays far below the bound of a message. State, error and job are the caller's.
[[nodiscard]] v1::Results ResultsPage(const JobResults& results, std::uint32_t first_frame, const Locate& locate);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_RESULTS_PAGE_H_
