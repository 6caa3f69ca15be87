#include "coordinator/service/attempt_records.h"

#include <algorithm>

namespace depthfarm {
namespace {

std::size_t TextBytes(const AttemptRecord& attempt) {
  std::size_t bytes = attempt.error.message().size();
  for (const std::string& line : attempt.log.lines) bytes += line.size();
  return bytes;
}

}  // namespace

bool AttemptRecord::failed() const {
  return outcome == AttemptOutcome::kFailed || outcome == AttemptOutcome::kExpired ||
         outcome == AttemptOutcome::kWorkerLost;
}

void AttemptRecords::Begin(LeaseId lease, AttemptRecord attempt) {
  const JobId job = attempt.task.job;
  running_[lease] = job;
  jobs_[job].attempts[lease] = std::move(attempt);
  ++size_;
}

void AttemptRecords::Report(WorkerId worker, LeaseId lease, const TaskId& task, const TaskStats& stats, TaskLog log) {
  const auto running = running_.find(lease);
  if (running == running_.end() || running->second != task.job) return;
  AttemptRecord& attempt = jobs_.at(task.job).attempts.at(lease);
  if (attempt.worker != worker || attempt.task != task) return;
  attempt.stats = stats;
  attempt.log = std::move(log);
}

TaskStats AttemptRecords::End(const AttemptEnded& end, TimePoint now) {
  const auto running = running_.find(end.lease);
  if (running == running_.end()) return {};
  OfJob& job = jobs_.at(running->second);
  AttemptRecord& attempt = job.attempts.at(end.lease);
  attempt.ended = now;
  attempt.outcome = end.outcome;
  attempt.error = end.error;
  if (!end.last_words.lines.empty()) attempt.log = end.last_words;
  const TaskStats stats = attempt.stats;
  const bool failed = attempt.failed();
  LeaseQueue& queue = failed ? job.failed : job.well;
  queue.push_back(end.lease);
  if (const std::size_t bytes = TextBytes(attempt); bytes > 0) {
    text_bytes_ += bytes;
    with_text_.emplace_back(running->second, end.lease);
  }
  running_.erase(running);
  if (queue.size() > (failed ? bounds_.failed_of_job : bounds_.well_of_job)) ForgetOldest(job, queue);
  ForgetTexts();
  ForgetAttempts();
  // Of those that were forgotten with their attempts not too many are kept in the order.
  if (with_text_.size() > 2 * size_ + 1000) {
    std::erase_if(with_text_,
                  [&](const auto& entry) { return !jobs_.at(entry.first).attempts.contains(entry.second); });
  }
  return stats;
}

void AttemptRecords::ForgetOldest(OfJob& job, LeaseQueue& queue) {
  const auto oldest = job.attempts.find(queue.front());
  text_bytes_ -= TextBytes(oldest->second);
  job.attempts.erase(oldest);
  queue.pop_front();
  ++job.forgotten;
  --size_;
}

void AttemptRecords::ForgetTexts() {
  while (text_bytes_ > bounds_.text_bytes && !with_text_.empty()) {
    const auto [job_id, lease] = with_text_.front();
    with_text_.pop_front();
    const auto job = jobs_.find(job_id);
    if (job == jobs_.end()) continue;
    const auto attempt = job->second.attempts.find(lease);
    if (attempt == job->second.attempts.end()) continue;
    text_bytes_ -= TextBytes(attempt->second);
    attempt->second.log.left_out += attempt->second.log.lines.size();
    attempt->second.log.lines.clear();
    attempt->second.error = Status(attempt->second.error.code(), "");
  }
}

void AttemptRecords::ForgetAttempts() {
  for (auto& [id, job] : jobs_) {
    if (size_ <= bounds_.in_all) return;
    while (size_ > bounds_.in_all && !job.well.empty()) ForgetOldest(job, job.well);
  }
  for (auto& [id, job] : jobs_) {
    while (size_ > bounds_.in_all && !job.failed.empty()) ForgetOldest(job, job.failed);
  }
}

void AttemptRecords::KeepJobs(const std::function<bool(JobId)>& known) {
  std::erase_if(jobs_, [&](const auto& entry) {
    const auto& [id, job] = entry;
    if (known(id)) return false;
    size_ -= job.attempts.size();
    for (const auto& [lease, attempt] : job.attempts) {
      if (attempt.outcome == AttemptOutcome::kRunning) {
        running_.erase(lease);
      } else {
        text_bytes_ -= TextBytes(attempt);
      }
    }
    return true;
  });
  std::erase_if(with_text_, [&](const auto& entry) { return !jobs_.contains(entry.first); });
}

std::optional<LeaseId> AttemptRecords::ForEach(JobId job_id, LeaseId after,
                                               const std::function<bool(const TaskId&)>& wanted,
                                               const Take& take) const {
  const auto job = jobs_.find(job_id);
  if (job == jobs_.end()) return std::nullopt;
  LeaseId last = after;
  const auto& attempts = job->second.attempts;
  for (auto attempt = attempts.upper_bound(after); attempt != attempts.end(); ++attempt) {
    if (wanted(attempt->second.task) && !take(attempt->second)) return last;
    last = attempt->first;
  }
  return std::nullopt;
}

std::uint64_t AttemptRecords::Forgotten(JobId job) const {
  const auto found = jobs_.find(job);
  return found == jobs_.end() ? 0 : found->second.forgotten;
}

}  // namespace depthfarm
