#ifndef DEPTHFARM_TESTS_SYSTEM_DELAY_LINE_H_
#define DEPTHFARM_TESTS_SYSTEM_DELAY_LINE_H_

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <random>
#include <string>
#include <utility>

namespace depthfarm::system_test {

// What a long way does to what is sent over it, in one direction.
struct LongWay {
  std::chrono::milliseconds delay{0};
  std::chrono::milliseconds jitter{0};  // as much more or less, at random, but nothing overtakes
  std::int64_t bytes_per_second = 0;    // that pass; 0: any number
};

// Packets on a long way. Told the time; pure.
class DelayLine {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  explicit DelayLine(std::uint32_t seed) : random_(seed) {}

  // For packets that are sent from now on.
  void Set(const LongWay& way) { way_ = way; }

  // Takes a packet that is sent at `now`; drops it, as a router does, when too many wait.
  void Push(std::string packet, TimePoint now) {
    if (way_.bytes_per_second > 0 && waiting_.size() >= kMostWaiting) return;
    if (way_.bytes_per_second > 0) {
      const auto bytes = static_cast<double>(packet.size());
      sent_ = std::max(sent_, now) + std::chrono::duration_cast<TimePoint::duration>(std::chrono::duration<double>(
                                         bytes / static_cast<double>(way_.bytes_per_second)));
    }
    std::uniform_real_distribution<double> swing(-1.0, 1.0);
    const std::chrono::duration<double, std::milli> late =
        way_.delay + swing(random_) * std::chrono::duration<double, std::milli>(way_.jitter);
    const TimePoint arrives = std::max(sent_, now) + std::chrono::duration_cast<TimePoint::duration>(late);
    last_arrival_ = std::max(last_arrival_, arrives);
    waiting_.emplace_back(last_arrival_, std::move(packet));
  }

  // When the next one arrives, if any is on its way.
  [[nodiscard]] std::optional<TimePoint> NextArrival() const {
    if (waiting_.empty()) return std::nullopt;
    return waiting_.front().first;
  }

  // The next packet that has arrived by `now`.
  [[nodiscard]] std::optional<std::string> Pop(TimePoint now) {
    if (waiting_.empty() || waiting_.front().first > now) return std::nullopt;
    std::string packet = std::move(waiting_.front().second);
    waiting_.pop_front();
    return packet;
  }

 private:
  static constexpr std::size_t kMostWaiting = 1000;

  LongWay way_;
  std::mt19937 random_;
  TimePoint sent_;          // when the last one was on the wire whole
  TimePoint last_arrival_;  // of all so far: none arrives before
  std::deque<std::pair<TimePoint, std::string>> waiting_;
};

}  // namespace depthfarm::system_test

#endif  // DEPTHFARM_TESTS_SYSTEM_DELAY_LINE_H_
