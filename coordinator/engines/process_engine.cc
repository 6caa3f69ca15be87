#include "coordinator/engines/process_engine.h"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <optional>
#include <sstream>
#include <utility>

#include "coordinator/engines/command.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kStopGrace{5000};
constexpr int kMostWorkersOfHost = 1024;

}  // namespace

Result<std::vector<SshHost>> ParseSshHosts(std::string_view text) {
  std::vector<SshHost> hosts;
  std::istringstream lines{std::string(text)};
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::istringstream words(line);
    SshHost host;
    if (!(words >> host.name) || host.name.front() == '#') continue;
    const std::string where = "line " + std::to_string(number) + ": ";
    if (host.name.front() == '-') return InvalidArgument(where + "'" + host.name + "' is no host");
    if (std::string workers; words >> workers) {
      std::istringstream digits(workers);
      const bool count = static_cast<bool>(digits >> host.workers) && digits.eof();
      if (!count || host.workers < 1 || host.workers > kMostWorkersOfHost) {
        return InvalidArgument(where + "'" + workers + "' workers on " + host.name + ", expected 1 to " +
                               std::to_string(kMostWorkersOfHost));
      }
    }
    if (std::string more; words >> more) {
      return InvalidArgument(where + "'" + more + "' is too much: expected HOST [WORKERS]");
    }
    if (std::ranges::any_of(hosts, [&](const SshHost& other) { return other.name == host.name; })) {
      return InvalidArgument(where + "host " + host.name + " is there twice");
    }
    hosts.push_back(host);
  }
  if (hosts.empty()) return InvalidArgument("no host is named: expected lines 'HOST [WORKERS]'");
  return hosts;
}

ProcessEngine::ProcessEngine(Options options, PilotSpec spec) : options_(std::move(options)), spec_(std::move(spec)) {}

ProcessEngine::~ProcessEngine() {
  for (Running& pilot : running_) pilot.process.Signal(SIGTERM);
  const auto deadline = std::chrono::steady_clock::now() + kStopGrace;
  for (Running& pilot : running_) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    pilot.process.Stop(std::max(left, std::chrono::milliseconds(1)));
  }
}

void ProcessEngine::Reap() {
  std::erase_if(running_, [](Running& pilot) { return pilot.process.Poll().has_value(); });
}

std::optional<std::size_t> ProcessEngine::HostWithRoom() const {
  if (options_.hosts.empty()) return 0;
  std::vector<int> room;
  for (const SshHost& host : options_.hosts) room.push_back(host.workers);
  for (const Running& pilot : running_) --room[pilot.host];
  const auto most = std::ranges::max_element(room);
  if (*most <= 0) return std::nullopt;
  return static_cast<std::size_t>(most - room.begin());
}

Result<ChildProcess> ProcessEngine::Start(const std::string& id, std::size_t host) const {
  std::vector<std::string> words = WorkerArguments(spec_);
  for (const std::string& word : {std::string("--name"), WorkerName(spec_.cluster, id, "0")}) words.push_back(word);
  const std::filesystem::path log = options_.log_dir / ("worker-" + id + ".log");
  if (options_.hosts.empty()) {
    words.emplace_back("--exit-with-parent");
    return ChildProcess::Start(spec_.worker_program, words, log);
  }
  // No password can be asked for; the shell at the other end gets one line.
  std::vector<std::string> ssh = {"-o", "BatchMode=yes", "-o", "ConnectTimeout=20", "-o", "ServerAliveInterval=15"};
  ssh.insert(ssh.end(), options_.ssh_arguments.begin(), options_.ssh_arguments.end());
  ssh.push_back("--");
  ssh.push_back(options_.hosts[host].name);
  std::string line = "exec " + ShellQuoted(spec_.worker_program);
  for (const std::string& word : words) line += " " + ShellQuoted(word);
  ssh.push_back(line);
  return ChildProcess::Start(options_.ssh_program, ssh, log);
}

Status ProcessEngine::Launch(int count) {
  Reap();
  for (int i = 0; i < count; ++i) {
    const std::optional<std::size_t> host = HostWithRoom();
    if (!host) {
      return InvalidArgument("the hosts have no room for " + std::to_string(count - i) + " more workers beside " +
                             std::to_string(running_.size()));
    }
    const std::string id = std::to_string(++last_id_);
    DEPTHFARM_ASSIGN_OR_RETURN(ChildProcess process, Start(id, *host));
    running_.push_back({id, *host, std::move(process)});
  }
  return {};
}

Result<std::vector<Pilot>> ProcessEngine::List() {
  Reap();
  std::vector<Pilot> pilots;
  for (const Running& pilot : running_) {
    const std::string host = options_.hosts.empty() ? "localhost" : options_.hosts[pilot.host].name;
    pilots.push_back({pilot.id, true, host, "process " + std::to_string(pilot.process.pid())});
  }
  return pilots;
}

Status ProcessEngine::Cancel(const std::vector<std::string>& ids) {
  for (Running& pilot : running_) {
    if (std::ranges::find(ids, pilot.id) != ids.end()) pilot.process.Signal(SIGTERM);
  }
  return {};
}

}  // namespace depthfarm
