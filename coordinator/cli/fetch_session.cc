#include "coordinator/cli/fetch_session.h"

#include <chrono>
#include <cmath>
#include <vector>

#include "common/transport/farm_keys.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/report.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kLookInterval{100};
constexpr std::size_t kMostReasons = 5;

}  // namespace

CoordinatorTarget TargetOf(const FarmArguments& farm) {
  return {.endpoint = farm.coordinator, .keys_dir = farm.keys, .insecure = farm.insecure};
}

Result<std::unique_ptr<Client>> ConnectTo(const FarmArguments& farm) {
  return Client::Connect(
      TargetOf(farm),
      {.timeout = std::chrono::milliseconds(std::llround(farm.timeout_seconds * 1000)), .stop = Interrupted});
}

Result<std::unique_ptr<ArtifactClient>> PeersOf(const FarmArguments& farm, TransportContext& context) {
  CurveKeys own;
  if (!farm.keys.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(ClientKeys keys, ReadClientKeys(farm.keys));
    own = std::move(keys.own);
  }
  return std::make_unique<ArtifactClient>(context, own, FetchOptions{});
}

StopOnInterruption::StopOnInterruption()
    : watcher_([this](const std::stop_token& ended) {
        while (!ended.stop_requested() && !Interrupted()) std::this_thread::sleep_for(kLookInterval);
        if (Interrupted()) source_.request_stop();
      }) {}

nlohmann::ordered_json FetchToJson(const ResultFetch& fetch, std::uint64_t job, const std::string& dir) {
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

std::string FormatFetch(const ResultFetch& fetch, std::uint64_t job, const std::string& dir) {
  std::string text = std::to_string(fetch.frames_here()) + " of " + std::to_string(fetch.num_frames()) +
                     " frames are in " + dir + ", " + std::to_string(fetch.frames_fetched()) + " were fetched (" +
                     FormatBytes(static_cast<double>(fetch.bytes_fetched())) + ")\n";
  if (const std::vector<int> open = fetch.not_done(); !open.empty()) {
    text += "not done: frames " + FormatRanges(open) + "; job " + std::to_string(job) + " is " +
            JobStateName(fetch.state());
    if (!fetch.job_error().ok()) text += ": " + fetch.job_error().message();
    text += "\n";
  }
  if (fetch.lost().empty()) return text;
  std::vector<int> frames;
  for (const auto& [frame, reason] : fetch.lost()) frames.push_back(frame);
  text += "lost: frames " + FormatRanges(frames) + "\n";
  std::size_t told = 0;
  for (const auto& [frame, reason] : fetch.lost()) {
    if (++told <= kMostReasons) text += "  frame " + std::to_string(frame) + ": " + reason + "\n";
  }
  if (fetch.state() == v1::JOB_STATE_RUNNING)
    return text + "the job runs and makes again what no worker holds: fetch once more\n";
  return text +
         "fetch once more when the workers are back, or submit the job again: what workers hold is not computed "
         "again;\n"
         "fetch the new job into the same folder\n";
}

}  // namespace depthfarm
