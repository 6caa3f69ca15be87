#include "coordinator/cli/job_on_farm.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <thread>

#include "common/sequence/output_layout.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/progress.h"
#include "coordinator/cli/report.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using SteadyClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kPollInterval{100};
constexpr std::chrono::milliseconds kFollowInterval{250};
constexpr std::chrono::milliseconds kCancelTimeout{2000};
constexpr std::chrono::milliseconds kCleanupLimit{5000};

// Asks the coordinator to cancel and waits until the tasks that tidy up are through.
void CancelAndWait(const CoordinatorTarget& target, std::uint64_t job_id) {
  const Result<std::unique_ptr<Client>> client = Client::Connect(target, {.timeout = kCancelTimeout, .stop = nullptr});
  if (!client.ok() || !client.value()->Cancel(job_id).ok()) return;
  const auto deadline = SteadyClock::now() + kCleanupLimit;
  while (SteadyClock::now() < deadline) {
    const Result<v1::JobStatus> job = client.value()->GetStatus(job_id);
    if (!job.ok() || (job->state() != v1::JOB_STATE_RUNNING && job->running().empty())) return;
    std::this_thread::sleep_for(kPollInterval);
  }
}

}  // namespace

Result<v1::JobStatus> RunOnFarm(const OwnFarm& farm, const JobRequest& request) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::unique_ptr<Client> client,
                             Client::Connect(farm.target, {.stop = [&farm] { return Interrupted() || farm.ended(); }}));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t job_id, client->Submit({.sequence = request.sequence,
                                                                         .params = request.params,
                                                                         .output_dir = request.output_dir,
                                                                         .name = request.sequence.name}));
  ProgressLine progress;
  Result<v1::JobStatus> last = FollowJob(*client, job_id, kFollowInterval, [&](const v1::JobStatus& job) {
    progress.Show(FormatProgress(job));
    return job.state() == v1::JOB_STATE_RUNNING ? farm.look_after() : Status();
  });
  progress.Finish();
  if (!last.ok()) CancelAndWait(farm.target, job_id);
  return last;
}

void RemoveStaging(const std::string& output_dir) {
  std::error_code ignored;
  fs::remove_all(fs::path(output_dir) / kStagingFolder, ignored);
}

}  // namespace depthfarm
