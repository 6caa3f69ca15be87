// A task that takes its workers with it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "common/sequence/read_sequence.h"
#include "common/transport/context.h"
#include "tests/system/gated_files.h"
#include "tests/system/support.h"
#include "worker/transfer/artifact_server.h"

namespace depthfarm::system_test {
namespace {

using testing::HasSubstr;

constexpr const char* kPoison = "frame 1 analyse view 1";
constexpr int kMaxAttempts = 4;  // of the coordinator, by default

// Workers that are killed as soon as the coordinator says that one has the task, which does not end before: its picture
// is not served. Every second one comes back under its name at once, as under a service manager; the others are
// replaced.
class Poison : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(farm_.ok()) << farm_.problem();
    submission_.sequence = ReadSequence(RenderScene(folder_.path() / "scene", {.cameras = 3, .frames = 2})).value();
    submission_.params.segments = 600;
    submission_.params.levels = 24;
    UploadSubmission uploads;
    for (const SequenceCamera& camera : submission_.sequence.cameras) {
      uploads.cameras.emplace_back().images = {files_.Add(camera.images.at(0)), files_.Add(camera.images.at(1))};
    }
    files_.Gate(uploads.cameras.at(1).images.at(1).file.sha256);
    server_ = ArtifactServer::Start(context_, files_, "ipc://" + folder_ / "pictures", "").value();
    uploads.from.endpoint = server_->endpoint();
    submission_.uploads = std::move(uploads);
    ASSERT_EQ(farm_.client().Submit(submission_).value(), 1U);
    const Outcome other = Depthfarm(Words{"submit", RenderScene(folder_.path() / "other", {.cameras = 2, .frames = 2}),
                                          "-o", folder_ / "harmless"} +
                                    SmallJob() + farm_.Options());
    ASSERT_EQ(other.exit_code, 0) << other.output;
  }
  void AddWorker(const std::string& name) { workers_[name] = farm_.AddWorker({"--name", name, "--ahead", "0"}); }
  // Kills who has the task, once for each attempt.
  void KillWhoHasIt() {
    const Result<v1::JobLogs> logs = farm_.client().GetLogs(1, kPoison);
    if (!logs.ok()) return;
    for (const v1::TaskAttempt& attempt : logs->attempts()) {
      if (attempt.outcome() != v1::ATTEMPT_OUTCOME_RUNNING || !killed_for_.insert(attempt.started_seconds()).second)
        continue;
      ChildProcess& process = farm_.worker(workers_.at(attempt.worker()));
      process.Signal(SIGKILL);
      ASSERT_TRUE(process.WaitFor(kDeadline));
      AddWorker(killed_for_.size() % 2 == 1 ? attempt.worker() : "another-" + std::to_string(killed_for_.size()));
    }
  }
  [[nodiscard]] v1::JobState StateOf(std::uint64_t job) {
    const Result<v1::JobStatus> status = farm_.client().GetStatus(job, job == 1);  // its submitter is there
    return status.ok() ? status->state() : v1::JOB_STATE_UNSPECIFIED;
  }

  TemporaryFolder folder_;
  JobSubmission submission_;
  GatedFiles files_;
  TransportContext context_;
  std::unique_ptr<ArtifactServer> server_;
  Farm farm_;
  std::map<std::string, int> workers_;  // the last of each name
  std::set<double> killed_for_;         // attempts, by when they began
};

TEST_F(Poison, IsQuarantinedWhileTheFarmServesAnotherJob) {
  AddWorker("w1");
  AddWorker("w2");
  ASSERT_TRUE(WaitUntil([&] {
    KillWhoHasIt();
    return StateOf(1) == v1::JOB_STATE_FAILED && StateOf(2) == v1::JOB_STATE_DONE;
  })) << farm_.Logs();
  EXPECT_GE(killed_for_.size(), static_cast<std::size_t>(kMaxAttempts)) << farm_.Logs();

  const Outcome told = Depthfarm(Words{"status", "1", "--json"} + farm_.Options());
  const nlohmann::json status = ParseJsonTail(told.output);
  EXPECT_EQ(status["failedTask"], kPoison) << told.output;
  ASSERT_EQ(status["failedAttempts"].size(), static_cast<std::size_t>(kMaxAttempts)) << told.output;
  for (const nlohmann::json& attempt : status["failedAttempts"]) {
    // The lease may end before the silence of its worker is noticed.
    EXPECT_THAT(attempt["outcome"].get<std::string>(), testing::AnyOf("worker lost", "lease expired"));
    EXPECT_THAT(attempt["error"]["message"].get<std::string>(), HasSubstr(attempt["worker"].get<std::string>()));
  }
  const std::string text = Depthfarm(Words{"status", "1"} + farm_.Options()).output;
  EXPECT_THAT(text, HasSubstr(std::string("quarantined: ") + kPoison));
  EXPECT_THAT(text, HasSubstr("attempt 4 on "));
}

}  // namespace
}  // namespace depthfarm::system_test
