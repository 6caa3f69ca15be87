#ifndef DEPTHFARM_TESTS_SYSTEM_MANAGED_CLUSTER_H_
#define DEPTHFARM_TESTS_SYSTEM_MANAGED_CLUSTER_H_

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "tests/system/support.h"

namespace depthfarm::system_test {

// A cluster that the test brings up and takes down with `depthfarm cluster`.
class ManagedCluster {
 public:
  // Its state folder, which need not be there yet.
  explicit ManagedCluster(std::filesystem::path state) : state_(std::move(state)) {}
  ManagedCluster(const ManagedCluster&) = delete;
  ManagedCluster& operator=(const ManagedCluster&) = delete;
  ~ManagedCluster() { (void)Call("down"); }

  // `depthfarm cluster ACTION` for this one.
  [[nodiscard]] Outcome Call(const std::string& action, const Words& options = {}) const {
    return Depthfarm(Words{"cluster", action, "--state", state_.string()} + options);
  }
  // What `status --json` says; discarded when it says nothing.
  [[nodiscard]] nlohmann::json Status() const { return ParseJsonTail(Call("status", {"--json"}).output); }
  // Whether its status is such within the deadline.
  [[nodiscard]] bool Comes(const std::function<bool(const nlohmann::json&)>& condition) const {
    return WaitUntil([&] {
      const nlohmann::json status = Status();
      return !status.is_discarded() && condition(status);
    });
  }
  // Options that make `depthfarm` talk to its coordinator.
  [[nodiscard]] Words Target() const {
    const nlohmann::json status = Status();
    return {"--coordinator", status.at("coordinator"), "--keys", status.at("keys")};
  }
  [[nodiscard]] std::filesystem::path Log(const std::string& name) const { return state_ / "log" / (name + ".log"); }
  [[nodiscard]] std::string ManagerLog() const { return ReadFile(Log("manager")); }

 private:
  std::filesystem::path state_;
};

}  // namespace depthfarm::system_test

#endif  // DEPTHFARM_TESTS_SYSTEM_MANAGED_CLUSTER_H_
