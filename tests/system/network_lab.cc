#include "tests/system/network_lab.h"

#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

int NetworkOfThread() { return ::open("/proc/thread-self/ns/net", O_RDONLY | O_CLOEXEC); }

// The cable of a host in the switch.
std::string Port(int host) { return "p" + std::to_string(host); }

// Rules of one host, which `nft delete table inet lab` takes back.
std::string Rules(const std::string& input, const std::string& output) {
  const auto chain = [](const std::string& hook, const std::string& rule) {
    return "add chain inet lab " + hook + " { type filter hook " + hook + " priority 0; }; add rule inet lab " + hook +
           " " + rule + " drop; ";
  };
  return "nft 'add table inet lab; " + (input.empty() ? "" : chain("input", input)) +
         (output.empty() ? "" : chain("output", output)) + "'";
}

}  // namespace

NetworkLab::On::On(int network) : before_(NetworkOfThread()) { (void)::setns(network, CLONE_NEWNET); }

NetworkLab::On::~On() {
  (void)::setns(before_, CLONE_NEWNET);
  (void)::close(before_);
}

int NetworkLab::MakeNetwork() {
  const int before = NetworkOfThread();
  if (::unshare(CLONE_NEWNET) != 0) {
    (void)::close(before);
    return -1;
  }
  const int made = NetworkOfThread();
  (void)::setns(before, CLONE_NEWNET);
  (void)::close(before);
  return made;
}

NetworkLab::NetworkLab(int hosts) {
  switch_ = MakeNetwork();
  for (int host = 0; host < hosts && switch_ >= 0; ++host) {
    const int network = MakeNetwork();
    if (network < 0) break;
    hosts_.push_back(network);
  }
  if (std::ssize(hosts_) < hosts) {
    problem_ = "cannot make network namespaces here: " + std::generic_category().message(errno);
    return;
  }
  problem_ = Run(switch_, "ip link add br0 type bridge && ip link set br0 up");
  for (int host = 0; host < hosts && problem_.empty(); ++host) problem_ = Join(host);
  // Not found out in the middle of a test.
  if (problem_.empty()) problem_ = Lose(0, 50);
  if (problem_.empty()) problem_ = Heal(0);
}

NetworkLab::~NetworkLab() {
  for (const int network : hosts_) (void)::close(network);
  if (switch_ >= 0) (void)::close(switch_);
}

// Of a range that is for tests of networks (RFC 2544).
std::string NetworkLab::AddressOf(int host) { return "198.18.77." + std::to_string(10 + host); }

std::string NetworkLab::Join(int host) const {
  const std::string its_network =
      "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(hosts_[static_cast<std::size_t>(host)]);
  std::string plugged = Run(switch_, "ip link add " + Port(host) + " type veth peer name eth0 netns " + its_network +
                                         " && ip link set " + Port(host) + " master br0 up");
  if (!plugged.empty()) return plugged;
  return RunOn(host, "ip link set lo up && ip addr add " + AddressOf(host) + "/24 dev eth0 && ip link set eth0 up");
}

std::string NetworkLab::Run(int network, const std::string& script) {
  const On on(network);
  const Outcome outcome = RunProgram("/bin/sh", {"-c", "PATH=$PATH:/usr/sbin:/sbin; " + script});
  return outcome.exit_code == 0 ? "" : script + ": " + outcome.output;
}

std::string NetworkLab::RunOn(int host, const std::string& script) const {
  return Run(hosts_[static_cast<std::size_t>(host)], script);
}

std::string NetworkLab::Cut(int host) const { return Run(switch_, "ip link set " + Port(host) + " down"); }

std::string NetworkLab::Mute(int host) const { return RunOn(host, Rules("", "oifname eth0")); }

std::string NetworkLab::Deafen(int host) const { return RunOn(host, Rules("iifname eth0", "")); }

std::string NetworkLab::Lose(int host, int percent) const {
  const std::string some = " numgen random mod 100 < " + std::to_string(percent);
  return RunOn(host, Rules("iifname eth0" + some, "oifname eth0" + some));
}

std::string NetworkLab::Part(int host, int other) const {
  return RunOn(host, Rules("ip saddr " + AddressOf(other), "ip daddr " + AddressOf(other)));
}

std::string NetworkLab::Delay(int host, const LongWay& way) {
  std::unique_ptr<LongCable>& cable = long_cables_[host];
  if (!cable) {
    // Between its port and the switch, in a bridge of its own: the host notices nothing.
    const std::string name = std::to_string(host);
    const std::string near = "near" + name;
    const std::string far = "far" + name;
    const std::string box = "box" + name;
    auto made = [&] {
      const On on(switch_);
      return std::make_unique<LongCable>(near, far);
    }();
    if (!made->problem().empty()) return made->problem();
    std::string plugged = Run(switch_, "ip link add " + box + " type bridge && ip link set " + box +
                                           " up && ip link set " + near + " master " + box + " up && ip link set " +
                                           far + " master br0 up && ip link set " + Port(host) + " master " + box);
    if (!plugged.empty()) return plugged;
    cable = std::move(made);
  }
  cable->Set(way);
  return "";
}

std::string NetworkLab::Heal(int host) const {
  if (const auto cable = long_cables_.find(host); cable != long_cables_.end() && cable->second) cable->second->Set({});
  std::string plugged = Run(switch_, "ip link set " + Port(host) + " up");
  if (!plugged.empty()) return plugged;
  return RunOn(host, "if nft list table inet lab >/dev/null 2>&1; then nft delete table inet lab; fi");
}

}  // namespace depthfarm::system_test
