#include "coordinator/client/client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <stop_token>
#include <thread>

#include "common/transport/poller.h"
#include "common/transport/server_channel.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

using Answers = std::vector<v1::Envelope>;

// A coordinator that answers each question as the test says, on a thread of its own. Answers carry the question's
// request id unless they have one.
class FakeCoordinator {
 public:
  explicit FakeCoordinator(std::function<Answers(const v1::Envelope&)> answer) {
    Result<std::unique_ptr<ServerChannel>> bound = ServerChannel::Bind(context_, "ipc://*", {});
    if (!bound.ok()) return;
    endpoint_ = bound.value()->endpoint();
    thread_ = std::jthread([this, channel = std::move(bound).value(), answer = std::move(answer)](
                               const std::stop_token& stop) { Serve(*channel, answer, stop); });
  }
  ~FakeCoordinator() {
    thread_.request_stop();
    poller_.Wake();
  }
  FakeCoordinator(const FakeCoordinator&) = delete;
  FakeCoordinator& operator=(const FakeCoordinator&) = delete;

  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }

 private:
  void Serve(ServerChannel& channel, const std::function<Answers(const v1::Envelope&)>& answer,
             const std::stop_token& stop) {
    const std::array<const Channel*, 1> channels = {&channel};
    while (!stop.stop_requested()) {
      if (!poller_.Wait(channels, milliseconds(60'000)).ok()) return;
      while (true) {
        const Result<std::optional<PeerMessage>> message = channel.Receive();
        if (!message.ok() || !*message) break;
        const Result<v1::Envelope> question = ParseEnvelope((*message)->payload);
        if (!question.ok()) continue;
        for (v1::Envelope& envelope : answer(*question)) {
          if (envelope.request_id() == 0) envelope.set_request_id(question->request_id());
          (void)channel.Send((*message)->peer, SerializeEnvelope(envelope));
        }
      }
    }
  }

  TransportContext context_;
  Poller poller_;
  std::string endpoint_;
  std::jthread thread_;  // last: joined before what it uses goes
};

v1::Envelope JobStatusAnswer(std::uint64_t job_id) {
  v1::Envelope answer;
  answer.mutable_job_status()->set_job_id(job_id);
  return answer;
}

std::unique_ptr<Client> ClientOf(const FakeCoordinator& coordinator, ClientCallOptions options = {}) {
  if (options.timeout == ClientCallOptions().timeout) options.timeout = milliseconds(60'000);
  Result<std::unique_ptr<Client>> client =
      Client::Connect({.endpoint = coordinator.endpoint(), .keys_dir = ""}, std::move(options));
  EXPECT_TRUE(client.ok()) << client.status().message();
  return client.ok() ? std::move(client).value() : nullptr;
}

// What a coordinator that accepts every job receives.
v1::SubmitJob Submitted(const JobSubmission& submission) {
  std::promise<v1::SubmitJob> question_received;
  const FakeCoordinator coordinator([&](const v1::Envelope& question) {
    question_received.set_value(question.submit_job());
    v1::Envelope answer;
    answer.mutable_job_accepted()->set_job_id(42);
    return Answers{answer};
  });
  const Result<std::uint64_t> job_id = ClientOf(coordinator)->Submit(submission);
  EXPECT_TRUE(job_id.ok()) << job_id.status().message();
  if (!job_id.ok()) return {};
  EXPECT_EQ(*job_id, 42U);
  return question_received.get_future().get();
}

TEST(Client, SubmitsWhatItIsGivenAndReturnsTheJobId) {
  JobSubmission submission;
  submission.sequence.name = "ballet";
  submission.params.levels = 64;
  submission.output_dir = "/out";
  submission.name = "mine";
  submission.priority = -2;
  const v1::SubmitJob received = Submitted(submission);
  EXPECT_EQ(received.sequence().name(), "ballet");
  EXPECT_EQ(received.params().levels(), 64U);
  EXPECT_EQ(received.output_dir(), "/out");
  EXPECT_EQ(received.name(), "mine");
  EXPECT_EQ(received.priority(), -2);
}

TEST(Client, SubmitsViewsToRender) {
  JobSubmission submission;
  submission.sequence.file = "/in/ballet.json";
  submission.sequence.cameras.resize(3);
  VirtualPicture view;
  view.sources = {"cam0"};
  view.number = 7;
  submission.render.emplace();
  submission.render->source.depth_dir = "/depth";
  submission.render->views = {view};
  const v1::SubmitJob received = Submitted(submission);
  EXPECT_EQ(received.sequence().file(), "/in/ballet.json");
  EXPECT_EQ(received.sequence().cameras_size(), 0);  // the workers read them
  EXPECT_FALSE(received.has_params());
  EXPECT_EQ(received.render().source().depth_dir(), "/depth");
  ASSERT_EQ(received.render().views_size(), 1);
  EXPECT_EQ(received.render().views(0).number(), 7U);
}

TEST(Client, SkipsAnswersToOtherQuestions) {
  const FakeCoordinator coordinator([](const v1::Envelope& question) {
    v1::Envelope stale = JobStatusAnswer(1);
    stale.set_request_id(question.request_id() + 1000);
    return Answers{stale, JobStatusAnswer(question.get_job_status().job_id())};
  });
  const auto client = ClientOf(coordinator);
  for (const std::uint64_t job_id : {5, 6}) {
    const Result<v1::JobStatus> job = client->GetStatus(job_id);
    ASSERT_TRUE(job.ok()) << job.status().message();
    EXPECT_EQ(job->job_id(), job_id);
  }
}

TEST(Client, PassesOnWhatTheCoordinatorRefuses) {
  const FakeCoordinator coordinator([](const v1::Envelope&) {
    v1::Envelope answer;
    *answer.mutable_error() = ToProto(InvalidArgument("no job 77"));
    return Answers{answer};
  });
  const Status cancelled = ClientOf(coordinator)->Cancel(77);
  EXPECT_EQ(cancelled.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(cancelled.message(), HasSubstr("no job 77"));
}

TEST(Client, AnErrorInAnAnswerNeverLooksLikeSilence) {
  const FakeCoordinator coordinator([](const v1::Envelope&) {
    v1::Envelope answer;
    *answer.mutable_error() = ToProto(Unavailable("disk is full"));
    return Answers{answer};
  });
  const Status status = ClientOf(coordinator)->GetStatus(1).status();
  EXPECT_EQ(status.code(), ErrorCode::kInternal);
  EXPECT_THAT(status.message(), HasSubstr("disk is full"));
}

TEST(Client, AnAnswerOfAnotherKindIsCorrupt) {
  const FakeCoordinator coordinator([](const v1::Envelope&) { return Answers{JobStatusAnswer(1)}; });
  EXPECT_EQ(ClientOf(coordinator)->ListWorkers().status().code(), ErrorCode::kCorrupt);
}

TEST(Client, SilenceIsUnavailableAndNamesTheAddress) {
  const FakeCoordinator coordinator([](const v1::Envelope&) { return Answers{}; });
  const Status status = ClientOf(coordinator, {.timeout = milliseconds(20), .stop = nullptr})->ListJobs().status();
  EXPECT_EQ(status.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr(coordinator.endpoint()));
}

TEST(Client, StopsWaitingWhenTold) {
  const FakeCoordinator coordinator([](const v1::Envelope&) { return Answers{}; });
  const auto client = ClientOf(coordinator, {.timeout = milliseconds(600'000), .stop = [] { return true; }});
  EXPECT_EQ(client->ListJobs().status().code(), ErrorCode::kCancelled);
}

TEST(Client, AnAnswerThatHasComeCountsAlsoWhenToldToStop) {
  std::atomic<bool> answered = false;
  const FakeCoordinator coordinator([&](const v1::Envelope&) {
    v1::Envelope answer;
    answer.mutable_done();
    answered = true;
    return Answers{answer};
  });
  const auto stop = [&] {
    while (!answered) std::this_thread::sleep_for(milliseconds(1));
    std::this_thread::sleep_for(milliseconds(500));  // until it has come: microseconds, if nothing else runs
    return true;
  };
  EXPECT_TRUE(ClientOf(coordinator, {.timeout = milliseconds(600'000), .stop = stop})->StopCoordinator().ok());
}

TEST(Client, ListsComeInTheOrderOfTheCoordinator) {
  const FakeCoordinator coordinator([](const v1::Envelope&) {
    v1::Envelope answer;
    for (const std::uint64_t id : {9, 3, 7}) answer.mutable_job_list()->add_jobs()->set_job_id(id);
    return Answers{answer};
  });
  const auto jobs = ClientOf(coordinator)->ListJobs();
  ASSERT_TRUE(jobs.ok());
  ASSERT_EQ(jobs->size(), 3U);
  EXPECT_EQ((*jobs)[0].job_id(), 9U);
  EXPECT_EQ((*jobs)[2].job_id(), 7U);
}

TEST(Client, ReadsAllPagesOfTheJobs) {
  const FakeCoordinator coordinator([](const v1::Envelope& question) {
    const v1::ListJobs& ask = question.list_jobs();
    EXPECT_GT(ask.max_jobs(), 0U);
    v1::Envelope answer;
    answer.mutable_job_list()->add_jobs()->set_job_id(ask.after() + 1);
    answer.mutable_job_list()->add_jobs()->set_job_id(ask.after() + 2);
    if (ask.after() < 4) answer.mutable_job_list()->set_next(ask.after() + 2);
    return Answers{answer};
  });
  const auto jobs = ClientOf(coordinator)->ListJobs();
  ASSERT_TRUE(jobs.ok()) << jobs.status().message();
  ASSERT_EQ(jobs->size(), 6U);
  for (std::size_t i = 0; i < jobs->size(); ++i) EXPECT_EQ((*jobs)[i].job_id(), i + 1);
}

TEST(Client, PagesThatGoRoundAreCorrupt) {
  const FakeCoordinator coordinator([](const v1::Envelope&) {
    v1::Envelope answer;
    answer.mutable_job_list()->set_next(3);
    return Answers{answer};
  });
  EXPECT_EQ(ClientOf(coordinator)->ListJobs().status().code(), ErrorCode::kCorrupt);
}

TEST(Client, RefusesTcpWithoutKeysAndBadEndpoints) {
  const auto code = [](const CoordinatorTarget& target) { return Client::Connect(target).status().code(); };
  EXPECT_EQ(code({.endpoint = "tcp://127.0.0.1:7700", .keys_dir = ""}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.endpoint = "tcp://192.0.2.1:7700", .keys_dir = "", .insecure = true}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.endpoint = "head:7700", .keys_dir = ""}), ErrorCode::kInvalidArgument);
  EXPECT_EQ(code({.endpoint = "tcp://127.0.0.1:7700", .keys_dir = "/nonexistent"}), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
