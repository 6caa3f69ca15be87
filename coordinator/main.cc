// depthfarm-coordinator: the daemon that plans jobs and hands their tasks to workers.
#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "common/files/atomic_file.h"
#include "common/files/user_folders.h"
#include "common/log/log.h"
#include "common/transport/descriptor_limit.h"
#include "coordinator/journal/journal.h"
#include "coordinator/service/coordinator_server.h"

namespace {

constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;

std::atomic<depthfarm::CoordinatorServer*> running{nullptr};
std::atomic<bool> hung_up{false};  // while it started

void OnSignal(int) {
  if (depthfarm::CoordinatorServer* coordinator = running.load()) coordinator->Stop();
}

void OnHangup(int) {
  if (depthfarm::CoordinatorServer* coordinator = running.load()) {
    coordinator->RereadKeys();
  } else {
    hung_up.store(true);
  }
}

void HandleSignal(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigaction(signal, &action, nullptr);
}

int Fail(const depthfarm::Status& status) {
  std::cerr << "depthfarm-coordinator: " << status.message() << "\n";
  return status.code() == depthfarm::ErrorCode::kInvalidArgument ? kExitUsage : kExitFailed;
}

// Where the journal is, its folder made; empty for none.
depthfarm::Result<std::string> JournalFile(const std::string& asked) {
  if (asked == "none") return std::string();
  if (!asked.empty()) return asked;
  const depthfarm::Result<std::string> folder = depthfarm::StateFolder();
  if (!folder.ok())
    return depthfarm::InvalidArgument(folder.status().message() + ": name a file with --journal, or none");
  DEPTHFARM_RETURN_IF_ERROR(depthfarm::MakeDirectories(*folder));
  return *folder + "/coordinator.sqlite";
}

}  // namespace

int main(int argc, char** argv) {
  depthfarm::CoordinatorOptions options;
  std::string log_level = "info";
  std::string journal;
  std::string check_journal;
  std::int64_t heartbeat_ms = options.heartbeat.count();
  std::int64_t lease_ms = options.lease.count();

  CLI::App app("Plans depth estimation jobs and hands their tasks to workers.", "depthfarm-coordinator");
  app.add_option("--listen", options.endpoint, "tcp://HOST:PORT or ipc://PATH; PORT * takes a free one")
      ->capture_default_str();
  app.add_option(
      "--keys", options.keys_dir,
      "folder with coordinator.key, coordinator.pub and authorized (depthfarm keygen); SIGHUP has the latter\n"
      "read again: who is no longer in it is refused from then on");
  app.add_flag("--insecure", options.insecure, "no keys and no encryption; loopback addresses only");
  app.add_option("--heartbeat-ms", heartbeat_ms, "how often workers report")->capture_default_str();
  app.add_option("--lease-ms", lease_ms, "silence after which a worker is given up")->capture_default_str();
  app.add_option("--max-attempts", options.max_attempts, "of one task before its job fails")->capture_default_str();
  app.add_flag("!--no-duplicates", options.duplicates, "do not give a task that takes too long to an idle worker, too");
  app.add_option(
      "--journal", journal,
      "SQLite file in which jobs outlive the coordinator, or none; default: depthfarm/coordinator.sqlite in\n"
      "$XDG_STATE_HOME or ~/.local/state");
  app.add_option("--keep-jobs", options.kept_jobs, "how many jobs that ended are remembered")
      ->check(CLI::PositiveNumber)  // or -1 would be a number of 20 digits
      ->capture_default_str();
  app.add_option("--check-journal", check_journal, "check such a file, say what is in it, and end");
  app.add_option("--metrics", options.metrics,
                 "HOST:PORT to serve /metrics (for Prometheus) and /healthz at, without keys: an address that only\n"
                 "operators reach, e.g. 127.0.0.1:9470; default: nowhere");
  app.add_option("--log-level", log_level, "debug, info, warning, error or off")->capture_default_str();
  app.set_version_flag("--version", "depthfarm-coordinator " DEPTHFARM_VERSION);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  }
  options.version = DEPTHFARM_VERSION;
  options.heartbeat = std::chrono::milliseconds(heartbeat_ms);
  options.lease = std::chrono::milliseconds(lease_ms);
  if (const depthfarm::Status level = depthfarm::SetLogLevel(log_level); !level.ok()) return Fail(level);

  if (!check_journal.empty()) {
    const depthfarm::Result<std::string> checked = depthfarm::CheckJournal(check_journal);
    if (!checked.ok()) return Fail(checked.status());
    std::cout << *checked << "\n";
    return 0;
  }
  depthfarm::Result<std::string> journal_file = JournalFile(journal);
  if (!journal_file.ok()) return Fail(journal_file.status());
  options.journal = std::move(journal_file).value();

  depthfarm::RaiseDescriptorLimit();
  // From before the keys are read: a signal meanwhile has them read once more. Without keys a hangup ends the program
  // as always.
  if (!options.keys_dir.empty()) HandleSignal(SIGHUP, OnHangup);
  depthfarm::Result<std::unique_ptr<depthfarm::CoordinatorServer>> coordinator =
      depthfarm::CoordinatorServer::Create(options);
  if (!coordinator.ok()) return Fail(coordinator.status());
  running.store(coordinator->get());
  if (hung_up.load()) (*coordinator)->RereadKeys();
  HandleSignal(SIGTERM, OnSignal);
  HandleSignal(SIGINT, OnSignal);
  if (!options.metrics.empty()) std::cout << "metrics at http://" << (*coordinator)->metrics_address() << "/metrics\n";
  std::cout << "listening on " << (*coordinator)->endpoint() << std::endl;
  const depthfarm::Status status = (*coordinator)->Run();
  running.store(nullptr);
  return status.ok() ? 0 : Fail(status);
}
