#ifndef DEPTHFARM_TESTS_SYSTEM_LONG_CABLE_H_
#define DEPTHFARM_TESTS_SYSTEM_LONG_CABLE_H_

#include <array>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "tests/system/delay_line.h"

namespace depthfarm::system_test {

// A cable between two devices of a network namespace that takes its time. The kernel's own means (sch_netem) is in few
// kernels that tests run in, so each end is a TAP device, and a thread carries Ethernet frames from one to the other.
// Both devices are gone with it.
class LongCable {
 public:
  // Makes the devices, called `end` and `other_end`, in the network of this thread. See problem().
  LongCable(const std::string& end, const std::string& other_end);
  ~LongCable();
  LongCable(const LongCable&) = delete;
  LongCable& operator=(const LongCable&) = delete;

  // Why there is none (no rights, no /dev/net/tun); empty if there is.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  // What both ways are like from now on. What is under way already arrives first.
  void Set(const LongWay& way);

 private:
  struct End {
    int device = -1;
    DelayLine to_here;
  };

  void Carry(const std::stop_token& stop);
  // Has this end's frames on their way to the other one.
  void TakeFrom(const End& end, DelayLine& to_other) const;

  std::mutex lines_;  // guards DelayLines: Set is called by the test
  std::array<End, 2> ends_;
  std::string problem_;
  std::jthread carrier_;
};

}  // namespace depthfarm::system_test

#endif  // DEPTHFARM_TESTS_SYSTEM_LONG_CABLE_H_
