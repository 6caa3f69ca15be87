#include "worker/service/compute_thread.h"

#include <utility>

namespace depthfarm {

ComputeThread::ComputeThread(Execute execute, std::function<void()> on_done)
    : execute_(std::move(execute)), on_done_(std::move(on_done)), thread_([this] { Run(); }) {}

ComputeThread::~ComputeThread() {
  {
    const std::scoped_lock lock(mutex_);
    ending_ = true;
    stop_.request_stop();
  }
  changed_.notify_one();
  thread_.join();
}

void ComputeThread::Start(LeasedTask task) {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = std::stop_source();
    busy_ = true;
    task_ = std::move(task);
  }
  changed_.notify_one();
}

void ComputeThread::Stop() {
  const std::scoped_lock lock(mutex_);
  stop_.request_stop();
}

std::optional<LeasedOutcome> ComputeThread::TakeOutcome() {
  const std::scoped_lock lock(mutex_);
  if (outcome_.has_value()) busy_ = false;
  return std::exchange(outcome_, std::nullopt);
}

bool ComputeThread::busy() const {
  const std::scoped_lock lock(mutex_);
  return busy_;
}

void ComputeThread::Run() {
  while (true) {
    LeasedTask task;
    std::stop_token stop;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return ending_ || task_.has_value(); });
      if (ending_) return;
      task = *std::exchange(task_, std::nullopt);
      stop = stop_.get_token();
    }
    TaskOutcome outcome = execute_(task.spec, *task.config, stop);
    {
      const std::scoped_lock lock(mutex_);
      outcome_ = LeasedOutcome{task.lease, task.spec.id, std::move(outcome)};
    }
    on_done_();
  }
}

}  // namespace depthfarm
