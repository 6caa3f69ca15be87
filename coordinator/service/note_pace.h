#ifndef DEPTHFARM_COORDINATOR_SERVICE_NOTE_PACE_H_
#define DEPTHFARM_COORDINATOR_SERVICE_NOTE_PACE_H_

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/scheduling/events.h"

namespace depthfarm {

// Which notes of the scheduler are logged: of each kind so many a minute, then how many were left out. Whoever says
// Hello without end, or tells results of leases that it never had, does not fill the disk so, nor hide notes of other
// kinds. A farm that works does not get there: that would be 100 tasks in every second.
class NotePace {
 public:
  static constexpr std::chrono::minutes kSpan{1};
  static constexpr std::uint64_t kMost = 6000;  // of a kind, in a span

  struct LeftOut {
    std::string event;
    std::uint64_t count = 0;
    friend bool operator==(const LeftOut&, const LeftOut&) = default;
  };

  // Whether a note of this kind is to be logged at `now`, which never goes back. The kinds are few: the names of
  // events.
  [[nodiscard]] bool Admit(const std::string& event, TimePoint now) {
    Span& span = spans_.try_emplace(event, Span{.began = now}).first->second;
    // One that something was left out of lasts until that is told.
    if (now - span.began >= kSpan && span.noted <= kMost) span = {.began = now};
    return ++span.noted <= kMost;
  }

  // How many were left out of the spans that are over at `now`, or without it of all; told once.
  [[nodiscard]] std::vector<LeftOut> TakeLeftOut(std::optional<TimePoint> now) {
    std::vector<LeftOut> left_out;
    std::erase_if(spans_, [&](const auto& entry) {
      const auto& [event, span] = entry;
      if (span.noted <= kMost || (now && *now - span.began < kSpan)) return false;
      left_out.push_back({event, span.noted - kMost});
      return true;
    });
    return left_out;
  }

 private:
  struct Span {
    TimePoint began;
    std::uint64_t noted = 0;
  };
  std::map<std::string, Span> spans_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_NOTE_PACE_H_
