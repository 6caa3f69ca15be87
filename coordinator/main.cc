// depthfarm-coordinator: the daemon that plans jobs and hands their tasks to workers.
#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>

#include "common/log/log.h"
#include "coordinator/service/coordinator.h"

namespace {

constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;

std::atomic<depthfarm::Coordinator*> running{nullptr};

void OnSignal(int) {
  if (depthfarm::Coordinator* coordinator = running.load()) coordinator->Stop();
}

void StopOn(int signal) {
  struct sigaction action {};
  action.sa_handler = OnSignal;
  sigaction(signal, &action, nullptr);
}

int Fail(const depthfarm::Status& status) {
  std::cerr << "depthfarm-coordinator: " << status.message() << "\n";
  return status.code() == depthfarm::ErrorCode::kInvalidArgument ? kExitUsage : kExitFailed;
}

}  // namespace

int main(int argc, char** argv) {
  depthfarm::CoordinatorOptions options;
  std::string log_level = "info";
  std::int64_t heartbeat_ms = options.heartbeat.count();
  std::int64_t lease_ms = options.lease.count();

  CLI::App app("Plans depth estimation jobs and hands their tasks to workers.", "depthfarm-coordinator");
  app.add_option("--listen", options.endpoint, "tcp://HOST:PORT or ipc://PATH; PORT * takes a free one")
      ->capture_default_str();
  app.add_option("--keys", options.keys_dir,
                 "folder with coordinator.key, coordinator.pub and authorized (depthfarm keygen)");
  app.add_flag("--insecure", options.insecure, "no keys and no encryption; loopback addresses only");
  app.add_option("--heartbeat-ms", heartbeat_ms, "how often workers report")->capture_default_str();
  app.add_option("--lease-ms", lease_ms, "silence after which a worker is given up")->capture_default_str();
  app.add_option("--max-attempts", options.max_attempts, "of one task before its job fails")->capture_default_str();
  app.add_option("--log-level", log_level, "debug, info, warning, error or off")->capture_default_str();
  app.set_version_flag("--version", "depthfarm-coordinator " DEPTHFARM_VERSION);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kExitUsage;
  }
  options.heartbeat = std::chrono::milliseconds(heartbeat_ms);
  options.lease = std::chrono::milliseconds(lease_ms);
  if (const depthfarm::Status level = depthfarm::SetLogLevel(log_level); !level.ok()) return Fail(level);

  depthfarm::Result<std::unique_ptr<depthfarm::Coordinator>> coordinator = depthfarm::Coordinator::Create(options);
  if (!coordinator.ok()) return Fail(coordinator.status());
  running.store(coordinator->get());
  StopOn(SIGTERM);
  StopOn(SIGINT);
  std::cout << "listening on " << (*coordinator)->endpoint() << std::endl;
  const depthfarm::Status status = (*coordinator)->Run();
  running.store(nullptr);
  return status.ok() ? 0 : Fail(status);
}
