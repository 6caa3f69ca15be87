#ifndef DEPTHFARM_COORDINATOR_SERVICE_WORKER_SESSIONS_H_
#define DEPTHFARM_COORDINATOR_SERVICE_WORKER_SESSIONS_H_

#include <cstdint>
#include <map>
#include <string>

#include "common/base/status.h"
#include "common/job/task_spec.h"

namespace depthfarm {

// How to reach a worker that said Hello.
struct WorkerSession {
  WorkerId id;
  std::string peer;     // of the newest Hello: a worker that reconnects is a new peer
  std::string key;      // public one with which it came; empty without CURVE
  std::string user_id;  // whose key that is
  std::string name;
  std::string software_version;
  ArtifactLocation artifacts;
  std::uint64_t process = 0;  // 0: not told
};

// The workers of the farm by id, by peer and by name.
class WorkerSessions {
 public:
  // A new worker, or the one of that name under a new peer. `hello.id` is ignored.
  // kInvalidArgument: the name is in use by another user.
  [[nodiscard]] Result<WorkerId> Join(WorkerSession hello);
  void Remove(WorkerId id);
  // Its key is that user's now.
  void SetUser(WorkerId id, const std::string& user_id);

  // Null when unknown.
  [[nodiscard]] const WorkerSession* Find(WorkerId id) const;
  [[nodiscard]] const WorkerSession* FindName(const std::string& name) const;
  [[nodiscard]] const WorkerSession* FindPeer(const std::string& peer) const;
  [[nodiscard]] const std::map<WorkerId, WorkerSession>& all() const { return sessions_; }

 private:
  std::map<WorkerId, WorkerSession> sessions_;
  std::map<std::string, WorkerId> by_peer_;
  std::map<std::string, WorkerId> by_name_;
  std::uint64_t last_id_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_SERVICE_WORKER_SESSIONS_H_
