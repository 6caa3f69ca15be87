#include "worker/lifecycle/lifecycle.h"

#include <algorithm>
#include <utility>

namespace depthfarm {
namespace {

namespace event = lifecycle_event;
namespace action = lifecycle_action;

}  // namespace

std::string WorkerStateName(WorkerState state) {
  switch (state) {
    case WorkerState::kJoining:
      return "joining";
    case WorkerState::kIdle:
      return "idle";
    case WorkerState::kWorking:
      return "working";
    case WorkerState::kLost:
      return "lost";
    case WorkerState::kLeaving:
      return "leaving";
    case WorkerState::kGone:
      return "gone";
  }
  return "unknown";
}

Lifecycle::Lifecycle(const LifecycleOptions& options, TimePoint now)
    : options_(options), now_(now), heard_(now), hello_due_(now), hello_retry_(options.first_hello_retry) {}

WorkerState Lifecycle::state() const {
  switch (link_) {
    case Link::kJoining:
      return WorkerState::kJoining;
    case Link::kWelcome:
      return held_.empty() ? WorkerState::kIdle : WorkerState::kWorking;
    case Link::kLost:
      return WorkerState::kLost;
    case Link::kLeaving:
      return WorkerState::kLeaving;
    case Link::kGone:
      break;
  }
  return WorkerState::kGone;
}

std::optional<TimePoint> Lifecycle::ExpiryOf(LeaseId lease) const {
  const auto held = held_.find(lease);
  if (held == held_.end() || held->second.stopped) return std::nullopt;
  return held->second.expires;
}

std::vector<LifecycleAction> Lifecycle::Handle(const LifecycleEvent& event, TimePoint now) {
  if (link_ == Link::kGone) return {};
  now_ = now;
  std::visit([this](const auto& happened) { On(happened); }, event);
  return std::exchange(actions_, {});
}

std::vector<LifecycleAction> Lifecycle::Tick(TimePoint now) {
  if (link_ == Link::kGone) return {};
  now_ = now;
  for (const auto& [lease, held] : held_) {
    if (now >= held.expires) Stop(lease, "lease expired");
  }
  if (link_ == Link::kLeaving) {
    if (now >= leave_by_) {
      link_ = Link::kGone;
      Do(action::Exit{exit_status_});
    }
    return std::exchange(actions_, {});
  }
  if (options_.give_up.has_value() && now - heard_ >= *options_.give_up) {
    Leave(Unavailable("the coordinator was silent for " + std::to_string(options_.give_up->count()) + " ms"));
    return std::exchange(actions_, {});
  }
  if (finish_by_ && now >= *finish_by_) {
    Leave({});
    return std::exchange(actions_, {});
  }
  if (Connected() && now - heard_ >= lease_) LoseCoordinator();
  if (Connected() && now >= heartbeat_due_) BeatHeart();
  if (!Connected() && now >= hello_due_) SayHello();
  return std::exchange(actions_, {});
}

TimePoint Lifecycle::NextDue() const {
  if (link_ == Link::kGone) return TimePoint::max();
  TimePoint due = TimePoint::max();
  for (const auto& [lease, held] : held_) {
    if (!held.stopped) due = std::min(due, held.expires);
  }
  if (link_ == Link::kLeaving) return std::min(due, leave_by_);
  if (options_.give_up.has_value()) due = std::min(due, heard_ + *options_.give_up);
  if (finish_by_) due = std::min(due, *finish_by_);
  return std::min(due, Connected() ? std::min(heartbeat_due_, heard_ + lease_) : hello_due_);
}

void Lifecycle::On(const event::Welcomed& welcome) {
  if (link_ == Link::kLeaving) return;
  link_ = Link::kWelcome;
  heartbeat_ = welcome.heartbeat;
  lease_ = welcome.lease;
  Heard();
  // A heartbeat at once: it is what renews the leases of running tasks, or says that they are gone.
  BeatHeart();
}

void Lifecycle::On(const event::Refused& refusal) {
  if (link_ == Link::kLeaving) return;
  const bool wrong_key = refusal.reason.code() == ErrorCode::kInvalidArgument && !Connected();
  if (refusal.reason.code() == ErrorCode::kIncompatible || wrong_key) {
    Leave(refusal.reason);
  } else if (Connected()) {
    LoseCoordinator();
    SayHello();
  }
}

void Lifecycle::On(const event::Granted& grant) {
  if (held_.contains(grant.lease)) return;  // a repeat starts nothing
  const auto ask = asks_.find(grant.ask_id);
  if (link_ == Link::kLeaving || finish_by_) {
    Do(action::RefuseGrant{grant.lease, "the worker is leaving"});
  } else if (Full()) {
    Do(action::RefuseGrant{grant.lease, "the worker has as many tasks as it takes"});
  } else if (!Connected() || ask == asks_.end()) {
    Do(action::RefuseGrant{grant.lease, "nobody asked"});
  } else if (now_ - ask->second > lease_ / 2) {
    Heard();
    Do(action::RefuseGrant{grant.lease, "the ask is more than half a lease old"});
    Ask();
  } else {
    Heard();
    held_[grant.lease] = Held{.expires = ask->second + lease_};
    // Later asks crossed the grant on their way; the coordinator may answer one of them yet.
    asks_.erase(asks_.begin(), std::next(ask));
    Do(action::StartTask{grant.lease});
    if (!Full()) Ask();
  }
}

void Lifecycle::On(const event::HeartbeatAcked& ack) {
  const auto beat = heartbeats_.find(ack.heartbeat_id);
  if (!Connected() || beat == heartbeats_.end()) return;
  Heard();
  const SentHeartbeat sent = beat->second;
  heartbeats_.erase(heartbeats_.begin(), std::next(beat));
  for (auto& [lease, held] : held_) {
    if (held.stopped) continue;
    if (std::ranges::find(ack.unknown_leases, lease) != ack.unknown_leases.end()) {
      held.revoked = true;  // as far as is known here: the revocation may be lost
      Stop(lease, "the coordinator does not know the lease");
    } else if (std::ranges::find(sent.running, lease) != sent.running.end()) {
      held.expires = std::max(held.expires, sent.sent + lease_);
    }
  }
}

void Lifecycle::On(const event::Revoked& revoked) {
  const auto held = held_.find(revoked.lease);
  if (held == held_.end()) return;
  held->second.revoked = true;
  Stop(revoked.lease, "revoked");
}

void Lifecycle::On(const event::TaskEnded& ended) {
  const auto held = held_.find(ended.lease);
  if (held == held_.end()) return;
  const bool awaited = held->second.revoked || (!held->second.stopped && now_ < held->second.expires);
  held_.erase(held);
  if (awaited) {
    Do(action::ReportTask{ended.lease});
  } else {
    Do(action::DropResult{ended.lease});
  }
  if (link_ == Link::kLeaving) {
    if (!held_.empty()) return;
    link_ = Link::kGone;
    Do(action::Exit{exit_status_});
  } else if (finish_by_ && held_.empty()) {
    Leave({});
  } else if (Connected()) {
    Ask();
  }
}

void Lifecycle::On(const event::StopRequested& stop) {
  if (link_ == Link::kLeaving) return;
  if (stop.finish > Milliseconds(0) && !finish_by_ && !held_.empty()) {
    finish_by_ = now_ + stop.finish;
  } else {
    Leave({});
  }
}

void Lifecycle::SayHello() {
  Do(action::SendHello{Running()});
  hello_due_ = now_ + hello_retry_;
  hello_retry_ = std::min(2 * hello_retry_, options_.last_hello_retry);
}

void Lifecycle::Ask() {
  if (finish_by_) return;
  // Asks too old to be taken are forgotten, so the list stays short however long the worker is idle.
  std::erase_if(asks_, [this](const auto& ask) { return now_ - ask.second > lease_; });
  asks_[++last_ask_] = now_;
  Do(action::SendAsk{last_ask_, Running()});
}

void Lifecycle::BeatHeart() {
  heartbeats_[++last_heartbeat_] = {now_, Valid()};
  Do(action::SendHeartbeat{last_heartbeat_, Running()});
  heartbeat_due_ = now_ + heartbeat_;
  if (!Full()) Ask();
}

void Lifecycle::LoseCoordinator() {
  link_ = Link::kLost;
  hello_due_ = now_;
  hello_retry_ = options_.first_hello_retry;
  heartbeats_.clear();
  asks_.clear();
}

void Lifecycle::Stop(LeaseId lease, const std::string& reason) {
  Held& held = held_.at(lease);
  if (held.stopped) return;
  held.stopped = true;
  Do(action::StopTask{lease, reason});
}

void Lifecycle::Heard() { heard_ = now_; }

void Lifecycle::Leave(Status status) {
  exit_status_ = std::move(status);
  Do(action::SendGoodbye{});
  if (held_.empty()) {
    link_ = Link::kGone;
    Do(action::Exit{exit_status_});
    return;
  }
  for (const auto& [lease, held] : held_) Stop(lease, "the worker is leaving");
  link_ = Link::kLeaving;
  leave_by_ = now_ + options_.goodbye_grace;
}

std::vector<LeaseId> Lifecycle::Valid() const {
  std::vector<LeaseId> leases;
  for (const auto& [lease, held] : held_) {
    if (!held.stopped) leases.push_back(lease);
  }
  return leases;
}

std::vector<LeaseId> Lifecycle::Running() const {
  std::vector<LeaseId> leases;
  for (const auto& [lease, held] : held_) {
    if (!held.stopped || held.revoked) leases.push_back(lease);
  }
  return leases;
}

}  // namespace depthfarm
