// One artifact from one process to another over loopback TCP: ArtifactServer to ArtifactClient, and bare ZeroMQ beside
// it, in turn.
#include <benchmark/benchmark.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "tests/benchmarks/bare_transfer.h"
#include "tests/benchmarks/benchmarks.h"
#include "tests/benchmarks/process_meter.h"
#include "tests/benchmarks/server_process.h"
#include "tests/support/temporary_folder.h"
#include "worker/artifacts/store.h"
#include "worker/transfer/artifact_client.h"
#include "worker/transfer/artifact_server.h"

namespace depthfarm::benchmarks {
namespace {

constexpr std::string_view kEndpoint = "tcp://127.0.0.1:*";
constexpr double kBytesPerMegabyte = 1e6;
constexpr double kBytesPerGigabyte = 1e9;
constexpr double kBytesPerMebibyte = 1024 * 1024;
constexpr double kMillisecondsPerSecond = 1000;
constexpr int kSmallRounds = 25;  // of a small artifact for each of a large one

// Random, so that nothing on the way can make them fewer.
std::string ArtifactBytes(std::size_t size) {
  std::mt19937_64 random(1);
  std::string bytes;
  bytes.reserve(size + sizeof(std::uint64_t));
  while (bytes.size() < size) {
    const std::uint64_t word = random();
    bytes.append(reinterpret_cast<const char*>(&word), sizeof(word));
  }
  bytes.resize(size);
  return bytes;
}

// A store on disk with the artifact in it.
struct StoredArtifact {
  explicit StoredArtifact(const std::string& bytes) {
    const auto store = ArtifactStore::Open(folder.path() / "store", 2 * bytes.size()).value();
    info = store->Put(ArtifactKey{1}, bytes).value();
  }
  testing_support::TemporaryFolder folder;
  ArtifactInfo info;
};

ServerProcess::Served ServeArtifacts(const std::filesystem::path& folder, const CurveKeys& keys) {
  struct Parts {
    TransportContext context;
    std::unique_ptr<ArtifactStore> store;
    std::unique_ptr<ArtifactServer> server;
  };
  const auto parts = std::make_shared<Parts>();
  if (!keys.public_key.empty() && !parts->context.Authenticate({{keys.public_key, "work:w"}}).ok()) return {};
  auto store = ArtifactStore::Open(folder / "store", std::uint64_t{1} << 40);
  if (!store.ok()) return {};
  parts->store = std::move(*store);
  auto server = ArtifactServer::Start(parts->context, *parts->store, std::string(kEndpoint), keys.secret_key);
  if (!server.ok()) return {};
  parts->server = std::move(*server);
  return {parts->server->endpoint(), [parts](int stop) {
            pollfd item{stop, POLLIN, 0};
            while (::poll(&item, 1, -1) <= 0) continue;
          }};
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Several transfers of one kind.
class MeasuredTransfers {
 public:
  // Each receiver keeps `kept_bytes` of what it receives.
  MeasuredTransfers(std::vector<pid_t> senders, std::size_t bytes, std::size_t kept_bytes)
      : bytes_(static_cast<double>(bytes)), kept_bytes_(static_cast<double>(kept_bytes)), receiver_(::getpid()) {
    for (const pid_t sender : senders) senders_.emplace_back(sender);
  }

  // False when the transfer failed. Returns its seconds in `seconds`.
  bool Measure(const std::function<bool()>& transfer, double& seconds) {
    for (ProcessMeter& sender : senders_) sender.Start();
    receiver_.Start();
    const auto start = std::chrono::steady_clock::now();
    if (!transfer()) return false;
    seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    megabytes_per_second_.push_back(bytes_ / kBytesPerMegabyte / seconds);
    double sent = 0;
    double memory = 0;
    for (const ProcessMeter& sender : senders_) {
      sent += sender.CpuSeconds();
      memory = std::max(memory, sender.PeakMebibytes());
    }
    sender_cpu_.push_back(sent * kBytesPerGigabyte / bytes_);
    receiver_cpu_.push_back(receiver_.CpuSeconds() * kBytesPerGigabyte / bytes_);
    sender_memory_.push_back(memory);
    receiver_memory_.push_back(std::max(0.0, receiver_.PeakMebibytes() - kept_bytes_ / kBytesPerMebibyte));
    return true;
  }

  [[nodiscard]] double MegabytesPerSecond() const { return Median(megabytes_per_second_); }
  [[nodiscard]] double BestMegabytesPerSecond() const { return *std::ranges::max_element(megabytes_per_second_); }
  // Rates, times and CPU: medians; memory: the largest.
  void Report(const std::string& name, benchmark::State& state) const {
    state.counters[name + "_MBps"] = MegabytesPerSecond();
    state.counters[name + "_ms"] = bytes_ / kBytesPerMegabyte / MegabytesPerSecond() * kMillisecondsPerSecond;
    state.counters[name + "_best_MBps"] = BestMegabytesPerSecond();
    state.counters[name + "_send_s_per_GB"] = Median(sender_cpu_);
    state.counters[name + "_receive_s_per_GB"] = Median(receiver_cpu_);
    state.counters[name + "_send_MiB"] = *std::ranges::max_element(sender_memory_);
    state.counters[name + "_receive_MiB"] = *std::ranges::max_element(receiver_memory_);
  }

 private:
  const double bytes_;
  const double kept_bytes_;
  std::vector<ProcessMeter> senders_;
  ProcessMeter receiver_;
  std::vector<double> megabytes_per_second_;
  std::vector<double> sender_cpu_;
  std::vector<double> receiver_cpu_;
  std::vector<double> sender_memory_;
  std::vector<double> receiver_memory_;
};

struct TransferCase {
  std::string name;
  bool curve = false;
  int holders = 1;
  std::size_t bytes = 0;
  int rounds = 1;
};

void MeasureTransfer(benchmark::State& state, const TransferCase& measured, bool& failed) {
  const std::size_t size = measured.bytes;
  const std::string bytes = ArtifactBytes(size);
  const StoredArtifact artifact(bytes);
  const CurveKeys keys = measured.curve ? GenerateCurveKeys().value() : CurveKeys{};
  // A store belongs to one process: each holder has its own.
  std::vector<std::unique_ptr<StoredArtifact>> copies;
  std::vector<std::unique_ptr<ServerProcess>> holders;
  std::vector<ArtifactLocation> locations;
  std::vector<pid_t> senders;
  for (int holder = 0; holder < measured.holders; ++holder) {
    copies.push_back(std::make_unique<StoredArtifact>(bytes));
    const std::filesystem::path folder = copies.back()->folder.path();
    holders.push_back(std::make_unique<ServerProcess>([&] { return ServeArtifacts(folder, keys); }));
    locations.push_back({holders.back()->endpoint(), keys.public_key});
    senders.push_back(holders.back()->process());
  }
  const ServerProcess bare([&] { return ServeBare(bytes, keys); });
  TransportContext context;
  ArtifactClient client(context, keys, {});
  BareReceiver receiver(bare.endpoint(), keys);

  const auto fetch = [&] {
    const Result<std::string> fetched = client.Fetch(artifact.info, locations, {});
    return fetched.ok() && *fetched == bytes;
  };
  const auto receive = [&] { return receiver.Receive(size); };
  MeasuredTransfers ours(senders, size, size);
  MeasuredTransfers theirs({bare.process()}, size, 0);
  bool right = fetch() && receive();  // connections, page cache, memory of the allocators
  for ([[maybe_unused]] auto _ : state) {
    double seconds = 0;
    double bare_seconds = 0;
    right = right && theirs.Measure(receive, bare_seconds);
    std::string fetched;
    right = right && ours.Measure(
                         [&] {
                           Result<std::string> result = client.Fetch(artifact.info, locations, {});
                           if (result.ok()) fetched = std::move(*result);
                           return result.ok();
                         },
                         seconds);
    right = right && fetched == bytes;
    state.SetIterationTime(seconds);
  }
  if (!right) {
    failed = true;
    state.SkipWithError("a transfer failed or brought other bytes");
    return;
  }
  ours.Report("ours", state);
  theirs.Report("bare", state);
  state.counters["ratio"] = ours.MegabytesPerSecond() / theirs.MegabytesPerSecond();
  state.counters["best_ratio"] = ours.BestMegabytesPerSecond() / theirs.BestMegabytesPerSecond();
}

}  // namespace

void RegisterTransferBenchmarks(std::size_t artifact_bytes, int rounds, bool& failed) {
  const std::string large = std::to_string(artifact_bytes >> 20) + "MiB";
  // Most artifacts are small: what counts there is how long one takes.
  const int small_rounds = rounds * kSmallRounds;
  const TransferCase cases[] = {{"plain/1_holder/" + large, false, 1, artifact_bytes, rounds},
                                {"curve/1_holder/" + large, true, 1, artifact_bytes, rounds},
                                {"plain/2_holders/" + large, false, 2, artifact_bytes, rounds},
                                {"curve/2_holders/" + large, true, 2, artifact_bytes, rounds},
                                {"plain/1_holder/64KiB", false, 1, std::size_t{64} << 10, small_rounds},
                                {"plain/1_holder/3MiB", false, 1, std::size_t{3} << 20, small_rounds},
                                {"curve/1_holder/64KiB", true, 1, std::size_t{64} << 10, small_rounds},
                                {"curve/1_holder/3MiB", true, 1, std::size_t{3} << 20, small_rounds}};
  for (const TransferCase& measured : cases) {
    benchmark::RegisterBenchmark(
        ("Transfer/" + measured.name).c_str(),
        [measured, &failed](benchmark::State& state) { MeasureTransfer(state, measured, failed); })
        ->Unit(benchmark::kMillisecond)
        ->UseManualTime()
        ->Iterations(measured.rounds);
  }
}

}  // namespace depthfarm::benchmarks
