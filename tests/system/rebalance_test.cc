// Tasks that wait behind the slot of one worker while another one is idle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "common/digest/sha256.h"
#include "common/sequence/read_sequence.h"
#include "common/transport/context.h"
#include "tests/system/gated_files.h"
#include "tests/system/support.h"
#include "worker/transfer/artifact_server.h"

namespace depthfarm::system_test {
namespace {

using testing::SizeIs;

class Rebalancing : public testing::Test {
 protected:
  void SetUp() override {
    const std::string sequence = RenderScene(folder_.path() / "scene", {.cameras = 3, .frames = 1});
    const Outcome run = Depthfarm(
        {"run", sequence, "-o", folder_ / "expected", "--workers", "1", "--segments", "600", "--levels", "24"});
    ASSERT_EQ(run.exit_code, 0) << run.output;
    submission_.sequence = ReadSequence(sequence).value();
    submission_.params.segments = 600;
    submission_.params.levels = 24;
    UploadSubmission uploads;
    for (const SequenceCamera& camera : submission_.sequence.cameras) {
      uploads.cameras.emplace_back().images = {files_.Add(camera.images.at(0))};
    }
    files_.Gate(uploads.cameras.at(0).images.at(0).file.sha256);
    server_ = ArtifactServer::Start(context_, files_, "ipc://" + folder_ / "pictures", "").value();
    uploads.from.endpoint = server_->endpoint();
    submission_.uploads = std::move(uploads);
  }
  // Attempts to analyse a view, or all, by how they ended.
  std::multimap<v1::AttemptOutcome, v1::TaskAttempt> Analyses(Farm& farm, const std::string& view = "") {
    std::multimap<v1::AttemptOutcome, v1::TaskAttempt> attempts;
    (void)farm.client().GetStatus(job_, true);  // the submitter is there
    const Result<v1::JobLogs> logs = farm.client().GetLogs(job_, "frame 0 analyse" + view);
    if (!logs.ok()) return attempts;
    for (const v1::TaskAttempt& attempt : logs->attempts()) attempts.emplace(attempt.outcome(), attempt);
    return attempts;
  }

  TemporaryFolder folder_;
  JobSubmission submission_;
  GatedFiles files_;
  TransportContext context_;
  std::unique_ptr<ArtifactServer> server_;
  std::uint64_t job_ = 0;
};

TEST_F(Rebalancing, AnIdleWorkerGetsWhatWaitsBehindTheSlotOfABusyOne) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker({"--ahead", "1"});
  const Result<std::uint64_t> job = farm.client().Submit(submission_);
  ASSERT_TRUE(job.ok()) << job.status().message();
  job_ = *job;
  // It is busy with the first view and has taken the second one besides; the third waits.
  ASSERT_TRUE(WaitUntil([&] { return files_.asked_for() && Analyses(farm).count(v1::ATTEMPT_OUTCOME_RUNNING) == 2; }))
      << farm.Logs();
  farm.AddWorker();
  // The other worker analyses the third, and then the second one.
  ASSERT_TRUE(WaitUntil([&] { return Analyses(farm).count(v1::ATTEMPT_OUTCOME_DONE) == 2; })) << farm.Logs();
  const auto second_view = Analyses(farm, " view 1");
  ASSERT_THAT(second_view, SizeIs(2)) << farm.Logs();
  const v1::TaskAttempt& given_back = second_view.find(v1::ATTEMPT_OUTCOME_GIVEN_BACK)->second;
  const v1::TaskAttempt& done = second_view.find(v1::ATTEMPT_OUTCOME_DONE)->second;
  EXPECT_NE(given_back.worker(), done.worker());
  EXPECT_EQ(done.attempt(), 1U);
  files_.Open();

  v1::JobStatus last;
  ASSERT_TRUE(WaitUntil([&] {
    const Result<v1::JobStatus> status = farm.client().GetStatus(job_, true);
    if (status.ok()) last = *status;
    return status.ok() && last.state() != v1::JOB_STATE_RUNNING;
  })) << farm.Logs();
  EXPECT_EQ(last.state(), v1::JOB_STATE_DONE) << last.error().message() << farm.Logs();
  EXPECT_EQ(last.retries(), 0U);
  EXPECT_EQ(last.determinism_violations(), 0U);
  const std::map<std::string, std::string> expected = DepthOf(folder_ / "expected");
  const Result<v1::Results> results = farm.client().GetResults(job_, 0);
  ASSERT_TRUE(results.ok() && results->frames_size() == 1) << results.status().message();
  ASSERT_THAT(results->frames(0).files(), SizeIs(3));
  for (int view = 0; view < 3; ++view) {
    const std::string name = "depth/cam" + std::to_string(view) + "/0000.png";
    const ContentDigest digest = Sha256(expected.at(name));
    EXPECT_EQ(results->frames(0).files(view).sha256(), std::string(digest.begin(), digest.end())) << name;
  }
}

}  // namespace
}  // namespace depthfarm::system_test
