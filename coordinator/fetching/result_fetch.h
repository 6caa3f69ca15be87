#ifndef DEPTHFARM_COORDINATOR_FETCHING_RESULT_FETCH_H_
#define DEPTHFARM_COORDINATOR_FETCHING_RESULT_FETCH_H_

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "coordinator/client/client.h"
#include "coordinator/fetching/fetched_folder.h"
#include "worker/transfer/artifact_client.h"

namespace depthfarm {

// Copies the results of a job that keeps them from its workers into a folder: each frame when it is done, depth.json
// when all are here. What is there with the right digest is not fetched again. Every name and byte from elsewhere is
// checked against what the job says. Not thread-safe.
class ResultFetch {
 public:
  // `client` and `peers` must outlive the fetch. Errors: those of Client (kInvalidArgument: no such job, or it writes
  // to a folder itself) and of FetchedFolder.
  [[nodiscard]] static Result<std::unique_ptr<ResultFetch>> Open(Client& client, ArtifactClient& peers,
                                                                 std::uint64_t job_id, const std::string& dir);

  // One round: asks what is done, and fetches what is not here yet; `on_frame` is called after each frame. When that
  // was the last one, depth.json is written. A frame that cannot be had is no error: see lost(). Errors: kCancelled
  // soon after `stop` is requested; kInvalidArgument: the folder holds the finished result of another job; those of
  // Client; kUnavailable: the folder cannot be written (`folder_failed`, which tells it from a silent coordinator).
  [[nodiscard]] Status Round(const std::stop_token& stop, const std::function<void()>& on_frame);
  [[nodiscard]] bool folder_failed() const { return folder_failed_; }

  // As of the last round. Frames are positions in the sequence.
  [[nodiscard]] v1::JobState state() const { return state_; }
  [[nodiscard]] const Status& job_error() const { return job_error_; }
  [[nodiscard]] bool complete() const { return complete_; }
  [[nodiscard]] int num_frames() const { return config_.resolved.num_frames; }
  [[nodiscard]] int frames_here() const { return frames_here_; }
  [[nodiscard]] int frames_fetched() const { return frames_fetched_; }
  [[nodiscard]] std::uint64_t bytes_fetched() const { return bytes_fetched_; }
  [[nodiscard]] std::vector<int> not_done() const;
  // Frames that are done and that no worker could send, with the reason.
  [[nodiscard]] const std::map<int, std::string>& lost() const { return lost_; }

 private:
  struct Frame {
    std::optional<FrameResult> result;
    bool here = false;
  };
  ResultFetch(Client& client, ArtifactClient& peers, std::uint64_t job_id)
      : client_(client), peers_(peers), job_id_(job_id) {}
  [[nodiscard]] Status Take(const v1::Results& page);
  [[nodiscard]] Status AskWhatIsDone();
  [[nodiscard]] Result<std::string> ManifestText() const;
  [[nodiscard]] Status FetchFrame(Frame& frame, const std::stop_token& stop);
  [[nodiscard]] Status WriteFrame(const FrameResult& result, const std::string& bundle);
  [[nodiscard]] int InSequence(int frame) const { return config_.resolved.params.first_frame + frame; }
  [[nodiscard]] Status OfFolder(Status status);

  Client& client_;
  ArtifactClient& peers_;
  const std::uint64_t job_id_;
  JobConfig config_;
  std::optional<FetchedFolder> folder_;
  std::vector<Frame> frames_;
  v1::JobState state_ = v1::JOB_STATE_UNSPECIFIED;
  Status job_error_;
  std::map<int, std::string> lost_;
  int frames_here_ = 0;
  int frames_fetched_ = 0;
  std::uint64_t bytes_fetched_ = 0;
  bool complete_ = false;
  bool folder_failed_ = false;
};

// "3, 5 to 9, 12" of ascending numbers; long lists end with "and N more".
[[nodiscard]] std::string FormatRanges(const std::vector<int>& numbers);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_FETCHING_RESULT_FETCH_H_
