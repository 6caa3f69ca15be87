#ifndef DEPTHFARM_COORDINATOR_SERVICE_STATUS_WAITS_H_
#define DEPTHFARM_COORDINATOR_SERVICE_STATUS_WAITS_H_

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/job/task.h"
#include "coordinator/scheduling/events.h"

namespace depthfarm {

// Questions after the status of jobs that run (GetJobStatus.wait_ms): each is answered when its job has ended, or else
// when its time is over.
class StatusWaits {
 public:
  struct Question {
    std::string peer;  // PeerMessage::peer
    std::uint64_t request_id = 0;
    JobId job;
    bool operator==(const Question&) const = default;
  };

  // More are answered at once: what waits takes memory.
  static constexpr std::size_t kMost = 1000;

  [[nodiscard]] bool full() const { return waiting_.size() >= kMost; }
  void Add(Question question, TimePoint until) { waiting_.emplace(until, std::move(question)); }
  // Takes out those after the job.
  [[nodiscard]] std::vector<Question> TakeOf(JobId job);
  // Takes out those whose time is over.
  [[nodiscard]] std::vector<Question> TakeDue(TimePoint now);

 private:
  std::multimap<TimePoint, Question> waiting_;  // by when they are answered at the latest
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_STATUS_WAITS_H_
