#ifndef DEPTHFARM_COORDINATOR_CLI_PROGRESS_H_
#define DEPTHFARM_COORDINATOR_CLI_PROGRESS_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "common/base/status.h"
#include "coordinator/client/client.h"

namespace depthfarm {

// Progress on stderr: on a terminal one line that is rewritten, else a line when it changed, every few seconds.
class ProgressLine {
 public:
  ProgressLine();
  ~ProgressLine();  // leaves the terminal on a new line
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void Show(const std::string& text);
  // Ends the rewritten line, so that other output starts on its own.
  void Finish();

 private:
  bool terminal_;
  bool line_open_ = false;
  std::string shown_;
  std::optional<std::chrono::steady_clock::time_point> shown_at_;
};

// Asks for the status of a job, once in each `interval`, until it has ended, and returns the last one as soon as it
// has. `each` sees every status; its failure ends the watch. kCancelled when interrupted.
[[nodiscard]] Result<v1::JobStatus> FollowJob(Client& client, std::uint64_t job_id, std::chrono::milliseconds interval,
                                              const std::function<Status(const v1::JobStatus&)>& each);

// The exit code that tells how a job ended: 0 done, 2 failed for its input, 1 failed or cancelled otherwise.
[[nodiscard]] int ExitCodeOfJob(const v1::JobStatus& job);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_PROGRESS_H_
