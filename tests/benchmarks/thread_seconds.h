#ifndef DEPTHFARM_TESTS_BENCHMARKS_THREAD_SECONDS_H_
#define DEPTHFARM_TESTS_BENCHMARKS_THREAD_SECONDS_H_

#include <time.h>  // NOLINT(modernize-deprecated-headers): clock_gettime is POSIX

namespace depthfarm::benchmarks {

// CPU seconds of the calling thread so far.
[[nodiscard]] inline double ThreadSeconds() {
  timespec now = {};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace depthfarm::benchmarks

#endif  // DEPTHFARM_TESTS_BENCHMARKS_THREAD_SECONDS_H_
