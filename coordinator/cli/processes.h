#ifndef DEPTHFARM_COORDINATOR_CLI_PROCESSES_H_
#define DEPTHFARM_COORDINATOR_CLI_PROCESSES_H_

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/base/status.h"

namespace depthfarm {

// The program `name` in the folder of the running executable. kUnavailable when there is none that may be executed.
[[nodiscard]] Result<std::filesystem::path> SiblingProgram(const std::string& name);

// Replaces this process by `program` with `arguments` (without the program's name). Returns only on failure.
[[nodiscard]] Status ReplaceProcess(const std::filesystem::path& program, const std::vector<std::string>& arguments);

// Starts `program` as a process that outlives this one: in a session of its own, stdin /dev/null, `output` a file that
// stdout and stderr are appended to. Returns its id; it is a child as long as this process lives, so its end can be
// waited for. kUnavailable: it cannot be started.
[[nodiscard]] Result<pid_t> StartDetached(const std::filesystem::path& program,
                                          const std::vector<std::string>& arguments,
                                          const std::filesystem::path& output);

// How a process ended.
struct ProcessEnd {
  int exit_code = 0;  // valid when signal == 0
  int signal = 0;     // that killed it, 0: it exited
  [[nodiscard]] bool ok() const { return signal == 0 && exit_code == 0; }
};
// "exited with code 1", "killed by signal 9 (Killed)".
[[nodiscard]] std::string Describe(const ProcessEnd& end);

// A process that this one started: in a process group of its own (a Ctrl-C at the terminal does not reach it), killed
// by the kernel when the thread that started it ends, and by the destructor.
class ChildProcess {
 public:
  // `output`: file that stdout and stderr are appended to; empty: those of this process. Stdin is /dev/null. The child
  // starts with default signal dispositions. kUnavailable when it cannot be started, with the reason exec gave.
  [[nodiscard]] static Result<ChildProcess> Start(const std::filesystem::path& program,
                                                  const std::vector<std::string>& arguments,
                                                  const std::filesystem::path& output);
  ChildProcess(ChildProcess&& other) noexcept;
  ChildProcess& operator=(ChildProcess&& other) noexcept;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess();

  [[nodiscard]] pid_t pid() const { return pid_; }
  // The end of the process if it has ended; does not wait.
  [[nodiscard]] std::optional<ProcessEnd> Poll();
  // SIGTERM to its group, SIGKILL when it has not ended after `grace`; returns when it has ended.
  ProcessEnd Stop(std::chrono::milliseconds grace);
  // Waits for its end, at most `limit`.
  [[nodiscard]] std::optional<ProcessEnd> WaitFor(std::chrono::milliseconds limit);
  // `signal_number` to its group, as long as it runs.
  void Signal(int signal_number);

 private:
  explicit ChildProcess(pid_t pid) : pid_(pid) {}
  void KillAndReap() noexcept;

  pid_t pid_ = -1;
  std::optional<ProcessEnd> end_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_PROCESSES_H_
