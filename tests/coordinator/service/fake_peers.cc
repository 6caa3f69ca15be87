#include "tests/coordinator/service/fake_peers.h"

#include <gtest/gtest.h>

#include <chrono>
#include <utility>

#include "common/digest/sha256.h"
#include "common/sequence/depth_manifest.h"
#include "common/wire/job_wire.h"
#include "common/wire/sequence_wire.h"
#include "common/wire/task_wire.h"
#include "tests/coordinator/service/small_sequence.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kPatience{10'000};
constexpr std::chrono::milliseconds kRefusal{200};

}  // namespace

FakePeer::FakePeer(TransportContext& context, const std::string& endpoint, const ClientOptions& options)
    : channel_(ClientChannel::Connect(context, endpoint, options).value()) {}

void FakePeer::Send(const v1::Envelope& envelope) {
  v1::Envelope versioned = envelope;
  versioned.set_protocol_version(kProtocolVersion);
  versioned.set_protocol_minor(minor);
  SendBytes(versioned.SerializeAsString());
}

void FakePeer::SendBytes(const std::string& bytes) { EXPECT_TRUE(channel_->Send(bytes).ok()); }

v1::Envelope FakePeer::Receive() {
  const std::optional<std::string> bytes = channel_->Receive(kPatience).value();
  if (!bytes) {
    ADD_FAILURE() << "no message came";
    return {};
  }
  return ParseEnvelope(*bytes).value();
}

std::optional<v1::Envelope> FakePeer::TryReceive() {
  const std::optional<std::string> bytes = channel_->Receive(kRefusal).value();
  return bytes ? std::optional(ParseEnvelope(*bytes).value()) : std::nullopt;
}

v1::Envelope FakePeer::Await(v1::Envelope::BodyCase kind) {
  for (;;) {
    v1::Envelope envelope = Receive();
    if (envelope.body_case() == kind || envelope.body_case() == v1::Envelope::BODY_NOT_SET) return envelope;
  }
}

v1::Envelope FakePeer::Call(const v1::Envelope& request) {
  Send(request);
  return Receive();
}

FakeFarmWorker::FakeFarmWorker(TransportContext& context, const std::string& endpoint, std::string name,
                               const ClientOptions& options)
    : peer(context, endpoint, options), name_(std::move(name)) {}

void FakeFarmWorker::Hello() {
  v1::Envelope envelope;
  v1::WorkerHello* hello = envelope.mutable_worker_hello();
  hello->set_name(name_);
  hello->set_algorithm_version(kAlgorithmVersion);
  hello->set_software_version("test");
  hello->set_artifact_endpoint("ipc:///nowhere/" + name_);
  peer.Send(envelope);
}

void FakeFarmWorker::Ask() {
  v1::Envelope envelope;
  envelope.mutable_ask_for_task()->set_ask_id(++asks);
  peer.Send(envelope);
}

void FakeFarmWorker::Report(const v1::GrantTask& grant) {
  const TaskSpec spec = FromProto(grant.task()).value();
  v1::Envelope envelope;
  v1::TaskFinished* finished = envelope.mutable_task_finished();
  finished->set_lease_id(grant.lease_id());
  *finished->mutable_task() = grant.task().id();
  const auto made = [&](const ArtifactKey& key) {
    finished->set_output_key(DigestBytes(key));
    *finished->mutable_artifact() = ToProto(ArtifactInfo{key, 100, Sha256(DigestBytes(key))});
  };
  if (spec.id.kind == TaskKind::kAnalyse) {
    made(Sha256(spec.picture));
    finished->set_picture_digest(DigestBytes(Sha256("picture " + spec.picture)));
  }
  if (spec.output_key) made(*spec.output_key);
  if (spec.id.kind == TaskKind::kEmit) {
    for (const TaskInput& input : spec.inputs) {
      EXPECT_FALSE(input.locations.empty());
      if (input.role != InputRole::kRefined) continue;
      const std::string path = DepthFileName("cam" + std::to_string(input.view), spec.id.frame);
      *finished->add_files() = ToProto(OutputFile{path, Sha256(path), 10});
    }
  }
  finished->mutable_stats()->set_cpu_seconds(0.5);
  peer.Send(envelope);
}

int FakeFarmWorker::WorkUntilJobEnds() {
  for (int tasks = 0;;) {
    const v1::Envelope envelope = peer.Receive();
    if (envelope.has_job_ended() || envelope.body_case() == v1::Envelope::BODY_NOT_SET) return tasks;
    if (!envelope.has_grant_task()) continue;
    EXPECT_EQ(envelope.grant_task().has_job(), tasks == 0);
    if (envelope.grant_task().has_job()) {
      EXPECT_TRUE(FromProto(envelope.grant_task().job()).ok());
    }
    Report(envelope.grant_task());
    Ask();
    ++tasks;
  }
}

RunningCoordinator::RunningCoordinator(const CoordinatorOptions& options) {
  Result<std::unique_ptr<CoordinatorServer>> coordinator = CoordinatorServer::Create(options);
  EXPECT_TRUE(coordinator.ok()) << coordinator.status().message();
  coordinator_ = std::move(coordinator).value();
  thread_ = std::thread([this] { EXPECT_TRUE(coordinator_->Run().ok()); });
}

RunningCoordinator::~RunningCoordinator() {
  coordinator_->Stop();
  if (thread_.joinable()) thread_.join();
}

v1::Envelope SubmitRequest(int frames, const std::string& output_dir) {
  EstimationParams params;
  params.gop = 2;
  params.levels = 16;
  params.level_blocks = 2;
  params.refine_rounds = 1;
  v1::Envelope envelope;
  envelope.set_request_id(1);
  *envelope.mutable_submit_job()->mutable_sequence() = ToProto(SmallSequence(3, frames));
  *envelope.mutable_submit_job()->mutable_params() = ToProto(params);
  envelope.mutable_submit_job()->set_output_dir(output_dir);
  envelope.mutable_submit_job()->set_name("small");
  return envelope;
}

v1::Envelope StatusRequest(std::uint64_t job) {
  v1::Envelope envelope;
  envelope.set_request_id(77);
  envelope.mutable_get_job_status()->set_job_id(job);
  return envelope;
}

}  // namespace depthfarm
