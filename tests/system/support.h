#ifndef DEPTHFARM_TESTS_SYSTEM_SUPPORT_H_
#define DEPTHFARM_TESTS_SYSTEM_SUPPORT_H_

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/cli/processes.h"
#include "coordinator/client/client.h"

namespace depthfarm::system_test {

using Words = std::vector<std::string>;

// How long an observable condition may take on a busy machine; never waited out by a test that passes. All programs
// are about ten times slower under ThreadSanitizer.
#if defined(__SANITIZE_THREAD__)
inline constexpr std::chrono::seconds kDeadline{600};
#else
inline constexpr std::chrono::seconds kDeadline{120};
#endif

// Polls until `condition` holds; false when it does not within kDeadline.
[[nodiscard]] bool WaitUntil(const std::function<bool()>& condition);

// A private folder below /tmp, removed at the end: short enough for socket paths.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

// One of the programs under test.
[[nodiscard]] std::filesystem::path Program(const std::string& name);
[[nodiscard]] std::string ReadFile(const std::filesystem::path& file);

// What a finished program said.
struct Outcome {
  int exit_code = -1;  // -1: killed by a signal or by the deadline
  std::string output;  // stdout and stderr together
};
// Runs a program of ours to its end.
[[nodiscard]] Outcome RunProgram(const std::string& name, const Words& arguments);
// `depthfarm` with these words; `run` computes everything (--no-cache) unless they name a --cache-dir.
[[nodiscard]] Outcome Depthfarm(const Words& words);
// The JSON document that ends `output` (progress may come before it); discarded when there is none.
[[nodiscard]] nlohmann::json ParseJsonTail(const std::string& output);

// Renders a small scene into `folder` and returns its sequence file.
struct SceneSize {
  int cameras = 3;
  int frames = 4;
  std::string size = "160x120";
};
[[nodiscard]] std::string RenderScene(const std::filesystem::path& folder, const SceneSize& size = {});

// Estimation options that make a run of RenderScene's scene take a second or so: 2 GOPs, 24 levels.
[[nodiscard]] Words SmallJob();
[[nodiscard]] Words operator+(Words first, const Words& second);

// Relative path -> content of depth.json and every file below DIR/depth and DIR/confidence.
[[nodiscard]] std::map<std::string, std::string> DepthOf(const std::filesystem::path& output_dir);
// The names that differ, for a readable failure.
[[nodiscard]] Words Differences(const std::map<std::string, std::string>& first,
                                const std::map<std::string, std::string>& second);
// Names of everything in `output_dir` that a finished or cancelled job must not leave.
[[nodiscard]] Words Leftovers(const std::filesystem::path& output_dir);

// Processes whose parent is `parent` and whose program is called `program` (both as /proc tells).
[[nodiscard]] std::vector<pid_t> ChildrenOf(pid_t parent, const std::string& program);
// Neither running nor anything but a zombie.
[[nodiscard]] bool IsGone(pid_t pid);

// A farm of separate processes that the test controls.
class Farm {
 public:
  // Listens on `endpoint` ("" = ipc in a private folder; a port "*" is a free one); `keys` for CURVE, without them
  // tcp is insecure. Returns once it
  // answers.
  explicit Farm(const std::string& endpoint = "", const std::string& keys = "");
  [[nodiscard]] bool ok() const { return problem_.empty(); }
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }
  // Ends the coordinator with this signal and starts another one at the same place, with the same journal. False (and
  // problem()) if that one does not answer.
  [[nodiscard]] bool RestartCoordinator(int signal);
  // Sends it a signal that does not end it.
  void SignalCoordinator(int signal) { coordinator_->Signal(signal); }
  [[nodiscard]] pid_t coordinator_pid() const { return coordinator_->pid(); }
  // What the coordinator that runs logged so far.
  [[nodiscard]] std::string CoordinatorLogged() const { return ReadFile(CoordinatorLog()); }
  [[nodiscard]] std::string Journal() const { return folder_ / "journal.sqlite"; }
  // Starts a worker, with a folder of its own unless the options name one, and returns its index. `keys`: other
  // ones than the farm's. `under`: a program with its first words, which is given the worker's command line to run.
  int AddWorker(const Words& options = {}, const std::string& keys = "", const Words& under = {});
  // What the worker logged so far.
  [[nodiscard]] std::string LogOf(int index) const;
  [[nodiscard]] ChildProcess& worker(int index) { return workers_[static_cast<std::size_t>(index)]; }
  [[nodiscard]] Client& client() { return *client_; }
  // Options that make `depthfarm` talk to this farm.
  [[nodiscard]] Words Options() const;
  [[nodiscard]] std::string Logs() const;

 private:
  [[nodiscard]] Words SecurityOptions() const;
  void StartCoordinator();
  [[nodiscard]] std::string CoordinatorLog() const {
    return folder_ / ("coordinator-" + std::to_string(coordinators_) + ".log");
  }

  TemporaryFolder folder_;
  std::string endpoint_;
  std::string keys_;
  std::string problem_;
  std::optional<ChildProcess> coordinator_;
  int coordinators_ = 0;  // that were started
  std::vector<ChildProcess> workers_;
  std::unique_ptr<Client> client_;
};

}  // namespace depthfarm::system_test

#endif  // DEPTHFARM_TESTS_SYSTEM_SUPPORT_H_
