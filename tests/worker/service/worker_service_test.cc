#include "worker/service/worker_service.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <thread>

#include "common/digest/sha256.h"
#include "common/transport/server_channel.h"
#include "common/wire/job_wire.h"
#include "common/wire/task_wire.h"
#include "tests/worker/execution/small_job.h"

namespace depthfarm {
namespace {

constexpr std::chrono::milliseconds kPatience{60000};  // only a failing test waits so long

// A coordinator played by the test, and a worker in a thread.
class WorkerServiceTest : public testing::Test {
 protected:
  void SetUp() override {
    const std::string endpoint = "ipc://" + (folder_.path() / "coordinator").string();
    channel_ = ServerChannel::Bind(context_, endpoint, {}).value();
    WorkerOptions options;
    options.coordinator = endpoint;
    options.cache_dir = folder_.path() / "cache";
    options.name = "w1";
    options.software_version = "0";
    options.give_up = kPatience;
    service_ = WorkerService::Create(options).value();
    thread_ = std::thread([this] { status_ = service_->Run(); });
  }
  void TearDown() override {
    service_->Stop();
    if (thread_.joinable()) thread_.join();
  }

  void Send(v1::Envelope message) { ASSERT_TRUE(channel_->Send(peer_, SerializeEnvelope(std::move(message))).ok()); }

  // The next message of a kind; heartbeats are answered and asks noted on the way.
  v1::Envelope Await(v1::Envelope::BodyCase kind) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    const Channel* const channels[] = {channel_.get()};
    while (std::chrono::steady_clock::now() < deadline) {
      const Result<std::optional<PeerMessage>> message = channel_->Receive();
      if (!message.ok() || !message->has_value()) {
        EXPECT_TRUE(poller_.Wait(channels, std::chrono::milliseconds(1000)).ok());
        continue;
      }
      peer_ = (*message)->peer;
      v1::Envelope received = ParseEnvelope((*message)->payload).value();
      if (received.has_ask_for_task()) ask_ = received.ask_for_task().ask_id();
      if (received.has_heartbeat()) {
        v1::Envelope ack;
        ack.mutable_heartbeat_ack()->set_heartbeat_id(received.heartbeat().heartbeat_id());
        Send(ack);
      }
      if (received.body_case() == kind) return received;
    }
    ADD_FAILURE() << "no message of kind " << kind;
    return {};
  }

  void Welcome() {
    EXPECT_EQ(Await(v1::Envelope::kWorkerHello).worker_hello().name(), "w1");
    SendWelcome();
  }
  void SendWelcome() {
    v1::Envelope welcome;
    welcome.mutable_worker_welcome()->set_worker_id(1);
    welcome.mutable_worker_welcome()->set_heartbeat_ms(100);
    welcome.mutable_worker_welcome()->set_lease_ms(60000);
    Send(welcome);
    Await(v1::Envelope::kAskForTask);
  }

  void Grant(std::uint64_t lease, const TaskSpec& spec, bool with_job) {
    v1::Envelope grant;
    grant.mutable_grant_task()->set_lease_id(lease);
    grant.mutable_grant_task()->set_ask_id(ask_);
    grant.mutable_grant_task()->set_attempt(1);
    grant.mutable_grant_task()->set_claim(job_.config.claim);
    *grant.mutable_grant_task()->mutable_task() = ToProto(spec);
    if (with_job) *grant.mutable_grant_task()->mutable_job() = ToProto(job_.config);
    Send(grant);
  }

  void StopWorker() {
    v1::Envelope stop;
    stop.mutable_stop_worker();
    Send(stop);
    Await(v1::Envelope::kWorkerGoodbye);
    thread_.join();
  }

  SmallJob job_;
  testing_support::TemporaryFolder folder_;
  TransportContext context_;
  std::unique_ptr<ServerChannel> channel_;
  Poller poller_;
  std::string peer_;
  std::uint64_t ask_ = 0;
  std::unique_ptr<WorkerService> service_;
  Status status_;
  std::thread thread_;
};

TEST_F(WorkerServiceTest, TakesATaskReportsItAndLeavesWhenTold) {
  Welcome();
  Grant(11, job_.Simple(TaskKind::kPrepare), true);
  const v1::TaskFinished prepared = Await(v1::Envelope::kTaskFinished).task_finished();
  EXPECT_EQ(prepared.lease_id(), 11);
  EXPECT_EQ(prepared.error().code(), v1::CODE_OK) << prepared.error().message();
  EXPECT_TRUE(std::filesystem::exists(job_.output()));

  Await(v1::Envelope::kAskForTask);
  Grant(12, job_.Analyse(0, 1), false);  // the worker knows the job by now
  const v1::TaskFinished analysed = Await(v1::Envelope::kTaskFinished).task_finished();
  EXPECT_EQ(analysed.error().code(), v1::CODE_OK) << analysed.error().message();
  EXPECT_EQ(analysed.artifact().key(), analysed.output_key());
  EXPECT_GT(analysed.stats().segments(), 0);
  StopWorker();
  EXPECT_TRUE(status_.ok()) << status_.message();
}

TEST_F(WorkerServiceTest, ServesWhatItMade) {
  const std::string artifacts = Await(v1::Envelope::kWorkerHello).worker_hello().artifact_endpoint();
  SendWelcome();
  Grant(11, job_.Analyse(0, 0), true);
  const v1::TaskFinished finished = Await(v1::Envelope::kTaskFinished).task_finished();
  const ArtifactInfo artifact = FromProto(finished.artifact()).value();
  ArtifactClient client(context_, {}, {});
  const std::vector<ArtifactLocation> locations{{artifacts, ""}};
  const Result<std::string> fetched = client.Fetch(artifact, locations, {});
  ASSERT_TRUE(fetched.ok()) << fetched.status().message();
  EXPECT_EQ(fetched->size(), artifact.stored_bytes);
}

TEST_F(WorkerServiceTest, GivesBackATaskOfAJobItDoesNotKnow) {
  Welcome();
  Grant(11, job_.Analyse(0, 0), false);
  const v1::Error error = Await(v1::Envelope::kTaskFinished).task_finished().error();
  EXPECT_EQ(error.code(), v1::CODE_LEASE_EXPIRED);  // nobody's failure
  EXPECT_THAT(error.message(), testing::HasSubstr("never told of this run of the job"));
}

TEST_F(WorkerServiceTest, GivesBackATaskOfARunOfWhichItKnowsAnEarlierOneAlone) {
  Welcome();
  job_.config.claim = 1;
  Grant(11, job_.Analyse(0, 0), true);
  EXPECT_EQ(Await(v1::Envelope::kTaskFinished).task_finished().error().code(), v1::CODE_OK);
  ask_ = Await(v1::Envelope::kAskForTask).ask_for_task().ask_id();
  job_.config.claim = 2;
  Grant(12, job_.Analyse(0, 1), false);
  const v1::Error error = Await(v1::Envelope::kTaskFinished).task_finished().error();
  EXPECT_EQ(error.code(), v1::CODE_LEASE_EXPIRED);
  EXPECT_THAT(error.message(), testing::HasSubstr("never told of this run of the job"));
}

TEST_F(WorkerServiceTest, AnswersAStaleGrantWithLeaseExpired) {
  Welcome();
  ask_ += 100;
  Grant(11, job_.Analyse(0, 0), true);
  EXPECT_EQ(Await(v1::Envelope::kTaskFinished).task_finished().error().code(), v1::CODE_LEASE_EXPIRED);
}

TEST_F(WorkerServiceTest, GivesBackATaskThatHasNotBegunAndNoOther) {
  Welcome();
  // Its picture is at a server that does not answer: the slot is busy with it for longer than this test.
  const auto pictures = ServerChannel::Bind(context_, "ipc://" + (folder_.path() / "pictures").string(), {}).value();
  TaskSpec first = job_.Analyse(0, 0);
  first.uploads.emplace();
  first.uploads->files.picture = {{Sha256("the picture"), 11}, Sha256("its tree")};
  first.uploads->from.endpoint = pictures->endpoint();
  Grant(11, first, true);
  const Channel* const channels[] = {pictures.get()};
  const Result<std::optional<PeerMessage>> request = [&] {
    EXPECT_TRUE(poller_.Wait(channels, kPatience).ok());
    return pictures->Receive();
  }();
  ASSERT_TRUE(request.ok() && request->has_value()) << "the task has begun";
  Await(v1::Envelope::kAskForTask);
  Grant(12, job_.Analyse(0, 1), false);
  for (const std::uint64_t lease : {11, 12}) {
    v1::Envelope give_back;
    give_back.mutable_give_back_task()->set_lease_id(lease);
    Send(give_back);
  }
  const v1::TaskFinished given_back = Await(v1::Envelope::kTaskFinished).task_finished();
  EXPECT_EQ(given_back.lease_id(), 12);
  EXPECT_EQ(given_back.error().code(), v1::CODE_CANCELLED);
  const v1::AskForTask ask = Await(v1::Envelope::kAskForTask).ask_for_task();
  EXPECT_THAT(ask.running_leases(), testing::ElementsAre(11)) << "that one goes on";
  StopWorker();
}

// A coordinator of the next minor version may send what this worker does not know.
TEST_F(WorkerServiceTest, PassesOverMessagesThatItDoesNotKnow) {
  Welcome();
  v1::Envelope unknown;
  unknown.GetReflection()->MutableUnknownFields(&unknown)->AddLengthDelimited(4000, "new");
  Send(unknown);
  Grant(11, job_.Simple(TaskKind::kPrepare), true);
  EXPECT_EQ(Await(v1::Envelope::kTaskFinished).task_finished().error().code(), v1::CODE_OK);
  StopWorker();
}

TEST_F(WorkerServiceTest, EndsWithAnErrorWhenItsVersionIsRefused) {
  Await(v1::Envelope::kWorkerHello);
  v1::Envelope refusal;
  *refusal.mutable_error() = ToProto(Status(ErrorCode::kIncompatible, "algorithm version 2 here"));
  Send(refusal);
  thread_.join();
  EXPECT_EQ(status_.code(), ErrorCode::kIncompatible);
}

}  // namespace
}  // namespace depthfarm
