#ifndef DEPTHFARM_COORDINATOR_ENGINES_PROCESS_ENGINE_H_
#define DEPTHFARM_COORDINATOR_ENGINES_PROCESS_ENGINE_H_

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "coordinator/cli/processes.h"
#include "coordinator/engines/engine.h"
#include "coordinator/engines/pilot_spec.h"

namespace depthfarm {

// A machine that workers are started on by ssh.
struct SshHost {
  std::string name;  // as ssh takes it: host, user@host, or a Host of ssh's configuration
  int workers = 1;   // at most
  bool operator==(const SshHost&) const = default;
};

// Lines "HOST [WORKERS]"; empty lines and those that begin with '#' count nothing. kInvalidArgument names the line.
[[nodiscard]] Result<std::vector<SshHost>> ParseSshHosts(std::string_view text);

// Workers as processes that this one starts: on this machine, or through ssh on others, dealt evenly.
class ProcessEngine : public Engine {
 public:
  struct Options {
    std::vector<SshHost> hosts = {};              // empty: this machine
    std::vector<std::string> ssh_arguments = {};  // more of ssh's, "-p", "2222"
    std::filesystem::path ssh_program = "/usr/bin/ssh";
    std::filesystem::path log_dir = {};  // worker-PILOT.log
  };
  ProcessEngine(Options options, PilotSpec spec);
  // What runs here gets SIGTERM, and SIGKILL when it does not end in time. Workers on other machines lose their ssh;
  // they end by the coordinator's word, or when they miss it for PilotSpec::give_up_seconds.
  ~ProcessEngine() override;

  // kInvalidArgument: the hosts have no room for so many.
  [[nodiscard]] Status Launch(int count) override;
  [[nodiscard]] Result<std::vector<Pilot>> List() override;
  [[nodiscard]] Status Cancel(const std::vector<std::string>& ids) override;

 private:
  struct Running {
    std::string id;
    std::size_t host;  // of options_.hosts; 0 on this machine
    ChildProcess process;
  };
  void Reap();
  // The host with the most room left; nothing when all are full.
  [[nodiscard]] std::optional<std::size_t> HostWithRoom() const;
  [[nodiscard]] Result<ChildProcess> Start(const std::string& id, std::size_t host) const;

  Options options_;
  PilotSpec spec_;
  int last_id_ = 0;
  std::vector<Running> running_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_ENGINES_PROCESS_ENGINE_H_
