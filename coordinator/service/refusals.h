#ifndef DEPTHFARM_COORDINATOR_SERVICE_REFUSALS_H_
#define DEPTHFARM_COORDINATOR_SERVICE_REFUSALS_H_

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace depthfarm {

// Messages that were not taken, since the start; with whom the last one came from and what was wrong with it.
struct MessageRefusals {
  std::uint64_t malformed = 0;      // no message of the farm, or one whose parts contradict each other
  std::uint64_t other_version = 0;  // of the protocol
  std::uint64_t wrong_role = 0;     // a key may not send this
  std::string last_user;
  std::string last_reason;

  [[nodiscard]] std::uint64_t total() const { return malformed + other_version + wrong_role; }
};

// When to log what was refused: the first time at once, then at most once a minute and only what is new, so that a
// flood does not fill the log.
class RefusalPace {
 public:
  static constexpr std::chrono::minutes kPause{1};

  // Whether a line is due at `now`, with `total` refused so far; it counts as written then.
  [[nodiscard]] bool Due(std::uint64_t total, std::chrono::steady_clock::time_point now) {
    if (total == logged_ || (last_ && now - *last_ < kPause)) return false;
    logged_ = total;
    last_ = now;
    return true;
  }

  // Whether some of `total` were not logged yet.
  [[nodiscard]] bool Owes(std::uint64_t total) const { return total != logged_; }

 private:
  std::uint64_t logged_ = 0;
  std::optional<std::chrono::steady_clock::time_point> last_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_REFUSALS_H_
