#ifndef DEPTHFARM_COORDINATOR_CLUSTERS_CLUSTER_FOLDER_H_
#define DEPTHFARM_COORDINATOR_CLUSTERS_CLUSTER_FOLDER_H_

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "common/base/status.h"
#include "coordinator/clusters/cluster_options.h"

namespace depthfarm {

// What there is to know about a cluster that is up.
struct ClusterRecord {
  ClusterOptions options;
  std::string coordinator;   // endpoint, as workers and clients reach it
  std::string keys_dir;      // empty: no CURVE
  std::string instance;      // its name and a part that no other one has: of its pilots with engine and coordinator
  std::string manager_host;  // where it is managed
  int manager_pid = 0;
  std::string started;  // UTC, ISO 8601
};

// The state folder of a cluster (0700): options.json (what a manager is to do), cluster.json (the record while it is
// up), keys/, log/, coordinator.sqlite, `down` (asked to end), `lock` (held by its manager).
class ClusterFolder {
 public:
  // $XDG_STATE_HOME or ~/.local/state, then depthfarm/clusters/NAME. kInvalidArgument: neither is set.
  [[nodiscard]] static Result<std::string> DefaultPath(const std::string& name);

  // Makes the folder if need be. kInvalidArgument: others may enter it; kUnavailable: it cannot be made.
  [[nodiscard]] static Result<ClusterFolder> Make(const std::filesystem::path& path);
  // kInvalidArgument: there is no such cluster.
  [[nodiscard]] static Result<ClusterFolder> Open(const std::filesystem::path& path);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path keys() const { return path_ / "keys"; }
  [[nodiscard]] std::filesystem::path logs() const { return path_ / "log"; }
  [[nodiscard]] std::filesystem::path journal() const { return path_ / "coordinator.sqlite"; }
  [[nodiscard]] std::filesystem::path manager_log() const { return logs() / "manager.log"; }

  [[nodiscard]] Status WriteOptions(const ClusterOptions& options) const;
  [[nodiscard]] Result<ClusterOptions> ReadOptions() const;

  // Nothing: it is not up.
  [[nodiscard]] Result<std::optional<ClusterRecord>> ReadRecord() const;
  [[nodiscard]] Status WriteRecord(const ClusterRecord& record) const;
  void RemoveRecord() const;

  // Held as long as the object lives.
  class Lock {
   public:
    explicit Lock(int descriptor) : descriptor_(descriptor) {}
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;
    ~Lock();

   private:
    int descriptor_;
  };
  // Null: somebody else manages the cluster.
  [[nodiscard]] Result<std::unique_ptr<Lock>> TryLock() const;

  // Has the manager end the cluster.
  [[nodiscard]] Status AskDown() const;
  [[nodiscard]] bool AskedDown() const;
  void ForgetDown() const;

 private:
  explicit ClusterFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::filesystem::path path_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLUSTERS_CLUSTER_FOLDER_H_
