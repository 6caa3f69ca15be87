#ifndef DEPTHFARM_COMMON_BASE_PARALLEL_H_
#define DEPTHFARM_COMMON_BASE_PARALLEL_H_

#include <time.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "common/base/thread_budget.h"

namespace depthfarm {

namespace parallel_internal {
inline thread_local double seconds_of_helpers = 0;

inline double CpuSecondsOfThread() {
  timespec time{};
  if (clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time) != 0) return 0;
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}
}  // namespace parallel_internal

// CPU seconds that other threads have spent so far in the loops below that this thread began; its own are not among
// them.
inline double SecondsOfHelpers() { return parallel_internal::seconds_of_helpers; }

// Calls function(i) for each i in [0, count), on up to `threads` threads, this one among them and of the others as many
// as a ThreadBudget leaves it; returns when all have ended. The calls must not depend on each other; which thread makes
// which is open. The first exception is thrown here, after the others have ended; calls that have not begun by then are
// left out. On one thread it is a plain loop. Where the system has no thread left it makes do with those it got.
template <typename Function>
void ParallelFor(std::size_t count, int threads, const Function& function) {
  const std::size_t most = std::min(std::max<std::size_t>(count, 1), static_cast<std::size_t>(std::max(threads, 1)));
  const ThreadBudget::Helpers budget(static_cast<int>(most) - 1);
  if (budget.count() == 0) {
    for (std::size_t i = 0; i < count; ++i) function(i);
    return;
  }
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        function(i);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        if (!failure) failure = std::current_exception();
        next = count;
      }
    }
  };
  double seconds = 0;
  const auto help = [&] {
    budget.Enter();
    work();
    const std::scoped_lock lock(mutex);
    seconds += parallel_internal::CpuSecondsOfThread() + SecondsOfHelpers();
  };
  {
    std::vector<std::jthread> helpers;
    helpers.reserve(static_cast<std::size_t>(budget.count()));
    try {
      for (int i = 0; i < budget.count(); ++i) helpers.emplace_back(help);
    } catch (const std::system_error&) {  // the work is done all the same
    }
    work();
  }
  parallel_internal::seconds_of_helpers += seconds;
  if (failure) std::rethrow_exception(failure);
}

// Calls function(begin, end) for pieces of [0, count), each of `piece` but for the last; else as ParallelFor.
template <typename Function>
void ParallelForPieces(std::size_t count, std::size_t piece, int threads, const Function& function) {
  ParallelFor((count + piece - 1) / piece, threads,
              [&](std::size_t i) { function(i * piece, std::min(count, (i + 1) * piece)); });
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_PARALLEL_H_
