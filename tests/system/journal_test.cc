// Coordinators that die and are started again, jobs that go on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

#include "tests/system/disturbed_job.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

const v1::StageStatus& StageOf(const v1::JobStatus& job, v1::TaskKind kind) {
  for (const v1::StageStatus& stage : job.stages())
    if (stage.kind() == kind) return stage;
  return v1::StageStatus::default_instance();
}

using Journal = DisturbedJob;

// Killed after so many tasks of about 200.
class KilledCoordinator : public DisturbedJob, public testing::WithParamInterface<int> {};
INSTANTIATE_TEST_SUITE_P(After, KilledCoordinator, testing::Values(1, 6, 40, 100, 160));

TEST_P(KilledCoordinator, GoesOnWithItsJobsToTheSameBytes) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  farm.AddWorker({"--slots", "2"});
  const std::string output = folder_ / "disturbed";
  const std::uint64_t job_id = Submit(farm, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm, job_id, static_cast<std::uint64_t>(GetParam())));
  ASSERT_TRUE(farm.RestartCoordinator(SIGKILL)) << farm.problem();
  const v1::JobStatus last = WaitForTheEnd(farm, job_id);
  EXPECT_EQ(last.state(), v1::JOB_STATE_DONE) << last.error().message() << "\n" << farm.Logs();
  EXPECT_EQ(last.determinism_violations(), 0U);
  EXPECT_THAT(Differences(Undisturbed(), DepthOf(output)), IsEmpty());
  EXPECT_THAT(Leftovers(output), IsEmpty());
  // It is remembered by the next one too, and its number is not given away.
  ASSERT_TRUE(farm.RestartCoordinator(SIGTERM)) << farm.problem();
  EXPECT_EQ(farm.client().GetStatus(job_id).value().state(), v1::JOB_STATE_DONE);
  EXPECT_EQ(Submit(farm, folder_ / "next"), job_id + 1);
}

TEST_F(Journal, WorkersOutliveACoordinatorThatIsStoppedForALittleWhile) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  const int worker = farm.AddWorker();
  const std::string output = folder_ / "stopped";
  const std::uint64_t job_id = Submit(farm, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm, job_id, 5));
  ASSERT_TRUE(farm.RestartCoordinator(SIGTERM)) << farm.problem();
  const v1::JobStatus last = WaitForTheEnd(farm, job_id);
  EXPECT_EQ(last.state(), v1::JOB_STATE_DONE) << last.error().message() << "\n" << farm.Logs();
  EXPECT_THAT(Differences(Undisturbed(), DepthOf(output)), IsEmpty());
  EXPECT_FALSE(farm.worker(worker).Poll()) << farm.Logs();
  // Told to by an administrator they end with it.
  const Status stopped = farm.client().StopCoordinator();
  ASSERT_TRUE(stopped.ok()) << stopped.message() << "\n" << farm.Logs();
  EXPECT_TRUE(farm.worker(worker).WaitFor(kDeadline)) << farm.Logs();
}

TEST_F(Journal, ACancelledJobGoesOnFromItsFrames) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const std::string output = folder_ / "cancelled";
  const std::uint64_t job_id = Submit(farm, output);
  std::uint64_t frames = 0;
  ASSERT_TRUE(WaitUntil([&] {
    frames = farm.client().GetStatus(job_id).value().frames_done();
    return frames >= 2;
  })) << farm.Logs();
  ASSERT_TRUE(farm.client().Cancel(job_id).ok());
  const v1::JobStatus cancelled = WaitForTheEnd(farm, job_id);
  ASSERT_EQ(cancelled.state(), v1::JOB_STATE_CANCELLED) << "the job ended before it could be cancelled";
  const Words retry = Words{"retry", std::to_string(job_id), "--wait", "--json"} + farm.Options();
  const Outcome done = Depthfarm(retry);
  EXPECT_EQ(done.exit_code, 0) << done.output << farm.Logs();
  const v1::JobStatus last = farm.client().GetStatus(job_id).value();
  EXPECT_EQ(last.frames_done(), 8U);
  EXPECT_GE(StageOf(last, v1::TASK_KIND_EMIT).reused(), frames);
  EXPECT_THAT(Differences(Undisturbed(), DepthOf(output)), IsEmpty());
  EXPECT_THAT(Leftovers(output), IsEmpty());
  const Outcome again = Depthfarm(retry);
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.output, HasSubstr("job " + std::to_string(job_id) + " is done: there is nothing to do again"));
}

TEST_F(Journal, WhatWasCancelledStaysSoWhenTheCoordinatorIsKilled) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const std::string output = folder_ / "cancelled";
  const std::uint64_t job_id = Submit(farm, output);
  ASSERT_TRUE(WaitUntil([&] { return farm.client().GetStatus(job_id).value().frames_done() >= 1; })) << farm.Logs();
  ASSERT_TRUE(farm.client().Cancel(job_id).ok());
  ASSERT_TRUE(farm.RestartCoordinator(SIGKILL)) << farm.problem();
  EXPECT_EQ(WaitForTheEnd(farm, job_id).state(), v1::JOB_STATE_CANCELLED) << farm.Logs();
  EXPECT_FALSE(fs::exists(fs::path(output) / ".depthfarm-staging"));
}

TEST_F(Journal, AJobThatFailedGoesOnWhenItsInputIsMended) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const fs::path picture = folder_.path() / "scene/cam1/0005.png";
  ASSERT_TRUE(fs::exists(picture));
  fs::copy_file(picture, picture.string() + ".whole");
  fs::resize_file(picture, fs::file_size(picture) / 2);
  const std::string output = folder_ / "failed";
  const std::uint64_t job_id = Submit(farm, output);
  EXPECT_EQ(WaitForTheEnd(farm, job_id).state(), v1::JOB_STATE_FAILED) << farm.Logs();
  // The farm was off meanwhile.
  ASSERT_TRUE(farm.RestartCoordinator(SIGTERM)) << farm.problem();
  farm.AddWorker();
  fs::rename(picture.string() + ".whole", picture);
  const Outcome done = Depthfarm(Words{"retry", std::to_string(job_id), "--wait"} + farm.Options());
  EXPECT_EQ(done.exit_code, 0) << done.output << farm.Logs();
  EXPECT_THAT(Differences(Undisturbed(), DepthOf(output)), IsEmpty());
}

TEST_F(Journal, AJobWhoseFramesAreGoneSaysSo) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const std::string output = folder_ / "gone";
  const std::uint64_t job_id = Submit(farm, output);
  ASSERT_TRUE(WaitUntil([&] { return farm.client().GetStatus(job_id).value().frames_done() >= 1; })) << farm.Logs();
  ASSERT_TRUE(farm.client().Cancel(job_id).ok());
  ASSERT_EQ(WaitForTheEnd(farm, job_id).state(), v1::JOB_STATE_CANCELLED);
  fs::remove_all(fs::path(output) / "depth");
  const Outcome refused = Depthfarm(Words{"retry", std::to_string(job_id), "--wait"} + farm.Options());
  EXPECT_EQ(refused.exit_code, 2) << refused.output;
  EXPECT_THAT(refused.output, HasSubstr("0000.png: is missing, so the job cannot go on: submit it again"));
}

TEST_F(Journal, BelongsToOneCoordinatorAndCanBeChecked) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  const Outcome second =
      RunProgram("depthfarm-coordinator", {"--listen", "ipc://" + (folder_ / "second"), "--journal", farm.Journal()});
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_THAT(second.output, HasSubstr("another process uses it"));
  const Outcome checked = RunProgram("depthfarm-coordinator", {"--check-journal", folder_ / "no-such/file"});
  EXPECT_EQ(checked.exit_code, 1) << checked.output;
}

}  // namespace
}  // namespace depthfarm::system_test
