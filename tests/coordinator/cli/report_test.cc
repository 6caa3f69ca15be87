#include "coordinator/cli/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

v1::JobStatus SomeJob() {
  v1::JobStatus job;
  job.set_job_id(3);
  job.set_name("ballet");
  job.set_state(v1::JOB_STATE_RUNNING);
  job.set_frames_done(2);
  job.set_frames_total(6);
  job.set_elapsed_seconds(30);
  job.set_output_dir("/data/out");
  v1::StageStatus& analyse = *job.add_stages();
  analyse.set_kind(v1::TASK_KIND_ANALYSE);
  analyse.set_tasks_done(10);
  analyse.set_tasks_total(10);
  analyse.set_cpu_seconds(12.5);
  analyse.set_peak_memory_bytes(std::uint64_t{300} << 20);
  v1::StageStatus& estimate = *job.add_stages();
  estimate.set_kind(v1::TASK_KIND_ESTIMATE);
  estimate.set_tasks_done(5);
  estimate.set_tasks_total(20);
  return job;
}

TEST(FormatDuration, ChoosesItsUnits) {
  EXPECT_EQ(FormatDuration(0), "0 ms");
  EXPECT_EQ(FormatDuration(0.85), "850 ms");
  EXPECT_EQ(FormatDuration(12.34), "12.3 s");
  EXPECT_EQ(FormatDuration(245), "4 min 05 s");
  EXPECT_EQ(FormatDuration(7380), "2 h 03 min");
}

TEST(FormatBytes, ChoosesItsUnits) {
  EXPECT_EQ(FormatBytes(0), "0 B");
  EXPECT_EQ(FormatBytes(1023), "1023 B");
  EXPECT_EQ(FormatBytes(512.0 * 1024), "512 KiB");
  EXPECT_EQ(FormatBytes(1.5 * (1 << 30)), "1.5 GiB");
}

TEST(FormatRoughDuration, SaysNoMoreThanCanBeExpected) {
  EXPECT_EQ(FormatRoughDuration(0.2), "0 s");
  EXPECT_EQ(FormatRoughDuration(99.2), "99 s");
  EXPECT_EQ(FormatRoughDuration(185), "3 min");
  EXPECT_EQ(FormatRoughDuration(7505), "2 h 05 min");
}

TEST(FormatProgress, TellsWhatIsExpectedToBeLeft) {
  v1::JobStatus job = SomeJob();
  job.set_seconds_left(185);
  EXPECT_EQ(FormatProgress(job), "frame 2/6, task 15/30, 30.0 s, about 3 min left");
}

TEST(FormatProgress, ARenderingJobHasParts) {
  v1::JobStatus job = SomeJob();
  v1::StageStatus& render = *job.add_stages();
  render.set_kind(v1::TASK_KIND_RENDER);
  EXPECT_THAT(FormatProgress(job), HasSubstr("frame 2/6"));
  render.set_tasks_total(6);
  EXPECT_THAT(FormatProgress(job), HasSubstr("part 2/6"));
}

TEST(FormatProgress, MakesNoGuessBeforeThereIsAnythingToGuessFrom) {
  EXPECT_EQ(FormatProgress(SomeJob()), "frame 2/6, task 15/30, 30.0 s");
  EXPECT_THAT(FormatProgress(v1::JobStatus()), Not(HasSubstr("left")));
}

TEST(FormatJob, TellsStagesAndReason) {
  v1::JobStatus job = SomeJob();
  job.set_state(v1::JOB_STATE_FAILED);
  job.mutable_error()->set_code(v1::CODE_UNAVAILABLE);
  job.mutable_error()->set_message("disk is full");
  EXPECT_THAT(FormatJob(job),
              AllOf(HasSubstr("job 3 'ballet': failed"), HasSubstr("disk is full"), HasSubstr("analyse"),
                    HasSubstr("10/10"), HasSubstr("12.5 s"), HasSubstr("300 MiB"), HasSubstr("/data/out")));
}

TEST(FormatJob, NamesTheTaskThatFailedItAndHow) {
  v1::JobStatus job = SomeJob();
  EXPECT_THAT(FormatJob(job), Not(HasSubstr("quarantined")));
  job.set_state(v1::JOB_STATE_FAILED);
  job.mutable_failed_task()->set_job_id(3);
  job.mutable_failed_task()->set_frame(1);
  job.mutable_failed_task()->set_kind(v1::TASK_KIND_ESTIMATE);
  v1::TaskAttempt& attempt = *job.add_failed_attempts();
  *attempt.mutable_task() = job.failed_task();
  attempt.set_worker("w7");
  attempt.set_attempt(2);
  attempt.set_seconds(3);
  attempt.set_outcome(v1::ATTEMPT_OUTCOME_WORKER_LOST);
  attempt.mutable_error()->set_code(v1::CODE_UNAVAILABLE);
  attempt.mutable_error()->set_message("w7: the worker was lost");
  attempt.mutable_log()->add_lines("warning low_memory");
  EXPECT_THAT(FormatJob(job), HasSubstr("  quarantined: frame 1 estimate block 0; retry begins it anew\n"
                                        "    attempt 2 on w7, 3.0 s: worker lost\n"
                                        "    reason: w7: the worker was lost\n"
                                        "    | warning low_memory\n"));
  EXPECT_THAT(FormatJob(job, BegunAnewBy::kSameCommand), HasSubstr("block 0; the same command begins it anew\n"));
  const nlohmann::ordered_json json = JobToJson(job);
  EXPECT_EQ(json["failedTask"], "frame 1 estimate block 0");
  EXPECT_EQ(json["failedAttempts"][0]["worker"], "w7");
  EXPECT_TRUE(JobToJson(SomeJob())["failedTask"].is_null());
}

TEST(FormatJob, TellsTheReasonOfTheLastAttemptOnce) {
  v1::JobStatus job = SomeJob();
  job.set_state(v1::JOB_STATE_FAILED);
  job.mutable_error()->set_message("job 3 frame 1 estimate block 0: w8: the disk is full");
  job.mutable_failed_task()->set_job_id(3);
  for (const char* const reason : {"w7: no route", "w8: the disk is full"})
    job.add_failed_attempts()->mutable_error()->set_message(reason);
  EXPECT_THAT(FormatJob(job),
              AllOf(HasSubstr("    reason: w7: no route\n"), Not(HasSubstr("    reason: w8: the disk is full\n"))));
}

TEST(FormatJob, TellsWhatOfTheGivenWasLeftAside) {
  v1::JobStatus job = SomeJob();
  EXPECT_THAT(FormatJob(job), Not(HasSubstr("left aside")));
  EXPECT_TRUE(JobToJson(job)["stages"][0]["firstLeftAside"].is_null());
  v1::StageStatus& analyse = *job.mutable_stages(0);
  analyse.set_left_aside(2);
  analyse.mutable_first_left_aside()->set_job_id(3);
  analyse.mutable_first_left_aside()->set_frame(4);
  analyse.mutable_first_left_aside()->set_kind(v1::TASK_KIND_ANALYSE);
  analyse.mutable_first_left_aside()->set_index(1);
  v1::StageStatus& refine = *job.add_stages();
  refine.set_kind(v1::TASK_KIND_REFINE);
  refine.set_left_aside(1);
  *refine.mutable_first_left_aside() = analyse.first_left_aside();
  refine.mutable_first_left_aside()->set_kind(v1::TASK_KIND_REFINE);
  EXPECT_THAT(
      FormatJob(job),
      AllOf(HasSubstr("  left aside: the masks of 2 pictures, the first at frame 4 analyse view 1: their contours "
                      "are not those of the pictures\n"),
            HasSubstr("  left aside: the priors of 1 picture, the first at frame 4 refine ")));
  EXPECT_EQ(JobToJson(job)["stages"][0]["leftAside"], 2);
  EXPECT_EQ(JobToJson(job)["stages"][0]["firstLeftAside"], "frame 4 analyse view 1");
}

TEST(FormatJob, CountsDuplicates) {
  v1::JobStatus job = SomeJob();
  EXPECT_THAT(FormatJob(job), Not(HasSubstr("second worker")));
  job.set_duplicates(5);
  job.set_duplicates_won(2);
  EXPECT_THAT(FormatJob(job), HasSubstr("slow tasks given to a second worker: 5, which was faster with 2\n"));
  EXPECT_EQ(JobToJson(job)["duplicates"], 5);
  EXPECT_EQ(JobToJson(job)["duplicatesWon"], 2);
}

TEST(FormatJob, DeterminismViolationsAreLoud) {
  v1::JobStatus job = SomeJob();
  EXPECT_THAT(FormatJob(job), Not(HasSubstr("DETERMINISM")));
  job.set_determinism_violations(1);
  EXPECT_THAT(FormatJob(job), HasSubstr("DETERMINISM VIOLATIONS: 1"));
}

TEST(JobToJson, HoldsWhatTheTextSays) {
  const nlohmann::ordered_json json = JobToJson(SomeJob());
  EXPECT_EQ(json["job"], 3);
  EXPECT_EQ(json["state"], "running");
  EXPECT_TRUE(json["error"].is_null());
  EXPECT_TRUE(json["secondsLeft"].is_null());
  v1::JobStatus job = SomeJob();
  job.set_seconds_left(2.5);
  EXPECT_EQ(JobToJson(job)["secondsLeft"], 2.5);
  EXPECT_EQ(json["stages"][0]["stage"], "analyse");
  EXPECT_EQ(json["stages"][1]["tasksTotal"], 20);
}

TEST(FormatJobs, AlignsColumns) {
  v1::JobStatus other = SomeJob();
  other.set_job_id(12);
  const std::string table = FormatJobs({SomeJob(), other});
  EXPECT_THAT(table, AllOf(HasSubstr("\n  3  running"), HasSubstr("\n 12  running")));
}

TEST(FormatWorkers, AnIdleWorkerIsIdle) {
  v1::WorkerStatus worker;
  worker.set_worker_id(1);
  worker.set_name("host:12:ab");
  EXPECT_THAT(FormatWorkers({worker}), AllOf(HasSubstr("host:12:ab"), HasSubstr("idle")));
}

}  // namespace
}  // namespace depthfarm
