#include "worker/service/compute_pool.h"

#include <algorithm>
#include <utility>

namespace depthfarm {

ComputePool::ComputePool(int slots, Execute execute, Fetch fetch, std::function<void()> on_done)
    : execute_(std::move(execute)), fetch_(std::move(fetch)), on_done_(std::move(on_done)), idle_slots_(slots) {
  for (int slot = 0; slot < slots; ++slot) threads_.emplace_back([this, slot] { Compute(slot); });
  threads_.emplace_back([this] { FetchInputs(); });
}

ComputePool::~ComputePool() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
    for (Entry& entry : entries_) entry.stop.request_stop();
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ComputePool::Start(LeasedTask task) {
  {
    const std::scoped_lock lock(mutex_);
    entries_.push_back({std::move(task), {}, {}, Stage::kWaiting, {}});
  }
  changed_.notify_all();
}

void ComputePool::Stop(LeaseId lease) {
  bool ended = false;
  {
    const std::scoped_lock lock(mutex_);
    const auto entry = Find(lease);
    if (entry == entries_.end()) return;
    ended = StopEntry(entry);
  }
  if (ended) on_done_();
}

bool ComputePool::GiveBack(LeaseId lease) {
  bool ended = false;
  {
    const std::scoped_lock lock(mutex_);
    const auto entry = Find(lease);
    if (entry == entries_.end() || entry->stage == Stage::kComputing) return false;
    ended = StopEntry(entry);
  }
  if (ended) on_done_();
  return true;
}

ComputePool::Entries::iterator ComputePool::Find(LeaseId lease) {
  return std::ranges::find(entries_, lease, [](const Entry& each) { return each.task.lease; });
}

bool ComputePool::StopEntry(Entries::iterator entry) {
  entry->stop.request_stop();
  // Nobody has it in hand: it need not wait for a slot to end.
  if (entry->stage != Stage::kWaiting && entry->stage != Stage::kFetched) return false;
  EndStopped(entry);
  return true;
}

std::optional<LeasedOutcome> ComputePool::TakeOutcome() {
  const std::scoped_lock lock(mutex_);
  if (outcomes_.empty()) return std::nullopt;
  LeasedOutcome outcome = std::move(outcomes_.front());
  outcomes_.pop_front();
  return outcome;
}

bool ComputePool::busy() const {
  const std::scoped_lock lock(mutex_);
  return !entries_.empty() || !outcomes_.empty();
}

ComputePool::Entries::iterator ComputePool::NextToCompute() {
  // In the order of their leases, by which the coordinator tells those that may have killed a worker.
  const auto next = std::ranges::find_if(entries_, [](const Entry& each) { return each.stage != Stage::kComputing; });
  if (next == entries_.end() || next->stage != Stage::kFetching) return next;
  next->enough.request_stop();
  return entries_.end();
}

ComputePool::Entries::iterator ComputePool::NextToFetch() {
  if (idle_slots_ > 0) return entries_.end();  // a slot takes it at once and fetches for itself
  return std::ranges::find(entries_, Stage::kWaiting, &Entry::stage);
}

void ComputePool::End(Entries::iterator entry, TaskOutcome outcome) {
  outcome.stats.fetched_bytes += entry->fetched.bytes;
  outcomes_.push_back({entry->task.lease, entry->task.spec.id, std::move(outcome)});
  entries_.erase(entry);
}

void ComputePool::EndStopped(Entries::iterator entry) {
  TaskOutcome outcome;
  outcome.status = Cancelled();
  End(entry, std::move(outcome));
}

void ComputePool::Compute(int slot) {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || NextToCompute() != entries_.end(); });
    if (ending_) return;
    const auto entry = NextToCompute();
    entry->stage = Stage::kComputing;
    --idle_slots_;
    lock.unlock();
    changed_.notify_all();  // without an idle slot, inputs are fetched ahead
    TaskOutcome outcome;
    if (entry->task.term->over()) {
      outcome.status = {ErrorCode::kLeaseExpired, "the lease ran out before the task was begun"};
    } else {
      outcome = execute_(slot, entry->task, entry->stop.get_token());
    }
    lock.lock();
    ++idle_slots_;
    End(entry, std::move(outcome));
    lock.unlock();
    on_done_();
    lock.lock();
  }
}

void ComputePool::FetchInputs() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || NextToFetch() != entries_.end(); });
    if (ending_) return;
    const auto entry = NextToFetch();
    entry->stage = Stage::kFetching;
    lock.unlock();
    FetchedAhead fetched = fetch_(entry->task.spec, entry->stop.get_token(), entry->enough.get_token());
    lock.lock();
    entry->fetched = std::move(fetched);
    entry->stage = Stage::kFetched;
    if (!entry->stop.stop_requested()) {
      changed_.notify_all();
      continue;
    }
    EndStopped(entry);
    lock.unlock();
    changed_.notify_all();  // a slot may have waited for it, and can have the one behind it
    on_done_();
    lock.lock();
  }
}

}  // namespace depthfarm
