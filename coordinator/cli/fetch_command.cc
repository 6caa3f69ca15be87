#include <chrono>
#include <iostream>

#include "common/files/writable_folder.h"
#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/fetch_session.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/progress.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kRoundInterval{1000};

}  // namespace

int Execute(const FetchArguments& arguments) {
  CatchInterruptions();
  if (const Status writable = CheckWritableFolder(arguments.output_dir); !writable.ok()) return Fail(writable);
  const StopOnInterruption stop;
  TransportContext context;
  const Result<std::unique_ptr<ArtifactClient>> peers = PeersOf(arguments.farm, context);
  if (!peers.ok()) return Fail(peers.status());
  const Result<std::unique_ptr<Client>> client = ConnectTo(arguments.farm);
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
    std::cout << FetchToJson(fetch, arguments.job, arguments.output_dir)
                     .dump(2, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  } else {
    std::cout << FormatFetch(fetch, arguments.job, arguments.output_dir);
  }
  return fetch.complete() ? kExitOk : kExitFailed;
}

}  // namespace depthfarm
