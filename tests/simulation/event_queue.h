#ifndef DEPTHFARM_TESTS_SIMULATION_EVENT_QUEUE_H_
#define DEPTHFARM_TESTS_SIMULATION_EVENT_QUEUE_H_

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <queue>
#include <utility>
#include <vector>

#include "coordinator/scheduling/events.h"

namespace depthfarm::simulation {

// A clock that jumps from event to event. Events of one time happen in the order in which they were planned.
class EventQueue {
 public:
  using Action = std::function<void()>;

  [[nodiscard]] TimePoint now() const { return now_; }
  void At(TimePoint time, Action action) { events_.push({std::max(time, now_), ++planned_, std::move(action)}); }
  void After(Milliseconds pause, Action action) { At(now_ + pause, std::move(action)); }

  // Lets the next event happen if it is not later than `end`; false if there is none, then it is `end` now.
  bool RunNext(TimePoint end) {
    if (events_.empty() || events_.top().time > end) {
      now_ = std::max(now_, end);
      return false;
    }
    now_ = events_.top().time;
    const Action action = events_.top().action;
    events_.pop();
    action();
    return true;
  }

 private:
  struct Event {
    TimePoint time;
    std::uint64_t number = 0;
    Action action;
    bool operator<(const Event& other) const {  // the queue's first is the largest
      return std::pair(time, number) > std::pair(other.time, other.number);
    }
  };

  TimePoint now_{std::chrono::hours(1)};
  std::uint64_t planned_ = 0;
  std::priority_queue<Event> events_;
};

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_EVENT_QUEUE_H_
