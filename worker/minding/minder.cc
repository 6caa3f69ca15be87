#include "worker/minding/minder.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "common/log/log_collector.h"

namespace depthfarm {
namespace {

constexpr int kParentCheckMs = 500;

Status Failure(const std::string& what) {
  return Unavailable("cannot " + what + " for the worker's process: " + std::generic_category().message(errno));
}

// A descriptor that is closed with it.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { Close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  void Close() {
    if (number_ >= 0) (void)::close(number_);
    number_ = -1;
  }
  [[nodiscard]] int number() const { return number_; }

 private:
  int number_;
};

// Signals that this thread reads instead of getting, as long as it lives.
class HeldSignals {
 public:
  explicit HeldSignals(bool hangup) {
    sigemptyset(&held_);
    for (const int signal : {SIGTERM, SIGINT, SIGCHLD}) sigaddset(&held_, signal);
    if (hangup) sigaddset(&held_, SIGHUP);
    (void)::pthread_sigmask(SIG_BLOCK, &held_, &before_);
  }
  ~HeldSignals() { Release(); }
  HeldSignals(const HeldSignals&) = delete;
  HeldSignals& operator=(const HeldSignals&) = delete;
  void Release() const { (void)::pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  [[nodiscard]] const sigset_t& set() const { return held_; }

 private:
  sigset_t held_{};
  sigset_t before_{};
};

void WriteToStandardError(std::string_view text) {
  while (!text.empty()) {
    const ssize_t wrote = ::write(STDERR_FILENO, text.data(), text.size());
    if (wrote < 0 && errno != EINTR) return;  // nobody reads it: as without a minder
    if (wrote > 0) text.remove_prefix(static_cast<std::size_t>(wrote));
  }
}

// What the parent process does until the child has ended.
class Minder {
 public:
  Minder(pid_t child, int from_child, int signals, bool end_with_parent, pid_t parent)
      : child_(child), from_child_(from_child), signals_(signals), end_with_parent_(end_with_parent), parent_(parent) {}

  MindedEnd WaitForTheEnd() {
    for (;;) {
      std::array<pollfd, 2> watched{pollfd{.fd = from_child_, .events = POLLIN, .revents = 0},
                                    pollfd{.fd = signals_, .events = POLLIN, .revents = 0}};
      (void)::poll(watched.data(), watched.size(), end_with_parent_ ? kParentCheckMs : -1);
      PassOnText();
      PassOnSignals();
      if (end_with_parent_ && ::getppid() != parent_) {
        end_with_parent_ = false;
        (void)::kill(child_, MindedStop());
      }
      int status = 0;
      if (::waitpid(child_, &status, WNOHANG) != child_) continue;
      PassOnText();  // what it wrote last
      MindedEnd end;
      if (WIFSIGNALED(status)) {
        end.signal = WTERMSIG(status);
      } else {
        end.exit_code = WEXITSTATUS(status);
      }
      end.last_words.lines = tail_.TakeLines();
      end.last_words.left_out = tail_.left_out();
      return end;
    }
  }

 private:
  void PassOnText() {
    std::array<char, 4096> buffer{};
    while (from_child_ >= 0) {
      const ssize_t bytes = ::read(from_child_, buffer.data(), buffer.size());
      if (bytes < 0 && errno == EINTR) continue;
      if (bytes < 0) return;
      if (bytes == 0) from_child_ = -1;  // it closed its stderr
      const std::string_view text(buffer.data(), static_cast<std::size_t>(bytes));
      WriteToStandardError(text);
      tail_.AddText(text);
    }
  }

  void PassOnSignals() const {
    signalfd_siginfo signal{};
    while (::read(signals_, &signal, sizeof signal) == sizeof signal) {
      const auto number = static_cast<int>(signal.ssi_signo);
      if (number == SIGTERM || number == SIGINT) (void)::kill(child_, MindedStop());
      if (number == SIGHUP) (void)::kill(child_, MindedHangup());
    }
  }

  const pid_t child_;
  int from_child_;
  const int signals_;
  bool end_with_parent_;
  const pid_t parent_;
  LogCollector tail_{LogCollector::Bounds{}};
};

}  // namespace

Result<MindedEnd> RunMinded(const MindOptions& options, const std::function<int()>& work) {
  const pid_t parent = ::getppid();
  const pid_t minder = ::getpid();
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return Failure("make a pipe");
  Descriptor from_child(ends[0]);
  Descriptor to_minder(ends[1]);
  (void)::fcntl(from_child.number(), F_SETFL, O_NONBLOCK);  // of this end alone
  // Ignored, as it may be inherited, it would take the child's end with it.
  (void)::signal(SIGCHLD, SIG_DFL);
  const HeldSignals held(options.hangup);
  Descriptor signals(::signalfd(-1, &held.set(), SFD_CLOEXEC | SFD_NONBLOCK));
  if (signals.number() < 0) return Failure("watch signals");

  const pid_t child = ::fork();
  if (child < 0) return Failure("start another process");
  if (child == 0) {
    // The minder may have been killed before.
    if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() != minder) ::_exit(EXIT_FAILURE);
    (void)::dup2(to_minder.number(), STDERR_FILENO);
    to_minder.Close();
    from_child.Close();
    signals.Close();
    for (const int signal : {SIGTERM, SIGINT}) (void)::signal(signal, SIG_IGN);
    if (options.hangup) (void)::signal(SIGHUP, SIG_IGN);
    held.Release();
    std::exit(work());  // NOLINT(concurrency-mt-unsafe): the only thread
  }
  to_minder.Close();
  return Minder(child, from_child.number(), signals.number(), options.end_with_parent, parent).WaitForTheEnd();
}

}  // namespace depthfarm
