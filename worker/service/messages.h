#ifndef DEPTHFARM_WORKER_SERVICE_MESSAGES_H_
#define DEPTHFARM_WORKER_SERVICE_MESSAGES_H_

#include <cstdint>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "common/wire/envelope.h"
#include "worker/service/compute_pool.h"

namespace depthfarm {

// What a worker tells of itself when it joins.
struct WorkerIdentity {
  std::string name;
  std::string software_version;
  std::uint64_t memory_bytes = 0;
  int slots = 1;
  int ahead = 0;
  std::vector<std::string> tags;
  ArtifactLocation artifacts;  // where its artifact server can be reached
  std::uint64_t process = 0;   // that no other process of this name has
};

// Worker -> coordinator.
[[nodiscard]] v1::Envelope HelloMessage(const WorkerIdentity& identity, const std::vector<ArtifactInfo>& artifacts,
                                        const std::vector<LeaseId>& running);
[[nodiscard]] v1::Envelope AskMessage(std::uint64_t ask_id, const std::vector<LeaseId>& running);
[[nodiscard]] v1::Envelope HeartbeatMessage(std::uint64_t heartbeat_id, const std::vector<LeaseId>& running);
[[nodiscard]] v1::Envelope FinishedMessage(const LeasedOutcome& finished);
[[nodiscard]] v1::Envelope FailedMessage(LeaseId lease, const v1::TaskId& task, const Status& status);
[[nodiscard]] v1::Envelope DroppedMessage(const std::vector<ArtifactKey>& keys);
[[nodiscard]] v1::Envelope GoodbyeMessage();
// Of the process of a worker; `how` continues "the worker ".
[[nodiscard]] v1::Envelope DiedMessage(const std::string& name, std::uint64_t process, const std::string& how,
                                       const TaskLog& last_words, const std::vector<LeaseId>& computing);

// Coordinator -> worker: 32-byte keys; others are an error.
[[nodiscard]] Result<std::vector<ArtifactKey>> KeysOf(const v1::ReleaseArtifacts& release);
[[nodiscard]] Result<std::vector<ArtifactKey>> KeysOf(const v1::KeepArtifacts& keep);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SERVICE_MESSAGES_H_
