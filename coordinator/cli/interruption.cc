#include "coordinator/cli/interruption.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace depthfarm {
namespace {

volatile std::sig_atomic_t interrupted = 0;
int wake_pipe[2] = {-1, -1};  // readable once interrupted: a signal between the check and the wait is not lost

void NoteInterruption(int) {
  const int saved = errno;
  interrupted = 1;
  [[maybe_unused]] const auto written = ::write(wake_pipe[1], "x", 1);
  errno = saved;
}

}  // namespace

void CatchInterruptions() {
  if (wake_pipe[0] < 0 && ::pipe2(wake_pipe, O_CLOEXEC | O_NONBLOCK) != 0) return;
  struct sigaction action = {};
  action.sa_handler = NoteInterruption;
  ::sigemptyset(&action.sa_mask);
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) ::sigaction(signal_number, &action, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
}

bool Interrupted() { return interrupted != 0; }

void PauseUnlessInterrupted(std::chrono::milliseconds duration) {
  if (Interrupted()) return;
  pollfd event = {.fd = wake_pipe[0], .events = POLLIN, .revents = 0};  // a negative fd is only a timeout
  ::poll(&event, 1, static_cast<int>(duration.count()));
}

}  // namespace depthfarm
