#include "coordinator/metrics/metrics_server.h"

#include <httplib.h>

#include <charconv>
#include <mutex>
#include <thread>
#include <utility>

namespace depthfarm {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr int kThreads = 2;
constexpr std::time_t kPatience = 5;  // seconds, for a client that sends or reads slowly
constexpr std::size_t kMostRequestBytes = 1024;

struct Address {
  std::string host;
  int port = 0;  // 0: a free one
};

Result<Address> ParseAddress(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? "" : text.substr(colon + 1);
  Address address{text.substr(0, colon == std::string::npos ? 0 : colon), 0};
  if (port != "*") {
    const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), address.port);
    if (error != std::errc() || end != port.data() + port.size() || address.port < 1 || address.port > 65535) {
      address.host.clear();
    }
  }
  if (!address.host.empty()) return address;
  return InvalidArgument("metrics address is '" + text + "', expected HOST:PORT such as 127.0.0.1:9470");
}

}  // namespace

struct MetricsServer::State {
  httplib::Server server;
  std::mutex mutex;
  std::string text;                   // guarded by mutex
  SteadyClock::time_point published;  // guarded by mutex
  std::thread thread;                 // accepts
};

MetricsServer::MetricsServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

Result<std::unique_ptr<MetricsServer>> MetricsServer::Start(const std::string& text) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Address address, ParseAddress(text));
  std::unique_ptr<MetricsServer> metrics(new MetricsServer(std::make_unique<State>()));
  State& state = *metrics->state_;
  state.published = SteadyClock::now();
  httplib::Server& server = state.server;
  server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  // Not the library's SO_REUSEPORT, by which another process of the user gets half of the questions.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  server.set_read_timeout(kPatience);
  server.set_write_timeout(kPatience);
  server.set_keep_alive_timeout(kPatience);
  server.set_payload_max_length(kMostRequestBytes);
  server.Get("/metrics", [&state](const httplib::Request&, httplib::Response& response) {
    const std::lock_guard lock(state.mutex);
    response.set_content(state.text, "text/plain; version=0.0.4");
  });
  server.Get("/healthz", [&state](const httplib::Request&, httplib::Response& response) {
    const std::lock_guard lock(state.mutex);
    const bool healthy = SteadyClock::now() - state.published < kHealthy;
    response.status = healthy ? 200 : 503;
    response.set_content(healthy ? "ok\n" : "the coordinator stands still\n", "text/plain");
  });
  int port = address.port;
  if (port == 0) {
    port = server.bind_to_any_port(address.host.c_str());
  } else if (!server.bind_to_port(address.host.c_str(), port)) {
    port = -1;
  }
  if (port < 0) return Unavailable("cannot serve metrics at " + text + ": the address is not this host's or is in use");
  metrics->address_ = address.host + ":" + std::to_string(port);
  state.thread = std::thread([&server] { server.listen_after_bind(); });
  return metrics;
}

MetricsServer::~MetricsServer() {
  if (!state_->thread.joinable()) return;
  // Stop before it listens is forgotten by the library.
  while (!state_->server.is_running()) std::this_thread::yield();
  state_->server.stop();
  state_->thread.join();
}

void MetricsServer::Publish(std::string text, SteadyClock::time_point now) {
  const std::lock_guard lock(state_->mutex);
  state_->text = std::move(text);
  state_->published = now;
}

}  // namespace depthfarm
