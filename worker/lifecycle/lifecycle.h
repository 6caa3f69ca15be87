#ifndef DEPTHFARM_WORKER_LIFECYCLE_LIFECYCLE_H_
#define DEPTHFARM_WORKER_LIFECYCLE_LIFECYCLE_H_

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "common/base/status.h"
#include "common/job/task.h"

namespace depthfarm {

using TimePoint = std::chrono::steady_clock::time_point;
using Milliseconds = std::chrono::milliseconds;

// What a worker is to the coordinator.
enum class WorkerState {
  kJoining,  // said Hello, not welcomed yet
  kIdle,     // has no task
  kWorking,  // computes, or waits for stopped tasks to end
  kLost,     // heard nothing for lease_ms: says Hello again and again
  kLeaving,  // said goodbye; waits for its tasks to notice
  kGone,
};

// A stable word for logs.
[[nodiscard]] std::string WorkerStateName(WorkerState state);

// ---- what happens to a worker ----
namespace lifecycle_event {
struct Welcomed {
  Milliseconds heartbeat{};
  Milliseconds lease{};
};
// The coordinator refuses the worker for good (kIncompatible; kInvalidArgument in answer to Hello: its key may not work
// here), or does not know it (any other answer: say Hello again).
struct Refused {
  Status reason;
};
struct Granted {
  LeaseId lease;
  std::uint64_t ask_id = 0;
};
struct HeartbeatAcked {
  std::uint64_t heartbeat_id = 0;
  std::vector<LeaseId> unknown_leases;
};
struct Revoked {
  LeaseId lease;
};
// The task is over, with or without a result.
struct TaskEnded {
  LeaseId lease;
};
// StopWorker or a signal. With time to finish, the worker takes nothing new and leaves when its tasks are over, at the
// latest after that long, or when it is told again.
struct StopRequested {
  Milliseconds finish{0};
};
}  // namespace lifecycle_event

using LifecycleEvent = std::variant<lifecycle_event::Welcomed, lifecycle_event::Refused, lifecycle_event::Granted,
                                    lifecycle_event::HeartbeatAcked, lifecycle_event::Revoked,
                                    lifecycle_event::TaskEnded, lifecycle_event::StopRequested>;

// ---- what the worker must do about it ----
namespace lifecycle_action {
struct SendHello {
  std::vector<LeaseId> running;
  bool operator==(const SendHello&) const = default;
};
struct SendAsk {
  std::uint64_t ask_id = 0;
  std::vector<LeaseId> running;  // with those that were revoked and are not over yet
  bool operator==(const SendAsk&) const = default;
};
struct SendHeartbeat {
  std::uint64_t heartbeat_id = 0;
  std::vector<LeaseId> running;  // the same
  bool operator==(const SendHeartbeat&) const = default;
};
struct StartTask {
  LeaseId lease;
  bool operator==(const StartTask&) const = default;
};
// Cancel the task; a TaskEnded for it must still come.
struct StopTask {
  LeaseId lease;
  std::string reason;
  bool operator==(const StopTask&) const = default;
};
// Send TaskFinished with what the task found, or that it was stopped.
struct ReportTask {
  LeaseId lease;
  bool operator==(const ReportTask&) const = default;
};
// The task's lease is over, and its result nobody's: tell no one.
struct DropResult {
  LeaseId lease;
  bool operator==(const DropResult&) const = default;
};
// Send TaskFinished(kLeaseExpired) for a grant that is not taken.
struct RefuseGrant {
  LeaseId lease;
  std::string reason;
  bool operator==(const RefuseGrant&) const = default;
};
struct SendGoodbye {
  bool operator==(const SendGoodbye&) const = default;
};
struct Exit {
  Status status;  // ok: exit code 0
  bool operator==(const Exit& other) const { return status.code() == other.status.code(); }
};
}  // namespace lifecycle_action

using LifecycleAction =
    std::variant<lifecycle_action::SendHello, lifecycle_action::SendAsk, lifecycle_action::SendHeartbeat,
                 lifecycle_action::StartTask, lifecycle_action::StopTask, lifecycle_action::ReportTask,
                 lifecycle_action::DropResult, lifecycle_action::RefuseGrant, lifecycle_action::SendGoodbye,
                 lifecycle_action::Exit>;

struct LifecycleOptions {
  int capacity = 1;  // tasks at a time: those being computed and those whose inputs are fetched ahead
  Milliseconds first_hello_retry{500};  // then doubled for each Hello that nobody answered
  Milliseconds last_hello_retry{5000};
  Milliseconds goodbye_grace{1500};     // how long stopped tasks may take to end before the worker goes anyway
  std::optional<Milliseconds> give_up;  // silence after which the worker ends; never if not set
};

// All that a worker decides about joining, asking, leases and leaving. Holds no socket, thread or clock. One owner.
//
//   joining --Welcomed--> idle --Granted--> working --last TaskEnded--> idle   StopRequested from anywhere: leaving
//      with time to finish: after the last TaskEnded
//      idle, working --no answer for lease--> lost --Welcomed--> idle or working     leaving --last TaskEnded--> gone
//
// A lease counts from the moment the worker sent the ask that was granted, or the last heartbeat that was acked: before
// the coordinator counts from, so that the worker always gives up first. It asks while it has fewer tasks than its
// capacity; which of them is computed when is not its matter.
class Lifecycle {
 public:
  Lifecycle(const LifecycleOptions& options, TimePoint now);

  // Applies one event and returns what must now be done, in order.
  [[nodiscard]] std::vector<LifecycleAction> Handle(const LifecycleEvent& event, TimePoint now);
  // Does what is due at `now`: the first Hello, heartbeats, expiry. A second call at the same `now` returns nothing.
  [[nodiscard]] std::vector<LifecycleAction> Tick(TimePoint now);
  // When Tick has something to do next; TimePoint::max() when nothing is due ever.
  [[nodiscard]] TimePoint NextDue() const;

  [[nodiscard]] WorkerState state() const;
  // Until when the task is the worker's to do, as far as is known now; nothing when it is not.
  [[nodiscard]] std::optional<TimePoint> ExpiryOf(LeaseId lease) const;

 private:
  struct Held {
    TimePoint expires;
    bool stopped = false;  // its result is not wanted
    bool revoked = false;  // that is why; the coordinator waits for its end
  };
  struct SentHeartbeat {
    TimePoint sent;
    std::vector<LeaseId> running;
  };

  void On(const lifecycle_event::Welcomed& event);
  void On(const lifecycle_event::Refused& event);
  void On(const lifecycle_event::Granted& event);
  void On(const lifecycle_event::HeartbeatAcked& event);
  void On(const lifecycle_event::Revoked& event);
  void On(const lifecycle_event::TaskEnded& event);
  void On(const lifecycle_event::StopRequested& event);

  template <typename Action>
  void Do(Action action) {
    actions_.emplace_back(std::in_place_type<Action>, std::move(action));
  }
  void SayHello();
  void Ask();
  void BeatHeart();
  void LoseCoordinator();
  void Stop(LeaseId lease, const std::string& reason);
  void Heard();
  void Leave(Status status);
  // The leases whose tasks are the worker's to do; with those that were revoked and are not over, what the coordinator
  // should count as running.
  [[nodiscard]] std::vector<LeaseId> Valid() const;
  [[nodiscard]] std::vector<LeaseId> Running() const;
  [[nodiscard]] bool Full() const { return static_cast<int>(held_.size()) >= options_.capacity; }
  [[nodiscard]] bool Connected() const { return link_ == Link::kWelcome; }

  enum class Link { kJoining, kWelcome, kLost, kLeaving, kGone };

  const LifecycleOptions options_;
  TimePoint now_;                         // of the event being handled
  std::vector<LifecycleAction> actions_;  // of the event being handled

  Link link_ = Link::kJoining;
  Milliseconds heartbeat_{};
  Milliseconds lease_{};
  TimePoint heard_;  // last sign of the coordinator
  TimePoint hello_due_;
  Milliseconds hello_retry_;
  TimePoint heartbeat_due_;
  std::optional<TimePoint> finish_by_;  // it was told to leave when its tasks are over, or then
  TimePoint leave_by_;
  Status exit_status_;
  std::map<LeaseId, Held> held_;
  std::uint64_t last_ask_ = 0;
  std::uint64_t last_heartbeat_ = 0;
  std::map<std::uint64_t, TimePoint> asks_;            // sent after the one last granted
  std::map<std::uint64_t, SentHeartbeat> heartbeats_;  // not answered yet
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_LIFECYCLE_LIFECYCLE_H_
