#include "worker/minding/minded_end.h"

#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace depthfarm {
namespace {

constexpr int kExitOfSignal = 128;  // as shells say it

}  // namespace

std::string Describe(const MindedEnd& end) {
  if (end.signal == 0) return "exited with code " + std::to_string(end.exit_code);
  const char* name = sigdescr_np(end.signal);
  return "was killed by signal " + std::to_string(end.signal) + (name == nullptr ? "" : " (" + std::string(name) + ")");
}

void EndLike(const MindedEnd& end) {
  if (end.signal == 0) std::exit(end.exit_code);  // NOLINT(concurrency-mt-unsafe): the only thread
  const rlimit none{0, 0};
  (void)::setrlimit(RLIMIT_CORE, &none);
  (void)::signal(end.signal, SIG_DFL);
  (void)::raise(end.signal);
  // The first process of a container is not killed by its own signals.
  ::_exit(kExitOfSignal + end.signal);
}

}  // namespace depthfarm
