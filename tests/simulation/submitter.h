#ifndef DEPTHFARM_TESTS_SIMULATION_SUBMITTER_H_
#define DEPTHFARM_TESTS_SIMULATION_SUBMITTER_H_

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/wire/envelope.h"
#include "tests/simulation/event_queue.h"
#include "tests/simulation/job_shapes.h"
#include "tests/support/random.h"

namespace depthfarm::simulation {

// What somebody does with one job.
struct Wish {
  JobKind kind;
  int priority = 0;
  std::vector<std::string> tags = {};
  std::optional<Milliseconds> cancel_after = {};
  bool retries = false;  // once, should it fail or be cancelled
};

// What became of it.
struct JobEnd {
  Wish wish;
  std::uint64_t id = 0;
  bool retried = false;
  bool cancelled = false;  // the coordinator said that it will be
  v1::JobStatus status;
};

// Somebody who submits one job after the other, to one folder for depth and one for views, and waits for each. What is
// not answered is asked again.
class Submitter {
 public:
  // `send`: to the coordinator. `ended`: a job is over, and the next one not submitted yet.
  Submitter(std::string name, std::string folder, std::vector<Wish> wishes, EventQueue& events,
            std::function<void(std::string payload)> send, std::function<void(const JobEnd&)> ended);

  void Start(Milliseconds pause);
  void Receive(const std::string& payload);

  [[nodiscard]] const std::string& name() const { return name_; }
  // Where jobs of such a kind write: views are not among depth.
  [[nodiscard]] std::string FolderOf(const JobKind& kind) const { return folder_ + (kind.renders ? ".views" : ""); }
  [[nodiscard]] bool done() const { return ends_.size() == wishes_.size(); }
  [[nodiscard]] const std::vector<JobEnd>& ends() const { return ends_; }

 private:
  enum class Step { kSubmit, kFind, kWatch, kCancel, kRetry };
  [[nodiscard]] const Wish& wish() const { return wishes_[ends_.size()]; }
  [[nodiscard]] std::string JobName() const { return name_ + "-" + std::to_string(ends_.size()); }
  void Ask();
  void AskAfter(Milliseconds pause);
  void Watch(std::uint64_t job);
  void OnStatus(const v1::JobStatus& status);

  const std::string name_;
  const std::string folder_;
  const std::vector<Wish> wishes_;
  EventQueue& events_;
  std::function<void(std::string)> send_;
  std::function<void(const JobEnd&)> on_end_;
  std::vector<JobEnd> ends_;
  Step step_ = Step::kSubmit;
  std::uint64_t request_ = 0;  // of the newest question
  std::uint64_t job_ = 0;
  std::optional<TimePoint> cancel_at_;
  bool retried_ = false;
  bool cancelled_ = false;
};

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_SUBMITTER_H_
