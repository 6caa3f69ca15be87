#include "coordinator/cli/processes.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

namespace depthfarm {
namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

std::string ErrnoText(int error) { return std::strerror(error); }

std::vector<char*> ArgumentPointers(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

// A file descriptor closed at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int value) : value_(value) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { Close(); }
  [[nodiscard]] int get() const { return value_; }
  void Close() {
    if (value_ >= 0) ::close(value_);
    value_ = -1;
  }

 private:
  int value_;
};

ProcessEnd EndFromWaitStatus(int status) {
  if (WIFSIGNALED(status)) return {.exit_code = 0, .signal = WTERMSIG(status)};
  return {.exit_code = WEXITSTATUS(status), .signal = 0};
}

// Runs in the child between fork and exec: async-signal-safe calls only. Reports errno of a failure through `report`.
[[noreturn]] void ExecuteInChild(const char* program, char* const* arguments, int input, int output, int report,
                                 pid_t parent) {
  // A parent that ended before prctl took effect would never be noticed: hence the second look at getppid.
  const bool prepared = ::setpgid(0, 0) == 0 && ::prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && ::getppid() == parent &&
                        ::dup2(input, STDIN_FILENO) >= 0 &&
                        (output < 0 || (::dup2(output, STDOUT_FILENO) >= 0 && ::dup2(output, STDERR_FILENO) >= 0));
  if (prepared) {
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) ::signal(signal_number, SIG_DFL);
    sigset_t none;
    ::sigemptyset(&none);
    ::sigprocmask(SIG_SETMASK, &none, nullptr);
    ::execv(program, arguments);
  }
  const int error = errno;
  [[maybe_unused]] const auto written = ::write(report, &error, sizeof(error));
  ::_exit(127);
}

}  // namespace

Result<std::filesystem::path> SiblingProgram(const std::string& name) {
  std::error_code error;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return Unavailable("cannot tell where this program is: /proc/self/exe: " + error.message());
  const std::filesystem::path program = self.parent_path() / name;
  if (::access(program.c_str(), X_OK) != 0) {
    return Unavailable("program " + program.string() + " cannot be executed: " + ErrnoText(errno) +
                       "; it is expected beside " + self.filename().string());
  }
  return program;
}

Status ReplaceProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const std::vector<char*> pointers = ArgumentPointers(words);
  ::execv(program.c_str(), pointers.data());
  return Unavailable("cannot execute " + program.string() + ": " + ErrnoText(errno));
}

Result<pid_t> StartDetached(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                            const std::filesystem::path& output) {
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const std::vector<char*> pointers = ArgumentPointers(words);
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  sigset_t usual;
  sigemptyset(&usual);
  const sigset_t none = usual;
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) sigaddset(&usual, number);
  posix_spawnattr_setsigdefault(&attributes, &usual);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  pid_t pid = 0;
  const int failed = ::posix_spawn(&pid, program.c_str(), &files, &attributes, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) return Unavailable("cannot start " + program.string() + ": " + ErrnoText(failed));
  return pid;
}

std::string Describe(const ProcessEnd& end) {
  if (end.signal == 0) return "exited with code " + std::to_string(end.exit_code);
  return "killed by signal " + std::to_string(end.signal) + " (" + ::strsignal(end.signal) + ")";
}

Result<ChildProcess> ChildProcess::Start(const std::filesystem::path& program,
                                         const std::vector<std::string>& arguments,
                                         const std::filesystem::path& output) {
  std::vector<std::string> words = {program.string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const std::vector<char*> pointers = ArgumentPointers(words);
  const Descriptor input(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  if (input.get() < 0) return Unavailable("cannot open /dev/null: " + ErrnoText(errno));
  const Descriptor log(output.empty() ? -1 : ::open(output.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600));
  if (!output.empty() && log.get() < 0) {
    return Unavailable("cannot write log file " + output.string() + ": " + ErrnoText(errno));
  }
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return Unavailable("cannot make a pipe: " + ErrnoText(errno));
  const Descriptor report_read(ends[0]);
  Descriptor report_write(ends[1]);
  const pid_t parent = ::getpid();
  const pid_t pid = ::fork();
  if (pid < 0) return Unavailable("cannot start " + program.string() + ": " + ErrnoText(errno));
  if (pid == 0) ExecuteInChild(program.c_str(), pointers.data(), input.get(), log.get(), report_write.get(), parent);
  ChildProcess child(pid);
  report_write.Close();
  int error = 0;
  ssize_t received = 0;
  do {
    received = ::read(report_read.get(), &error, sizeof(error));  // end of file: exec closed the pipe
  } while (received < 0 && errno == EINTR);
  if (received > 0) return Unavailable("cannot start " + program.string() + ": " + ErrnoText(error));
  return child;
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept : pid_(std::exchange(other.pid_, -1)), end_(other.end_) {}

ChildProcess& ChildProcess::operator=(ChildProcess&& other) noexcept {
  if (this != &other) {
    KillAndReap();
    pid_ = std::exchange(other.pid_, -1);
    end_ = other.end_;
  }
  return *this;
}

ChildProcess::~ChildProcess() { KillAndReap(); }

void ChildProcess::KillAndReap() noexcept {
  if (pid_ <= 0 || end_) return;
  ::kill(-pid_, SIGKILL);
  ::kill(pid_, SIGKILL);  // the group may not exist yet
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  end_ = EndFromWaitStatus(status);
}

std::optional<ProcessEnd> ChildProcess::Poll() {
  if (pid_ > 0 && !end_) {
    int status = 0;
    if (::waitpid(pid_, &status, WNOHANG) == pid_) end_ = EndFromWaitStatus(status);
  }
  return end_;
}

std::optional<ProcessEnd> ChildProcess::WaitFor(milliseconds limit) {
  // A pidfd becomes readable when the process ends; an interrupting signal only makes the loop look again.
  const Descriptor process(static_cast<int>(::syscall(SYS_pidfd_open, pid_, 0)));
  const auto deadline = SteadyClock::now() + limit;
  while (!Poll()) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - SteadyClock::now());
    if (left <= milliseconds(0)) break;
    if (process.get() < 0) {
      ::poll(nullptr, 0, 5);
      continue;
    }
    pollfd event = {.fd = process.get(), .events = POLLIN, .revents = 0};
    ::poll(&event, 1, static_cast<int>(left.count()));
  }
  return end_;
}

void ChildProcess::Signal(int signal_number) {
  if (pid_ > 0 && !Poll()) ::kill(-pid_, signal_number);
}

ProcessEnd ChildProcess::Stop(milliseconds grace) {
  Signal(SIGTERM);
  if (!WaitFor(grace)) KillAndReap();
  return end_.value_or(ProcessEnd{});
}

}  // namespace depthfarm
