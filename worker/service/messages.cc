#include "worker/service/messages.h"

#include "common/wire/task_wire.h"

namespace depthfarm {

v1::Envelope HelloMessage(const WorkerIdentity& identity, const std::vector<ArtifactInfo>& artifacts,
                          const std::vector<LeaseId>& running) {
  v1::Envelope message;
  v1::WorkerHello& hello = *message.mutable_worker_hello();
  hello.set_name(identity.name);
  hello.set_algorithm_version(kAlgorithmVersion);
  hello.set_software_version(identity.software_version);
  hello.set_process(identity.process);
  hello.set_memory_bytes(identity.memory_bytes);
  for (const std::string& tag : identity.tags) hello.add_tags(tag);
  hello.set_slots(static_cast<std::uint32_t>(identity.slots));
  hello.set_tasks_ahead(static_cast<std::uint32_t>(identity.ahead));
  hello.set_artifact_endpoint(identity.artifacts.endpoint);
  hello.set_artifact_public_key(identity.artifacts.public_key);
  for (const ArtifactInfo& artifact : artifacts) *hello.add_artifacts() = ToProto(artifact);
  for (const LeaseId lease : running) hello.add_running_leases(lease.value());
  return message;
}

v1::Envelope AskMessage(std::uint64_t ask_id, const std::vector<LeaseId>& running) {
  v1::Envelope message;
  message.mutable_ask_for_task()->set_ask_id(ask_id);
  for (const LeaseId lease : running) message.mutable_ask_for_task()->add_running_leases(lease.value());
  return message;
}

v1::Envelope HeartbeatMessage(std::uint64_t heartbeat_id, const std::vector<LeaseId>& running) {
  v1::Envelope message;
  message.mutable_heartbeat()->set_heartbeat_id(heartbeat_id);
  for (const LeaseId lease : running) message.mutable_heartbeat()->add_running_leases(lease.value());
  return message;
}

v1::Envelope FinishedMessage(const LeasedOutcome& leased) {
  const TaskOutcome& outcome = leased.outcome;
  v1::Envelope message = FailedMessage(leased.lease, ToProto(leased.task), outcome.status);
  v1::TaskFinished& finished = *message.mutable_task_finished();
  *finished.mutable_stats() = ToProto(outcome.stats);
  if (!outcome.log.lines.empty()) *finished.mutable_log() = ToProto(outcome.log);
  for (const ArtifactKey& key : outcome.missing_inputs) finished.add_missing_inputs(DigestBytes(key));
  if (!outcome.status.ok()) return message;
  if (outcome.output_key.has_value()) finished.set_output_key(DigestBytes(*outcome.output_key));
  if (outcome.artifact.has_value()) *finished.mutable_artifact() = ToProto(*outcome.artifact);
  if (outcome.picture_digest.has_value()) finished.set_picture_digest(DigestBytes(*outcome.picture_digest));
  for (const OutputFile& file : outcome.files) *finished.add_files() = ToProto(file);
  return message;
}

v1::Envelope FailedMessage(LeaseId lease, const v1::TaskId& task, const Status& status) {
  v1::Envelope message;
  v1::TaskFinished& finished = *message.mutable_task_finished();
  finished.set_lease_id(lease.value());
  *finished.mutable_task() = task;
  *finished.mutable_error() = ToProto(status);
  return message;
}

v1::Envelope DroppedMessage(const std::vector<ArtifactKey>& keys) {
  v1::Envelope message;
  for (const ArtifactKey& key : keys) message.mutable_artifacts_dropped()->add_keys(DigestBytes(key));
  return message;
}

v1::Envelope GoodbyeMessage() {
  v1::Envelope message;
  message.mutable_worker_goodbye();
  return message;
}

v1::Envelope DiedMessage(const std::string& name, std::uint64_t process, const std::string& how,
                         const TaskLog& last_words, const std::vector<LeaseId>& computing) {
  v1::Envelope message;
  v1::WorkerDied& died = *message.mutable_worker_died();
  died.set_name(name);
  died.set_process(process);
  died.set_how(how);
  *died.mutable_last_words() = ToProto(last_words);
  for (const LeaseId lease : computing) died.add_computing(lease.value());
  return message;
}

namespace {

Result<std::vector<ArtifactKey>> KeysFromProto(const char* field,
                                               const google::protobuf::RepeatedPtrField<std::string>& all) {
  std::vector<ArtifactKey> keys;
  for (const std::string& bytes : all) {
    DEPTHFARM_ASSIGN_OR_RETURN(const ArtifactKey key, DigestFromBytes(field, bytes));
    keys.push_back(key);
  }
  return keys;
}

}  // namespace

Result<std::vector<ArtifactKey>> KeysOf(const v1::ReleaseArtifacts& release) {
  return KeysFromProto("release_artifacts.keys", release.keys());
}

Result<std::vector<ArtifactKey>> KeysOf(const v1::KeepArtifacts& keep) {
  return KeysFromProto("keep_artifacts.keys", keep.keys());
}

}  // namespace depthfarm
