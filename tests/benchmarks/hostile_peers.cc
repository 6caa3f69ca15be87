// depthfarm-hostile: what strangers, and keys that misbehave, cost a coordinator. Starts coordinators of its own on
// loopback and talks to nobody else. The machine's other load shows in wall times, hardly in CPU seconds.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "common/transport/client_channel.h"
#include "common/transport/context.h"
#include "common/transport/descriptor_limit.h"
#include "common/transport/farm_keys.h"
#include "common/wire/envelope.h"
#include "coordinator/cli/processes.h"
#include "coordinator/client/client.h"
#include "tests/benchmarks/process_meter.h"

namespace depthfarm::benchmarks {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

constexpr double kMicroseconds = 1e6;
constexpr int kHandshakes = 500;  // at a time: a context has 1,023 sockets
constexpr int kHandshakeRounds = 4;
constexpr int kMessages = 20'000;
constexpr int kMessagesUnderWay = 500;
constexpr int kFewDescriptors = 256;
constexpr int kConnectionsAtOnce = 50;  // fewer than wait to be accepted
constexpr milliseconds kBetweenConnections{5};
constexpr int kStrangersAtOnce = 100;  // beside a job
constexpr int kSilentAtOnce = 300;
constexpr std::size_t kJobs = 3;  // of each kind
constexpr int kFarmCore = 0;      // of coordinator and worker, where strangers have the next one
constexpr seconds kPatience{60};
constexpr seconds kJobPatience{600};

[[noreturn]] void Die(const std::string& what) {
  std::fprintf(stderr, "depthfarm-hostile: %s\n", what.c_str());
  std::exit(1);
}

std::string ReadText(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

bool WaitFor(const std::function<bool()>& condition, Clock::duration limit = kPatience) {
  const auto end = Clock::now() + limit;
  while (!condition()) {
    if (Clock::now() > end) return false;
    std::this_thread::sleep_for(milliseconds(20));
  }
  return true;
}

// A folder with the farm's keys, removed at the end.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "depthfarm-hostile-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) Die("cannot make " + name);
    path_ = name;
    if (const Status made = CreateFarmKeys(path_ / "keys"); !made.ok()) Die(made.message());
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] std::string keys() const { return (path_ / "keys").string(); }

 private:
  fs::path path_;
};

std::string OnFarmCore() { return "exec taskset -c " + std::to_string(kFarmCore) + " "; }

// A coordinator in a process of its own, with keys; `before`: what the shell does first, `exec` at the end.
class Target {
 public:
  Target(const Folder& folder, const std::string& name, const std::string& before = "exec ") {
    log_ = folder.path() / (name + ".log");
    const std::string command = before +
                                "'" DEPTHFARM_PROGRAM_DIR
                                "/depthfarm-coordinator' --listen 'tcp://127.0.0.1:*' --journal none --keys '" +
                                folder.keys() + "'";
    Result<ChildProcess> process = ChildProcess::Start("/bin/sh", {"-c", command}, log_);
    if (!process.ok()) Die(process.status().message());
    process_ = std::make_unique<ChildProcess>(std::move(*process));
    const std::string announcement = "listening on ";
    if (!WaitFor([&] { return ReadText(log_).find(announcement) != std::string::npos; })) Die(ReadText(log_));
    const std::string log = ReadText(log_);
    const std::size_t start = log.find(announcement) + announcement.size();
    endpoint_ = log.substr(start, log.find('\n', start) - start);
    keys_ = folder.keys();
  }

  [[nodiscard]] pid_t process() const { return process_->pid(); }
  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }
  [[nodiscard]] int port() const { return std::stoi(endpoint_.substr(endpoint_.rfind(':') + 1)); }
  [[nodiscard]] std::size_t log_bytes() const { return fs::file_size(log_); }
  [[nodiscard]] std::size_t Descriptors() const {
    const fs::directory_iterator files("/proc/" + std::to_string(process()) + "/fd");
    return static_cast<std::size_t>(std::distance(fs::begin(files), fs::end(files)));
  }
  // Seconds until an ordinary client is served.
  [[nodiscard]] double ServesAfter() const {
    const auto start = Clock::now();
    Result<std::unique_ptr<Client>> client =
        Client::Connect({.endpoint = endpoint_, .keys_dir = keys_}, {.timeout = milliseconds(kPatience), .stop = {}});
    if (!client.ok()) Die(client.status().message());
    if (const auto jobs = (*client)->ListJobs(); !jobs.ok()) Die("not served: " + jobs.status().message());
    return std::chrono::duration<double>(Clock::now() - start).count();
  }
  // Until it used no more CPU than when nothing happens.
  void AwaitQuiet() const {
    for (ProcessMeter meter(process());;) {
      meter.Start();
      std::this_thread::sleep_for(milliseconds(500));
      if (meter.CpuSeconds() < 0.01) return;
    }
  }

 private:
  fs::path log_;
  std::string endpoint_;
  std::string keys_;
  std::unique_ptr<ChildProcess> process_;
};

// Connections that say nothing.
class SilentConnections {
 public:
  explicit SilentConnections(int port) {
    address_.sin_family = AF_INET;
    address_.sin_port = htons(static_cast<std::uint16_t>(port));
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~SilentConnections() { Close(); }
  SilentConnections(const SilentConnections&) = delete;
  SilentConnections& operator=(const SilentConnections&) = delete;

  // As fast as they can be accepted: of more at once the system would drop some, to try again a second later.
  void Open(int count) {
    for (int i = 0; i < count; ++i) {
      if (i % kConnectionsAtOnce == kConnectionsAtOnce - 1) std::this_thread::sleep_for(kBetweenConnections);
      const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
      if (fd < 0) Die("no descriptor is left for connection " + std::to_string(open_.size() + 1));
      (void)::connect(fd, reinterpret_cast<const sockaddr*>(&address_), sizeof(address_));  // goes on by itself
      open_.push_back(fd);
    }
  }
  void Close() {
    for (const int fd : open_) ::close(fd);
    open_.clear();
  }

 private:
  sockaddr_in address_{};
  std::vector<int> open_;
};

// Strangers of a wrong key that come for the first time, `count` of them.
std::vector<std::unique_ptr<ClientChannel>> Strangers(TransportContext& context, const ClientKeys& farm,
                                                      const std::string& endpoint, int count) {
  std::vector<std::unique_ptr<ClientChannel>> strangers;
  for (int i = 0; i < count; ++i) {
    const ClientOptions options{.curve_server_public_key = farm.coordinator_public_key,
                                .curve_own = GenerateCurveKeys().value(),
                                .linger = milliseconds(0)};
    strangers.push_back(ClientChannel::Connect(context, endpoint, options).value());
  }
  return strangers;
}

void MeasureHandshakes(const Folder& folder, const Target& target) {
  const ClientKeys farm = ReadClientKeys(folder.keys()).value();
  ProcessMeter meter(target.process());
  meter.Start();
  for (int round = 0; round < kHandshakeRounds; ++round) {
    TransportContext context;
    const auto strangers = Strangers(context, farm, target.endpoint(), kHandshakes);
    target.AwaitQuiet();
  }
  constexpr int kAll = kHandshakes * kHandshakeRounds;
  std::printf("wrong key, handshakes: %d, coordinator CPU %.0f us each, memory +%.1f MiB\n", kAll,
              meter.CpuSeconds() * kMicroseconds / kAll, meter.PeakMebibytes());
}

// `payload` over and over from a worker's key; each is answered with an error.
void MeasureMessages(const Folder& folder, const Target& target, const char* what, const std::string& payload) {
  const WorkerKeys keys = ReadWorkerKeys(folder.keys()).value();
  TransportContext context;
  const auto channel =
      ClientChannel::Connect(context, target.endpoint(),
                             {.curve_server_public_key = keys.coordinator_public_key, .curve_own = keys.own})
          .value();
  ProcessMeter meter(target.process());
  const std::size_t log = target.log_bytes();
  meter.Start();
  int answered = 0;
  for (int sent = 0; answered < kMessages;) {
    while (sent < kMessages && sent - answered < kMessagesUnderWay && channel->Send(payload).ok()) ++sent;
    if (!channel->Receive(milliseconds(kPatience)).value()) Die("a refused message was not answered");
    ++answered;
  }
  std::printf("%s, messages: %d, coordinator CPU %.1f us each, memory +%.1f MiB, log +%zu bytes\n", what, kMessages,
              meter.CpuSeconds() * kMicroseconds / kMessages, meter.PeakMebibytes(), target.log_bytes() - log);
}

void MeasureSilent(const Target& target, int count) {
  ProcessMeter meter(target.process());
  const std::size_t before = target.Descriptors();
  meter.Start();
  SilentConnections silent(target.port());
  silent.Open(count);
  std::size_t most = 0;
  const auto end = Clock::now() + seconds(2);
  while (Clock::now() < end) most = std::max(most, target.Descriptors() - before);
  const double served = target.ServesAfter();
  const bool gone = WaitFor([&] { return target.Descriptors() <= before + 1; });
  std::printf(
      "silent connections: %d opened, %zu at once, coordinator CPU %.0f us each, memory +%.1f KiB each, a client is "
      "served "
      "after %.2f s, all %s\n",
      count, most, meter.CpuSeconds() * kMicroseconds / count, meter.PeakMebibytes() * 1024 / static_cast<double>(most),
      served, gone ? "let go" : "KEPT");
}

void MeasureExhaustion(const Target& target) {
  target.AwaitQuiet();
  SilentConnections silent(target.port());
  silent.Open(2 * kFewDescriptors);
  if (!WaitFor([&] { return target.Descriptors() >= kFewDescriptors - 1; })) Die("descriptors were not used up");
  ProcessMeter meter(target.process());
  meter.Start();
  const auto start = Clock::now();
  std::this_thread::sleep_for(seconds(1));
  const double wall = std::chrono::duration<double>(Clock::now() - start).count();
  const double cpu = meter.CpuSeconds() / wall;
  silent.Close();
  std::printf(
      "descriptors used up (limit %d): %.0f %% of a core meanwhile; after the end a client is served in %.2f s\n",
      kFewDescriptors, 100 * cpu, target.ServesAfter());
}

// This process and the threads it starts, on the next core.
void LeaveTheFarmCore() {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(kFarmCore + 1, &cores);
  if (::sched_setaffinity(0, sizeof(cores), &cores) != 0) Die("there are no two cores");
}

// Wrong keys and silent connections, again and again, while it lives.
class Siege {
 public:
  Siege(const Folder& folder, const Target& target)
      : thread_([this, farm = ReadClientKeys(folder.keys()).value(), endpoint = target.endpoint(),
                 port = target.port()](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            SilentConnections silent(port);
            silent.Open(kSilentAtOnce);
            TransportContext context;
            const auto strangers = Strangers(context, farm, endpoint, kStrangersAtOnce);
            std::this_thread::sleep_for(milliseconds(100));
            came_ += kStrangersAtOnce;
          }
        }) {}
  [[nodiscard]] int came() const { return came_; }

 private:
  std::atomic<int> came_{0};
  std::jthread thread_;
};

std::string Quoted(const fs::path& path) { return "'" + path.string() + "'"; }

void RunToItsEnd(const std::string& command, const fs::path& log) {
  Result<ChildProcess> process = ChildProcess::Start("/bin/sh", {"-c", command}, log);
  if (!process.ok()) Die(process.status().message());
  const std::optional<ProcessEnd> end = process->WaitFor(kJobPatience);
  if (!end || !end->ok()) Die(command + ": " + ReadText(log));
}

// Seconds of wall a job takes on a worker that computed nothing yet.
double JobSeconds(const Folder& folder, const Target& farm, const std::string& name) {
  const std::string programs = DEPTHFARM_PROGRAM_DIR;
  const std::string access = " --coordinator " + farm.endpoint() + " --keys " + Quoted(folder.keys());
  Result<ChildProcess> worker =
      ChildProcess::Start("/bin/sh",
                          {"-c", OnFarmCore() + Quoted(programs + "/depthfarm-worker") + access + " --cache-dir " +
                                     Quoted(folder.path() / (name + "-cache"))},
                          folder.path() / (name + ".log"));
  if (!worker.ok()) Die(worker.status().message());
  const auto start = Clock::now();
  RunToItsEnd("exec " + Quoted(programs + "/depthfarm") + " submit " + Quoted(folder.path() / "scene/sequence.json") +
                  " --wait -o " + Quoted(folder.path() / name) + access,
              folder.path() / (name + "-submit.log"));
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double Median(std::array<double, kJobs> values) {
  std::ranges::sort(values);
  return values[kJobs / 2];
}

// A job of which worker and coordinator share a core, alone and while strangers have the next core for themselves, in
// turn: what it loses is what the coordinator spends on them.
void MeasureJob(const Folder& folder) {
  RunToItsEnd("exec '" DEPTHFARM_PROGRAM_DIR
              "/depthfarm' scene arc --cameras 4 --size 480x360 --frames 4 --seed 5 -o " +
                  Quoted(folder.path() / "scene"),
              folder.path() / "scene.log");
  LeaveTheFarmCore();
  const Target farm(folder, "farm", OnFarmCore());
  std::array<double, kJobs> alone{};
  std::array<double, kJobs> besieged{};
  double cpu = 0;
  double under_siege = 0;
  int came = 0;
  for (std::size_t i = 0; i < kJobs; ++i) {
    alone[i] = JobSeconds(folder, farm, "alone-" + std::to_string(i));
    ProcessMeter meter(farm.process());
    meter.Start();
    const Siege siege(folder, farm);
    besieged[i] = JobSeconds(folder, farm, "besieged-" + std::to_string(i));
    cpu += meter.CpuSeconds();
    under_siege += besieged[i];
    came += siege.came();
  }
  std::printf(
      "a job on the coordinator's core: %.2f s alone, %.2f s while %.0f strangers a second come, %.2f times (medians "
      "of %zu); the coordinator takes %.0f %% of the core\n",
      Median(alone), Median(besieged), came / under_siege, Median(besieged) / Median(alone), kJobs,
      100 * cpu / under_siege);
}

}  // namespace
}  // namespace depthfarm::benchmarks

int main() {
  using namespace depthfarm;              // NOLINT(google-build-using-namespace): the program's own
  using namespace depthfarm::benchmarks;  // NOLINT(google-build-using-namespace)
  const std::uint64_t limit = RaiseDescriptorLimit();
  const Folder folder;
  const Target target(folder, "coordinator");
  std::printf("descriptors: %llu; an ordinary client is served after %.3f s\n", static_cast<unsigned long long>(limit),
              target.ServesAfter());
  MeasureHandshakes(folder, target);
  v1::Envelope wrong_role;
  wrong_role.mutable_list_jobs();
  MeasureMessages(folder, target, "wrong role", SerializeEnvelope(wrong_role));
  MeasureMessages(folder, target, "malformed", "not a message of the farm");
  for (const int count : {1'000, 10'000}) {
    if (static_cast<std::uint64_t>(count) + kFewDescriptors < limit) MeasureSilent(target, count);
  }
  const Target small(folder, "small", "ulimit -n " + std::to_string(kFewDescriptors) + " && exec ");
  MeasureExhaustion(small);
  MeasureJob(folder);
  return 0;
}
