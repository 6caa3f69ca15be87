// What is told of a task that failed its job, on a virtual clock and without a socket.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/job/estimation_params.h"
#include "common/wire/task_wire.h"
#include "coordinator/service/coordinator.h"
#include "tests/coordinator/service/fake_peers.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Quarantine : public testing::Test {
 protected:
  void SetUp() override {
    options_.max_attempts = 2;
    Start();
  }
  // Another coordinator, on the same journal.
  void Start() {
    coordinator_.reset();
    coordinator_ = std::make_unique<Coordinator>(options_, ++lives_ * 1'000'000,
                                                 Journal::Open((folder_.path() / "journal").string()).value(), false);
    ASSERT_TRUE(coordinator_->Restore(now_).ok());
  }
  // The last message that the peer gets for this one; empty if there is none.
  v1::Envelope Send(const std::string& peer, v1::Envelope message, const std::string& user = "") {
    coordinator_->Handle({peer, user, SerializeEnvelope(std::move(message))}, now_);
    v1::Envelope last;
    for (OutgoingMessage& answer : coordinator_->TakeOutgoing()) {
      if (answer.peer == peer) last = std::move(answer.envelope);
    }
    return last;
  }
  void Hello(std::uint64_t process) {
    v1::Envelope hello;
    hello.mutable_worker_hello()->set_name("w1");
    hello.mutable_worker_hello()->set_algorithm_version(kAlgorithmVersion);
    hello.mutable_worker_hello()->set_artifact_endpoint("ipc:///nowhere/w1");
    hello.mutable_worker_hello()->set_process(process);
    (void)Send("w1", hello);
  }
  // Whoever minds that process tells how it ended.
  void Die(std::uint64_t process, const std::string& how, const std::vector<std::string>& lines,
           const std::string& user = "") {
    v1::Envelope message;
    message.mutable_worker_died()->set_name("w1");
    message.mutable_worker_died()->set_process(process);
    message.mutable_worker_died()->set_how(how);
    for (const std::string& line : lines) message.mutable_worker_died()->mutable_last_words()->add_lines(line);
    EXPECT_FALSE(Send("who minds w1", message, user).has_error());
  }
  v1::GrantTask Ask() {
    v1::Envelope ask;
    ask.mutable_ask_for_task()->set_ask_id(++asks_);
    return Send("w1", ask).grant_task();
  }
  void Finish(const v1::GrantTask& grant, v1::Code code, const std::vector<std::string>& lines = {}) {
    v1::Envelope message;
    v1::TaskFinished& finished = *message.mutable_task_finished();
    finished.set_lease_id(grant.lease_id());
    *finished.mutable_task() = grant.task().id();
    finished.mutable_error()->set_code(code);
    if (code != v1::CODE_OK) finished.mutable_error()->set_message("no space left on the device");
    for (const std::string& line : lines) finished.mutable_log()->add_lines(line);
    (void)Send("w1", message);
  }
  v1::JobStatus Status() { return Send("client", StatusRequest(1)).job_status(); }
  // A job whose Prepare kills its worker and then fails.
  void FailAJob() {
    ASSERT_TRUE(Send("client", SubmitRequest(1, "/out")).has_job_accepted());
    Hello(1);
    ASSERT_EQ(Ask().task().id().kind(), v1::TASK_KIND_PREPARE);
    Hello(2);
    const v1::GrantTask second = Ask();
    ASSERT_EQ(second.task().id().kind(), v1::TASK_KIND_PREPARE);
    EXPECT_EQ(second.attempt(), 2U);
    Finish(second, v1::CODE_UNAVAILABLE, std::vector<std::string>(40, std::string(100, 'x')));
    const v1::GrantTask cleanup = Ask();
    ASSERT_EQ(cleanup.task().id().kind(), v1::TASK_KIND_CLEANUP);
    Finish(cleanup, v1::CODE_OK);
  }

  const testing_support::TemporaryFolder folder_;
  CoordinatorOptions options_;
  std::unique_ptr<Coordinator> coordinator_;
  TimePoint now_{std::chrono::hours(1)};
  std::uint64_t lives_ = 0;
  std::uint64_t asks_ = 0;
};

void ExpectBothAttempts(const v1::JobStatus& status) {
  EXPECT_EQ(status.state(), v1::JOB_STATE_FAILED);
  EXPECT_EQ(status.failed_task().kind(), v1::TASK_KIND_PREPARE);
  ASSERT_EQ(status.failed_attempts_size(), 2);
  EXPECT_EQ(status.failed_attempts(0).outcome(), v1::ATTEMPT_OUTCOME_WORKER_LOST);
  EXPECT_EQ(status.failed_attempts(0).worker(), "w1");
  EXPECT_THAT(status.failed_attempts(0).error().message(), HasSubstr("died and was started again"));
  EXPECT_EQ(status.failed_attempts(1).outcome(), v1::ATTEMPT_OUTCOME_FAILED);
  EXPECT_EQ(status.failed_attempts(1).error().message(), "no space left on the device");
  EXPECT_EQ(status.failed_attempts(1).log().lines_size(), 20) << "the last 2 KiB";
  EXPECT_EQ(status.failed_attempts(1).log().left_out(), 20U);
}

TEST_F(Quarantine, NamesTheTaskAndHowItsAttemptsFailed) {
  FailAJob();
  ExpectBothAttempts(Status());
}

TEST_F(Quarantine, IsRememberedByTheNextCoordinator) {
  FailAJob();
  Start();
  ExpectBothAttempts(Status());
}

TEST_F(Quarantine, ListsOfJobsNameTheTaskOnly) {
  FailAJob();
  v1::Envelope request;
  request.mutable_list_jobs();
  const v1::Envelope list = Send("client", request);
  ASSERT_EQ(list.job_list().jobs_size(), 1);
  EXPECT_TRUE(list.job_list().jobs(0).has_failed_task());
  EXPECT_EQ(list.job_list().jobs(0).failed_attempts_size(), 0);
}

TEST_F(Quarantine, EndsWithRetry) {
  FailAJob();
  v1::Envelope retry;
  retry.mutable_retry_job()->set_job_id(1);
  ASSERT_TRUE(Send("client", retry).has_job_accepted());
  EXPECT_FALSE(Status().has_failed_task());
  const v1::GrantTask again = Ask();
  EXPECT_EQ(again.task().id().kind(), v1::TASK_KIND_PREPARE);
  EXPECT_EQ(again.attempt(), 1U);
}

// The whole of it is known when the job ends, so that the next coordinator knows it, too.
TEST_F(Quarantine, TellsHowWorkersDiedAndTheirLastWords) {
  ASSERT_TRUE(Send("client", SubmitRequest(1, "/out")).has_job_accepted());
  for (const std::uint64_t process : {1U, 2U}) {
    Hello(process);
    ASSERT_EQ(Ask().attempt(), process);
    Die(process, "was killed by signal 6 (Aborted)", {"info task_started", "process " + std::to_string(process)});
  }
  Hello(3);
  const v1::GrantTask cleanup = Ask();
  ASSERT_EQ(cleanup.task().id().kind(), v1::TASK_KIND_CLEANUP);
  Finish(cleanup, v1::CODE_OK);
  const auto expect = [](const v1::JobStatus& status) {
    EXPECT_EQ(status.state(), v1::JOB_STATE_FAILED);
    EXPECT_THAT(status.error().message(),
                HasSubstr("the worker was killed by signal 6 (Aborted); its last words: process 2"));
    ASSERT_EQ(status.failed_attempts_size(), 2);
    for (int i = 0; i < 2; ++i) {
      const v1::TaskAttempt& attempt = status.failed_attempts(i);
      EXPECT_EQ(attempt.outcome(), v1::ATTEMPT_OUTCOME_WORKER_LOST);
      EXPECT_THAT(attempt.log().lines(), ElementsAre("info task_started", "process " + std::to_string(i + 1)));
    }
  };
  expect(Status());
  Start();
  expect(Status());
}

TEST_F(Quarantine, TheDeathOfAnotherProcessOrToldByAnotherUserIsNotItsOwn) {
  ASSERT_TRUE(Send("client", SubmitRequest(1, "/out")).has_job_accepted());
  Die(1, "was never here", {});
  Hello(2);
  ASSERT_EQ(Ask().attempt(), 1U);
  Die(1, "died before the other came", {});
  Die(0, "does not tell its process", {});
  Die(2, "is not this user's to tell of", {}, "work:other");
  EXPECT_EQ(Ask().task().id().kind(), v1::TASK_KIND_UNSPECIFIED) << "it has the only task that is ready";
  Die(2, "died", {});
  Die(2, "died, and that was told twice", {});
  Hello(3);
  EXPECT_EQ(Ask().attempt(), 2U);
}

TEST_F(Quarantine, LastWordsAreTextWithinBoundsWhateverTheyWere) {
  ASSERT_TRUE(Send("client", SubmitRequest(1, "/out")).has_job_accepted());
  Hello(1);
  ASSERT_EQ(Ask().attempt(), 1U);
  Die(1, std::string("\x1b[31m\n") + std::string(10'000, 'h'),
      std::vector<std::string>(1000, "\x1b[2J" + std::string(10'000, 'w')));
  v1::Envelope request;
  request.mutable_get_job_logs()->set_job_id(1);
  const v1::JobLogs logs = Send("client", request).job_logs();
  ASSERT_EQ(logs.attempts_size(), 1);
  const v1::TaskAttempt& attempt = logs.attempts(0);
  EXPECT_LE(attempt.error().message().size(), 600U);
  EXPECT_THAT(attempt.error().message(), HasSubstr("the worker ?[31m?hhh"));
  EXPECT_LE(attempt.log().lines_size(), 8);
  EXPECT_EQ(attempt.log().left_out() + static_cast<std::uint64_t>(attempt.log().lines_size()), 1000U);
  for (const std::string& line : attempt.log().lines()) {
    EXPECT_LE(line.size(), 2048U);
    EXPECT_TRUE(line.starts_with("?[2Jwww"));
  }
}

TEST_F(Quarantine, AWorkerThatDoesNotTellItsProcessIsNotTakenForADeadOne) {
  ASSERT_TRUE(Send("client", SubmitRequest(1, "/out")).has_job_accepted());
  Hello(0);
  ASSERT_EQ(Ask().attempt(), 1U);
  Hello(0);
  EXPECT_EQ(Ask().attempt(), 1U);
}

}  // namespace
}  // namespace depthfarm
