#include "coordinator/uploading/upload.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <random>
#include <stop_token>
#include <utility>
#include <vector>

#include "common/base/host_name.h"
#include "common/transport/endpoint.h"
#include "common/transport/farm_keys.h"
#include "worker/transfer/addresses.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kAliveInterval{1000};
constexpr std::chrono::milliseconds kLookInterval{100};

// One list of paths of a camera and the digests of those that the job reads.
struct FileList {
  const std::vector<std::string>& paths;
  std::vector<UploadedFile>& digests;
};

}  // namespace

Result<std::unique_ptr<Upload>> Upload::Start(const CoordinatorTarget& farm, const UploadOptions& options,
                                              const Sequence& sequence, const ResolvedJob& job, const OnFile& on_file) {
  std::unique_ptr<Upload> upload(new Upload());
  DEPTHFARM_RETURN_IF_ERROR(upload->AddFiles(sequence, job, on_file));
  DEPTHFARM_RETURN_IF_ERROR(upload->Serve(farm, options));
  return upload;
}

Status Upload::AddFiles(const Sequence& sequence, const ResolvedJob& job, const OnFile& on_file) {
  submission_.cameras.resize(sequence.cameras.size());
  std::vector<FileList> lists;
  std::size_t all = 0;
  const auto first = static_cast<std::size_t>(job.params.first_frame);
  const std::size_t end = first + static_cast<std::size_t>(job.num_frames);
  for (std::size_t c = 0; c < sequence.cameras.size(); ++c) {
    const SequenceCamera& camera = sequence.cameras[c];
    const auto estimated = [&](const JobView& view) { return view.camera.name == camera.camera.name; };
    if (std::ranges::none_of(job.views, estimated)) continue;
    if (camera.format.of_all_frames() && !camera.images.empty()) {
      return InvalidArgument(
          "camera '" + camera.camera.name + "': " + camera.images.front() +
          " is a video, and pictures of one frame are what --upload serves: put it where the workers "
          "see it, or make a file of each frame");
    }
    UploadSubmission::CameraFiles& files = submission_.cameras[c];
    for (const FileList& list :
         {FileList{camera.images, files.images}, FileList{camera.masks, files.masks},
          FileList{camera.prior, files.prior}, FileList{camera.prior_confidence, files.prior_confidence}}) {
      list.digests.resize(list.paths.size());
      for (std::size_t f = first; f < std::min(end, list.paths.size()); ++f) all += list.paths[f].empty() ? 0 : 1;
      lists.push_back(list);
    }
  }
  std::size_t read = 0;
  for (const FileList& list : lists) {
    for (std::size_t f = first; f < std::min(end, list.paths.size()); ++f) {
      if (list.paths[f].empty()) continue;
      DEPTHFARM_ASSIGN_OR_RETURN(list.digests[f], files_.Add(list.paths[f], [&] { return on_file(read, all); }));
      if (on_file(++read, all)) return Cancelled();
    }
  }
  return {};
}

Status Upload::Serve(const CoordinatorTarget& farm, const UploadOptions& options) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Endpoint coordinator, ParseEndpoint(farm.endpoint));
  const std::string unique = "upload-" + std::to_string(getpid()) + "-" + std::to_string(std::random_device()());
  const std::string asked = options.listen.empty() ? DefaultArtifactEndpoint(coordinator, unique) : options.listen;
  DEPTHFARM_ASSIGN_OR_RETURN(const Endpoint listen, ParseEndpoint(asked));
  const bool curve = listen.kind == Endpoint::Kind::kTcp && !farm.keys_dir.empty();
  DEPTHFARM_RETURN_IF_ERROR(CheckSecurity(listen, curve, farm.insecure));
  CurveKeys own;
  if (curve) {
    DEPTHFARM_ASSIGN_OR_RETURN(ClientKeys keys, ReadClientKeys(farm.keys_dir));
    if (keys.workers.empty()) {
      return InvalidArgument(
          farm.keys_dir +
          ": has no 'authorized' with keys of role work: it says which workers may fetch the pictures; "
          "copy the coordinator's");
    }
    own = std::move(keys.own);
    DEPTHFARM_RETURN_IF_ERROR(context_.Authenticate(std::move(keys.workers)));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(server_, ArtifactServer::Start(context_, files_, asked, own.secret_key));
  const std::string host = options.advertise.empty() ? HostName() : options.advertise;
  DEPTHFARM_ASSIGN_OR_RETURN(submission_.from.endpoint,
                             AdvertisedEndpoint(listen, server_->endpoint(), host, !options.advertise.empty()));
  submission_.from.public_key = own.public_key;
  return {};
}

Status Upload::KeepAlive(const CoordinatorTarget& farm, std::uint64_t job_id) {
  DEPTHFARM_ASSIGN_OR_RETURN(std::unique_ptr<Client> client,
                             Client::Connect(farm, {.timeout = 5 * kAliveInterval, .stop = {}}));
  keeper_ = std::jthread([client = std::move(client), job_id](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      // A coordinator that does not answer is the watching thread's to report.
      (void)client->GetStatus(job_id, true).ok();
      for (auto waited = std::chrono::milliseconds(0); waited < kAliveInterval && !stop.stop_requested();
           waited += kLookInterval)
        std::this_thread::sleep_for(kLookInterval);
    }
  });
  return {};
}

}  // namespace depthfarm
