#ifndef DEPTHFARM_COMMON_BASE_PARALLEL_H_
#define DEPTHFARM_COMMON_BASE_PARALLEL_H_

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace depthfarm {

// Calls function(i) for each i in [0, count), on up to `threads` threads, this one among them; returns when all have
// ended. The calls must not depend on each other. The first exception is thrown here, after the others have ended;
// calls that have not begun by then are left out.
template <typename Function>
void ParallelFor(std::size_t count, int threads, const Function& function) {
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
  {
    std::vector<std::jthread> helpers;
    const std::size_t most = std::min(count, static_cast<std::size_t>(std::max(threads, 1)));
    for (std::size_t i = 1; i < most; ++i) helpers.emplace_back(work);
    work();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_PARALLEL_H_
