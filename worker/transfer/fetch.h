#ifndef DEPTHFARM_WORKER_TRANSFER_FETCH_H_
#define DEPTHFARM_WORKER_TRANSFER_FETCH_H_

#include <chrono>
#include <cstdint>
#include <deque>
#include <list>
#include <map>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "common/transport/poller.h"
#include "common/transport/received_message.h"
#include "worker/transfer/assembly.h"
#include "worker/transfer/peers.h"

namespace depthfarm {

struct FetchOptions {
  // Chunks asked for and not here yet, of one location and of all together. 8 MiB fill 1 Gbit/s at 60 ms; all together
  // are the memory that a transfer takes beside the artifact.
  int chunks_of_location = 8;
  int chunks_in_flight = 12;
  int max_locations = 4;                // at once
  std::uint32_t chunk_bytes = 1 << 20;  // at most kMaxChunkBytes
  // An artifact of this size or more has a thread for its digest: a smaller one is here before that would pay.
  std::uint64_t digest_thread_bytes = 8 << 20;
  // A location that sends nothing for this long loses its turn to others, if there are any.
  std::chrono::milliseconds patience{1000};
  std::chrono::milliseconds silence{4000};   // one that sends nothing for this long has failed
  std::chrono::milliseconds distrust{4000};  // and is not tried again for this long
  std::uint64_t max_artifact_bytes = std::uint64_t{1} << 36;
};

// The fetch of one artifact from the locations that hold it, from several at once where it is worth it: each has a few
// requests under way, so that who answers faster is asked more.
class Fetch {
 public:
  // `locations`, in the order of preference.
  Fetch(Peers& peers, const FetchOptions& options, const ArtifactInfo& artifact,
        std::span<const ArtifactLocation> locations, std::stop_token stop);
  ~Fetch();
  Fetch(const Fetch&) = delete;
  Fetch& operator=(const Fetch&) = delete;

  // Once. See ArtifactClient::Fetch.
  [[nodiscard]] Result<std::string> Run();

 private:
  using Clock = std::chrono::steady_clock;
  struct Candidate {
    ArtifactLocation location;
    bool last_chance = false;  // lost its turn before
  };
  // A location that is being asked.
  struct Source {
    Candidate candidate;
    std::shared_ptr<ClientChannel> channel;
    std::map<std::uint64_t, std::size_t> pending;  // pieces by request id
    Clock::time_point heard;
    Status failure;
  };

  // Fills the assembly and returns its digest. Errors: kCancelled; kUnavailable: no location is left.
  [[nodiscard]] Result<ContentDigest> Complete(Assembly& assembly);
  void AdmitSources(Assembly& assembly);
  void Ask(Assembly& assembly);
  [[nodiscard]] Status AskOne(Assembly& assembly, Source& source);
  [[nodiscard]] Status Wait();
  [[nodiscard]] Status TakeAnswers(Assembly& assembly, Source& source);
  [[nodiscard]] Status Take(Assembly& assembly, Source& source, const ReceivedMessage& message);
  // Lets go of sources that failed or were silent.
  void Sweep(Assembly& assembly);
  void TakeBack(Assembly& assembly, const Source& source);
  // The assembly is no artifact of that digest: its only contributor is to blame, or each must be tried alone.
  void StartAnew(Assembly& assembly);
  void Blame(const ArtifactLocation& location, const Status& reason);

  Peers& peers_;
  const FetchOptions options_;
  const ArtifactInfo artifact_;
  const std::stop_token stop_;
  std::size_t max_sources_ = 1;
  std::deque<Candidate> candidates_;
  std::list<Source> sources_;
  std::vector<ArtifactLocation> contributors_;  // whose pieces the assembly has
  bool alone_ = false;                          // one location at a time, each from the start
  std::size_t in_flight_ = 0;                   // pending pieces of all sources
  Status failure_;                              // the reasons of all that failed
  Poller poller_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_TRANSFER_FETCH_H_
