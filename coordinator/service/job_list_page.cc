#include "coordinator/service/job_list_page.h"

#include <algorithm>
#include <utility>

namespace depthfarm {
namespace {

constexpr std::uint32_t kMostJobs = 1000;
constexpr std::size_t kMostBytes = std::size_t{4} << 20;

}  // namespace

JobListPage::JobListPage(const v1::ListJobs& request) : after_(request.after()) {
  if (request.max_jobs() == 0) return;
  max_jobs_ = std::min(request.max_jobs(), kMostJobs);
  max_bytes_ = kMostBytes;
}

bool JobListPage::Add(v1::JobStatus job) {
  const std::size_t bytes = job.ByteSizeLong();
  const bool fits = static_cast<std::size_t>(list_.jobs_size()) < max_jobs_ && bytes <= max_bytes_ - bytes_;
  // Whatever its size, one job makes a page: else nobody would come past it.
  if (!fits && !list_.jobs().empty()) {
    list_.set_next(list_.jobs().rbegin()->job_id());
    return false;
  }
  bytes_ = std::min(bytes_ + bytes, max_bytes_);
  *list_.add_jobs() = std::move(job);
  return true;
}

}  // namespace depthfarm
