#ifndef DEPTHFARM_TESTS_SYSTEM_NETWORK_LAB_H_
#define DEPTHFARM_TESTS_SYSTEM_NETWORK_LAB_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/system/long_cable.h"

namespace depthfarm::system_test {

// Hosts with networks of their own: a namespace each, with an address, on a switch in a namespace of its own. They have
// no names: only this process holds them and what it starts in them, so that they are gone with it, however it ends.
// Nothing leads from them to the machine's networks or back.
class NetworkLab {
 public:
  explicit NetworkLab(int hosts);
  ~NetworkLab();
  NetworkLab(const NetworkLab&) = delete;
  NetworkLab& operator=(const NetworkLab&) = delete;

  // Why there is none (no rights, no tool); empty if there is.
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] static std::string AddressOf(int host);

  // What this thread starts and connects while it lives is on that host.
  class On {
   public:
    On(const NetworkLab& lab, int host) : On(lab.hosts_[static_cast<std::size_t>(host)]) {}
    ~On();
    On(const On&) = delete;
    On& operator=(const On&) = delete;

   private:
    friend class NetworkLab;
    explicit On(int network);
    int before_;
  };

  // All of them are empty when it worked, else they tell why not.
  // Its cable is pulled out of the switch: nobody is told.
  [[nodiscard]] std::string Cut(int host) const;
  // What it sends, or what is sent to it, is lost.
  [[nodiscard]] std::string Mute(int host) const;
  [[nodiscard]] std::string Deafen(int host) const;
  // So much of what it sends, and of what is sent to it.
  [[nodiscard]] std::string Lose(int host, int percent) const;
  // What these two send to each other.
  [[nodiscard]] std::string Part(int host, int other) const;
  // What it sends, and what is sent to it, takes its time, each way. Says so where there are no TAP devices.
  [[nodiscard]] std::string Delay(int host, const LongWay& way);
  // Undoes all of it. What is under way already arrives as late as it would have.
  [[nodiscard]] std::string Heal(int host) const;

 private:
  [[nodiscard]] static int MakeNetwork();
  [[nodiscard]] static std::string Run(int network, const std::string& script);
  [[nodiscard]] std::string RunOn(int host, const std::string& script) const;
  [[nodiscard]] std::string Join(int host) const;

  int switch_ = -1;
  std::vector<int> hosts_;
  std::map<int, std::unique_ptr<LongCable>> long_cables_;  // by host
  std::string problem_;
};

}  // namespace depthfarm::system_test

#endif  // DEPTHFARM_TESTS_SYSTEM_NETWORK_LAB_H_
