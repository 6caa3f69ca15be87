#include "coordinator/clusters/scaler.h"

#include <algorithm>
#include <utility>

#include "coordinator/engines/pilot_spec.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kFirstPause{5'000};
constexpr std::chrono::milliseconds kLongestPause{300'000};

std::chrono::milliseconds PauseAfter(int failures) {
  std::chrono::milliseconds pause = kFirstPause;
  for (int i = 1; i < failures && pause < kLongestPause; ++i) pause *= 2;
  return std::min(pause, kLongestPause);
}

}  // namespace

int Scaler::Target(std::uint64_t wanted_slots) const {
  const auto slots = static_cast<std::uint64_t>(options_.slots_per_worker);
  const std::uint64_t workers = wanted_slots / slots + (wanted_slots % slots != 0 ? 1 : 0);
  const auto most = static_cast<std::uint64_t>(options_.max_workers);
  return std::max(options_.min_workers, static_cast<int>(std::min(workers, most)));
}

void Scaler::FindFailed(const ClusterView& view, ScalingDecision& decision) {
  std::map<std::string, bool> pilots;
  int appeared = 0;
  for (const Pilot& pilot : view.pilots) {
    const auto known = pilots_.find(pilot.id);
    pilots[pilot.id] = known != pilots_.end() && known->second;
    appeared += known == pilots_.end() ? 1 : 0;
  }
  decision.vanished = std::max(0, std::exchange(launched_, 0) - appeared);
  for (const ClusterWorker& worker : view.workers) {
    const std::optional<std::string> id = PilotOfWorker(options_.cluster, worker.name);
    if (!id || !pilots.contains(*id) || pilots[*id]) continue;
    pilots[*id] = true;
    failures_ = 0;
  }
  for (const auto& [id, joined] : pilots_) {
    if (!joined && !pilots.contains(id)) decision.failed.push_back(id);
  }
  pilots_ = std::move(pilots);
}

std::chrono::milliseconds Scaler::Pause(TimePoint now) {
  const std::chrono::milliseconds pause = PauseAfter(++failures_);
  launch_after_ = now + pause;
  return pause;
}

std::chrono::milliseconds Scaler::LaunchFailed(TimePoint now) {
  launched_ = 0;
  return Pause(now);
}

void Scaler::Shrink(const ClusterView& view, int surplus, TimePoint now, ScalingDecision& decision) {
  if (!surplus_since_) surplus_since_ = now;
  if (now - *surplus_since_ >= options_.settle) {
    for (auto pilot = view.pilots.rbegin(); pilot != view.pilots.rend() && surplus > 0; ++pilot) {
      if (pilot->running) continue;
      decision.cancel.push_back(pilot->id);
      pilots_.erase(pilot->id);  // its end is no failure
      --surplus;
    }
  }
  std::vector<std::pair<TimePoint, std::string>> idle;
  for (const auto& [name, since] : idle_since_) {
    if (now - since >= options_.idle) idle.emplace_back(since, name);
  }
  std::ranges::sort(idle);
  for (const auto& [since, name] : idle) {
    if (surplus-- <= 0) break;
    decision.drain.push_back(name);
  }
}

ScalingDecision Scaler::Decide(const ClusterView& view, TimePoint now) {
  ScalingDecision decision;
  FindFailed(view, decision);
  if (!decision.failed.empty() || decision.vanished > 0) decision.pause = Pause(now);

  std::map<std::string, TimePoint> idle_since;
  int leaving = 0;
  for (const ClusterWorker& worker : view.workers) {
    const std::optional<std::string> pilot = PilotOfWorker(options_.cluster, worker.name);
    if (!pilot) continue;
    if (worker.draining) {
      leaving += pilots_.contains(*pilot) ? 1 : 0;
    } else if (!worker.busy) {
      const auto known = idle_since_.find(worker.name);
      idle_since[worker.name] = known == idle_since_.end() ? now : known->second;
    }
  }
  idle_since_ = std::move(idle_since);

  const int target = Target(view.wanted_slots);
  const int live = static_cast<int>(view.pilots.size()) - leaving;
  if (live > target) {
    Shrink(view, live - target, now, decision);
  } else {
    surplus_since_.reset();
    if (live < target && now >= launch_after_) decision.launch = launched_ = target - live;
  }
  return decision;
}

}  // namespace depthfarm
