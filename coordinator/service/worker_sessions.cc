#include "coordinator/service/worker_sessions.h"

#include <utility>

namespace depthfarm {

Result<WorkerId> WorkerSessions::Join(WorkerSession hello) {
  const auto same_name = by_name_.find(hello.name);
  if (same_name != by_name_.end() && sessions_.at(same_name->second).user_id != hello.user_id) {
    return InvalidArgument("worker name '" + hello.name + "' is in use by another user of the farm");
  }
  // A peer is one worker: an earlier name of it is gone.
  const auto same_peer = by_peer_.find(hello.peer);
  if (same_peer != by_peer_.end() && sessions_.at(same_peer->second).name != hello.name) Remove(same_peer->second);

  const WorkerId id = same_name != by_name_.end() ? same_name->second : WorkerId(++last_id_);
  if (const WorkerSession* known = Find(id)) by_peer_.erase(known->peer);
  hello.id = id;
  by_peer_[hello.peer] = id;
  by_name_[hello.name] = id;
  sessions_[id] = std::move(hello);
  return id;
}

void WorkerSessions::Remove(WorkerId id) {
  const auto session = sessions_.find(id);
  if (session == sessions_.end()) return;
  by_peer_.erase(session->second.peer);
  by_name_.erase(session->second.name);
  sessions_.erase(session);
}

void WorkerSessions::SetUser(WorkerId id, const std::string& user_id) {
  const auto session = sessions_.find(id);
  if (session != sessions_.end()) session->second.user_id = user_id;
}

const WorkerSession* WorkerSessions::Find(WorkerId id) const {
  const auto session = sessions_.find(id);
  return session == sessions_.end() ? nullptr : &session->second;
}

const WorkerSession* WorkerSessions::FindName(const std::string& name) const {
  const auto id = by_name_.find(name);
  return id == by_name_.end() ? nullptr : Find(id->second);
}

const WorkerSession* WorkerSessions::FindPeer(const std::string& peer) const {
  const auto id = by_peer_.find(peer);
  return id == by_peer_.end() ? nullptr : Find(id->second);
}

}  // namespace depthfarm
