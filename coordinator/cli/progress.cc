#include "coordinator/cli/progress.h"

#include <unistd.h>

#include <algorithm>
#include <iostream>

#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/interruption.h"

namespace depthfarm {
namespace {

constexpr std::chrono::seconds kPlainLineInterval{5};

}  // namespace

ProgressLine::ProgressLine() : terminal_(::isatty(STDERR_FILENO) != 0) {}

ProgressLine::~ProgressLine() { Finish(); }

void ProgressLine::Finish() {
  if (line_open_) std::cerr << "\n" << std::flush;
  line_open_ = false;
}

void ProgressLine::Show(const std::string& text) {
  const auto now = std::chrono::steady_clock::now();
  if (terminal_) {
    std::cerr << "\r" << text << "\x1b[K" << std::flush;
    line_open_ = true;
  } else if (!shown_at_ || (text != shown_ && now - *shown_at_ >= kPlainLineInterval)) {
    std::cerr << text << "\n" << std::flush;
    shown_ = text;
    shown_at_ = now;
  }
}

Result<v1::JobStatus> FollowJob(Client& client, std::uint64_t job_id, std::chrono::milliseconds interval,
                                const std::function<Status(const v1::JobStatus&)>& each) {
  Result<v1::JobStatus> job = client.GetStatus(job_id);
  while (true) {
    if (!job.ok()) return job.status();
    DEPTHFARM_RETURN_IF_ERROR(each(*job));
    if (job->state() != v1::JOB_STATE_RUNNING) return job;
    const auto asked = std::chrono::steady_clock::now();
    job = client.AwaitStatus(job_id, interval);
    if (Interrupted()) return Cancelled();
    if (!job.ok() || job->state() != v1::JOB_STATE_RUNNING) continue;
    // A coordinator that has many waiting answers at once.
    const auto waited = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - asked);
    if (waited < interval) PauseUnlessInterrupted(interval - waited);
    if (Interrupted()) return Cancelled();
  }
}

int ExitCodeOfJob(const v1::JobStatus& job) {
  if (job.state() == v1::JOB_STATE_DONE) return kExitOk;
  const bool bad_input = job.state() == v1::JOB_STATE_FAILED && job.error().code() == v1::CODE_INVALID_ARGUMENT;
  return bad_input ? kExitBadInput : kExitFailed;
}

}  // namespace depthfarm
