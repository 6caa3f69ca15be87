#include "tests/simulation/network.h"

#include <algorithm>

namespace depthfarm::simulation {

bool Network::IsCut(const std::string& from, const std::string& to) const {
  const auto cut = cuts_.find({from, to});
  return cut != cuts_.end() && cut->second > events_.now();
}

void Network::Send(const std::string& from, const std::string& to, const EventQueue::Action& deliver) {
  ++sent_;
  if (random_.Chance(faults_.lost_percent)) {
    ++lost_;
    return;
  }
  DeliverOnce(from, to, deliver);
  if (random_.Chance(faults_.doubled_percent)) DeliverOnce(from, to, deliver);
}

void Network::DeliverOnce(const std::string& from, const std::string& to, const EventQueue::Action& deliver) {
  TimePoint arrival = events_.now() + Milliseconds(random_.Int(0, static_cast<int>(faults_.longest_delay.count())));
  if (IsCut(from, to)) {
    // A connection that breaks takes what is on its way with it; one that only stalls does not.
    if (random_.Chance(50)) {
      ++lost_;
      return;
    }
    arrival += cuts_.at({from, to}) - events_.now();
  }
  TimePoint& last = last_[{from, to}];
  if (!faults_.reorders) arrival = std::max(arrival, last);
  last = std::max(last, arrival);
  events_.At(arrival, deliver);
}

void Network::Calm() {
  faults_ = {};
  cuts_.clear();
}

}  // namespace depthfarm::simulation
