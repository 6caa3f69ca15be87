#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stop_token>
#include <thread>

#include "common/transport/context.h"
#include "common/transport/farm_keys.h"
#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/progress.h"
#include "coordinator/cli/report.h"
#include "coordinator/client/client.h"
#include "coordinator/fetching/result_fetch.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kRoundInterval{1000};
constexpr std::chrono::milliseconds kLookInterval{100};
constexpr std::size_t kMostReasons = 5;

nlohmann::ordered_json ToJson(const ResultFetch& fetch, std::uint64_t job, const std::string& dir) {
  nlohmann::ordered_json lost = nlohmann::ordered_json::array();
  for (const auto& [frame, reason] : fetch.lost()) lost.push_back({{"frame", frame}, {"reason", reason}});
  return {{"job", job},
          {"state", JobStateName(fetch.state())},
          {"complete", fetch.complete()},
          {"outputDir", dir},
          {"frames", fetch.num_frames()},
          {"framesHere", fetch.frames_here()},
          {"framesFetched", fetch.frames_fetched()},
          {"bytesFetched", fetch.bytes_fetched()},
          {"framesNotDone", fetch.not_done()},
          {"framesLost", lost}};
}

void Print(const ResultFetch& fetch, std::uint64_t job, const std::string& dir) {
  std::cout << fetch.frames_here() << " of " << fetch.num_frames() << " frames are in " << dir << ", "
            << fetch.frames_fetched() << " were fetched (" << FormatBytes(static_cast<double>(fetch.bytes_fetched()))
            << ")\n";
  if (const std::vector<int> open = fetch.not_done(); !open.empty()) {
    std::cout << "not done: frames " << FormatRanges(open) << "; job " << job << " is " << JobStateName(fetch.state());
    if (!fetch.job_error().ok()) std::cout << ": " << fetch.job_error().message();
    std::cout << "\n";
  }
  if (fetch.lost().empty()) return;
  std::vector<int> frames;
  for (const auto& [frame, reason] : fetch.lost()) frames.push_back(frame);
  std::cout << "lost: frames " << FormatRanges(frames) << "\n";
  std::size_t told = 0;
  for (const auto& [frame, reason] : fetch.lost()) {
    if (++told <= kMostReasons) std::cout << "  frame " << frame << ": " << reason << "\n";
  }
  if (fetch.state() == v1::JOB_STATE_RUNNING) {
    std::cout << "the job runs and makes again what no worker holds: fetch once more\n";
  } else {
    std::cout << "fetch once more when the workers are back, or submit the job again: what workers hold is not "
                 "computed again; fetch the new job into the same folder\n";
  }
}

Result<std::unique_ptr<ArtifactClient>> PeersOf(const FarmArguments& farm, TransportContext& context) {
  CurveKeys own;
  if (!farm.keys.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(ClientKeys keys, ReadClientKeys(farm.keys));
    own = std::move(keys.own);
  }
  return std::make_unique<ArtifactClient>(context, own, FetchOptions{});
}

// Ends what it is given the token of when the user interrupts.
class StopOnInterruption {
 public:
  StopOnInterruption()
      : watcher_([this](const std::stop_token& ended) {
          while (!ended.stop_requested() && !Interrupted()) std::this_thread::sleep_for(kLookInterval);
          if (Interrupted()) source_.request_stop();
        }) {}
  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::jthread watcher_;  // last: ends first
};

}  // namespace

int Execute(const FetchArguments& arguments) {
  CatchInterruptions();
  const StopOnInterruption stop;
  TransportContext context;
  const Result<std::unique_ptr<ArtifactClient>> peers = PeersOf(arguments.farm, context);
  if (!peers.ok()) return Fail(peers.status());
  const Result<std::unique_ptr<Client>> client = Client::Connect(
      {.endpoint = arguments.farm.coordinator, .keys_dir = arguments.farm.keys, .insecure = arguments.farm.insecure},
      {.timeout = std::chrono::milliseconds(std::llround(arguments.farm.timeout_seconds * 1000)), .stop = Interrupted});
  if (!client.ok()) return FailAsking(client.status());
  const auto opened = ResultFetch::Open(**client, **peers, arguments.job, arguments.output_dir);
  if (!opened.ok()) return FailAsking(opened.status());
  ResultFetch& fetch = **opened;
  ProgressLine progress;
  const auto show = [&] {
    progress.Show("job " + std::to_string(arguments.job) + ": " + std::to_string(fetch.frames_here()) + " of " +
                  std::to_string(fetch.num_frames()) + " frames are here");
  };
  while (true) {
    const Status status = fetch.Round(stop.token(), show);
    if (!status.ok()) {
      progress.Finish();
      return fetch.folder_failed() ? Fail(status) : FailAsking(status);
    }
    if (fetch.complete() || !arguments.wait || fetch.state() != v1::JOB_STATE_RUNNING) break;
    show();
    PauseUnlessInterrupted(kRoundInterval);
  }
  progress.Finish();
  if (arguments.json) {
    std::cout << ToJson(fetch, arguments.job, arguments.output_dir)
                     .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  } else {
    Print(fetch, arguments.job, arguments.output_dir);
  }
  return fetch.complete() ? kExitOk : kExitFailed;
}

}  // namespace depthfarm
