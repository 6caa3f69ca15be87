#ifndef DEPTHFARM_TESTS_SIMULATION_NETWORK_H_
#define DEPTHFARM_TESTS_SIMULATION_NETWORK_H_

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>

#include "tests/simulation/event_queue.h"
#include "tests/support/random.h"

namespace depthfarm::simulation {

struct NetworkFaults {
  Milliseconds longest_delay{20};
  int lost_percent = 0;
  int doubled_percent = 0;
  bool reorders = false;  // else messages of one host to another arrive in their order
  bool operator==(const NetworkFaults&) const = default;
};

// Messages between hosts, each with a delay of its own; some are lost or come twice. The way from one host to another
// can be cut, in one direction or both.
class Network {
 public:
  Network(EventQueue& events, test::Random& random, const NetworkFaults& faults)
      : events_(events), random_(random), faults_(faults) {}

  void Send(const std::string& from, const std::string& to, const EventQueue::Action& deliver);
  // What is sent until then is lost, or comes after it.
  void Cut(const std::string& from, const std::string& to, TimePoint until) { cuts_[{from, to}] = until; }
  [[nodiscard]] bool IsCut(const std::string& from, const std::string& to) const;
  // From now on nothing goes wrong.
  void Calm();

  [[nodiscard]] std::uint64_t num_sent() const { return sent_; }
  [[nodiscard]] std::uint64_t num_lost() const { return lost_; }

 private:
  void DeliverOnce(const std::string& from, const std::string& to, const EventQueue::Action& deliver);

  using Way = std::pair<std::string, std::string>;
  EventQueue& events_;
  test::Random& random_;
  NetworkFaults faults_;
  std::map<Way, TimePoint> cuts_;
  std::map<Way, TimePoint> last_;  // arrival
  std::uint64_t sent_ = 0;
  std::uint64_t lost_ = 0;
};

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_NETWORK_H_
