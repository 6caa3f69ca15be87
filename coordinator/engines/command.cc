#include "coordinator/engines/command.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

namespace depthfarm {
namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr milliseconds kLookInterval{200};  // for a hurry

std::string ErrnoText(int error) { return std::generic_category().message(error); }

// When a command that starts now must have ended.
class Deadline {
 public:
  explicit Deadline(const CommandLimit& limit) : limit_(limit), end_(SteadyClock::now() + limit.usual) {}
  // 0 or less: none. The next question is due within kLookInterval.
  [[nodiscard]] milliseconds Left() {
    const auto now = SteadyClock::now();
    if (limit_.in_hurry && !hurries_ && limit_.in_hurry()) {
      hurries_ = true;
      end_ = std::min(end_, now + limit_.hurried);
    }
    return std::chrono::ceil<milliseconds>(end_ - now);
  }

 private:
  const CommandLimit& limit_;
  SteadyClock::time_point end_;
  bool hurries_ = false;
};

// Both ends of a pipe, closed with it.
class Pipe {
 public:
  Pipe() = default;
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    CloseRead();
    CloseWrite();
  }
  [[nodiscard]] bool Open() { return ::pipe2(ends_.data(), O_CLOEXEC) == 0; }
  [[nodiscard]] int read_end() const { return ends_[0]; }
  [[nodiscard]] int write_end() const { return ends_[1]; }
  void CloseRead() { Close(ends_[0]); }
  void CloseWrite() { Close(ends_[1]); }

 private:
  static void Close(int& end) {
    if (end >= 0) ::close(std::exchange(end, -1));
  }
  std::array<int, 2> ends_ = {-1, -1};
};

// As long as it lives, a write to a pipe that nobody reads is an error and no signal, in this thread.
class NoBrokenPipeSignal {
 public:
  NoBrokenPipeSignal() {
    sigemptyset(&broken_pipe_);
    sigaddset(&broken_pipe_, SIGPIPE);
    sigset_t pending;
    sigpending(&pending);
    was_pending_ = sigismember(&pending, SIGPIPE) == 1;
    pthread_sigmask(SIG_BLOCK, &broken_pipe_, &before_);
  }
  NoBrokenPipeSignal(const NoBrokenPipeSignal&) = delete;
  NoBrokenPipeSignal& operator=(const NoBrokenPipeSignal&) = delete;
  ~NoBrokenPipeSignal() {
    const timespec at_once{};
    while (!was_pending_ && sigtimedwait(&broken_pipe_, nullptr, &at_once) == SIGPIPE) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }

 private:
  sigset_t broken_pipe_;
  sigset_t before_;
  bool was_pending_ = false;
};

// Starts it with these three as stdin, stdout and stderr. Returns 0, or the errno of the failure.
int Spawn(const std::vector<std::string>& words, const Pipe& input, const Pipe& output, const Pipe& error, pid_t& pid) {
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&files, input.read_end(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&files, output.write_end(), STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, error.write_end(), STDERR_FILENO);
  // A group of its own: what it started goes with it, and a Ctrl-C at the terminal does not reach it. Signals that this
  // program ignores or catches are usual ones there.
  sigset_t usual;
  sigemptyset(&usual);
  sigset_t none = usual;
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) sigaddset(&usual, number);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  const int failed = ::posix_spawnp(&pid, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return failed;
}

// Appends what there is to read; false at the end of it.
bool ReadSome(int descriptor, std::string& text) {
  std::array<char, 65536> buffer;
  const ssize_t bytes = ::read(descriptor, buffer.data(), buffer.size());
  if (bytes < 0) return errno == EINTR || errno == EAGAIN;
  text.append(buffer.data(), static_cast<std::size_t>(bytes));
  return bytes > 0;
}

// Feeds and reads the program until it has closed its outputs. The reason if that did not come to a good end.
std::string Exchange(Pipe& input, Pipe& output, Pipe& error, std::string_view text, Deadline& deadline,
                     CommandOutput& result) {
  const NoBrokenPipeSignal no_signal;
  ::fcntl(input.write_end(), F_SETFL, O_NONBLOCK);
  if (text.empty()) input.CloseWrite();
  while (output.read_end() >= 0 || error.read_end() >= 0) {
    const milliseconds left = deadline.Left();
    if (left <= milliseconds(0)) return "did not end in time";
    const auto wait = static_cast<int>(std::min(left, kLookInterval).count());
    std::array<pollfd, 3> events = {{{output.read_end(), POLLIN, 0},  // a descriptor of -1 is passed over
                                     {error.read_end(), POLLIN, 0},
                                     {input.write_end(), POLLOUT, 0}}};
    if (::poll(events.data(), events.size(), wait) < 0) continue;  // a signal
    if (events[0].revents != 0 && !ReadSome(output.read_end(), result.output)) output.CloseRead();
    if (events[1].revents != 0 && !ReadSome(error.read_end(), result.error)) error.CloseRead();
    if (std::max(result.output.size(), result.error.size()) > kMostCommandOutput) return "wrote too much";
    if (events[2].revents != 0) {
      const ssize_t written = ::write(input.write_end(), text.data(), text.size());
      if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
      // A program that does not want all of its input is no failure.
      if (text.empty() || (written < 0 && errno != EINTR && errno != EAGAIN)) input.CloseWrite();
    }
  }
  return {};
}

}  // namespace

Result<CommandOutput> RunCommand(const std::vector<std::string>& words, std::string_view input,
                                 const CommandLimit& limit) {
  Deadline deadline(limit);
  Pipe to_input;
  Pipe from_output;
  Pipe from_error;
  if (!to_input.Open() || !from_output.Open() || !from_error.Open()) {
    return Unavailable("cannot make pipes for " + words[0] + ": " + ErrnoText(errno));
  }
  pid_t pid = 0;
  if (const int failed = Spawn(words, to_input, from_output, from_error, pid); failed != 0) {
    return Unavailable("cannot run " + words[0] + ": " + ErrnoText(failed));
  }
  to_input.CloseRead();
  from_output.CloseWrite();
  from_error.CloseWrite();
  CommandOutput result;
  const std::string trouble = Exchange(to_input, from_output, from_error, input, deadline, result);
  if (!trouble.empty()) ::kill(-pid, SIGKILL);
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (!trouble.empty()) return Unavailable(words[0] + " " + trouble + " and was killed");
  if (WIFSIGNALED(status)) {
    return Unavailable(words[0] + " was killed by signal " + std::to_string(WTERMSIG(status)) + ": " + result.error);
  }
  result.exit_code = WEXITSTATUS(status);
  return result;
}

std::string ShellQuoted(std::string_view word) {
  const auto plain = [](unsigned char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
           std::string_view("-_./:=,@%+").find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, plain)) {
    return std::string(word);
  }
  std::string quoted = "'";
  for (const char c : word) {
    if (c == '\'') {
      quoted += "'\\''";
    } else {
      quoted += c;
    }
  }
  return quoted + "'";
}

}  // namespace depthfarm
