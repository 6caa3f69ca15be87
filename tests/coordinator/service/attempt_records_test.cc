#include "coordinator/service/attempt_records.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr WorkerId kWorker(5);
const TimePoint kStart(std::chrono::hours(1));

TaskId Analysis(int frame, std::uint64_t job = 1) { return {JobId(job), frame, TaskKind::kAnalyse, 0, 0}; }

AttemptRecord Attempt(const TaskId& task) {
  AttemptRecord attempt;
  attempt.task = task;
  attempt.worker = kWorker;
  attempt.worker_name = "a:1";
  attempt.started = kStart;
  return attempt;
}

void BeginAndEnd(AttemptRecords& records, std::uint64_t lease, const TaskId& task, AttemptOutcome outcome,
                 const std::string& line = "") {
  records.Begin(LeaseId(lease), Attempt(task));
  if (!line.empty()) records.Report(kWorker, LeaseId(lease), task, {}, {{line}, 0});
  records.End({LeaseId(lease), task, outcome, {}}, kStart + Milliseconds(500));
}

std::vector<AttemptRecord> All(const AttemptRecords& records, std::uint64_t job = 1) {
  std::vector<AttemptRecord> all;
  EXPECT_FALSE(records.ForEach(
      JobId(job), LeaseId(0), [](const TaskId&) { return true; },
      [&](const AttemptRecord& attempt) {
        all.push_back(attempt);
        return true;
      }));
  return all;
}

std::vector<int> Frames(const AttemptRecords& records, std::uint64_t job = 1) {
  std::vector<int> frames;
  for (const AttemptRecord& attempt : All(records, job)) frames.push_back(attempt.task.frame);
  return frames;
}

TEST(AttemptRecords, KeepsWhatAWorkerToldAndHowItEnded) {
  AttemptRecords records;
  records.Begin(LeaseId(9), Attempt(Analysis(3)));
  EXPECT_EQ(All(records)[0].outcome, AttemptOutcome::kRunning);
  TaskStats stats;
  stats.cpu_seconds = 2;
  records.Report(kWorker, LeaseId(9), Analysis(3), stats, {{"warning slow"}, 1});
  records.End({LeaseId(9), Analysis(3), AttemptOutcome::kFailed, Unavailable("no disk")}, kStart + Milliseconds(700));
  const AttemptRecord attempt = All(records)[0];
  EXPECT_EQ(attempt.outcome, AttemptOutcome::kFailed);
  EXPECT_EQ(attempt.error.message(), "no disk");
  EXPECT_EQ(attempt.ended - attempt.started, Milliseconds(700));
  EXPECT_EQ(attempt.stats.cpu_seconds, 2);
  EXPECT_THAT(attempt.log.lines, ElementsAre("warning slow"));
  EXPECT_EQ(attempt.log.left_out, 1U);
}

TEST(AttemptRecords, BelievesOnlyTheWorkerThatHasTheLease) {
  AttemptRecords records;
  records.Begin(LeaseId(9), Attempt(Analysis(3)));
  records.Report(WorkerId(6), LeaseId(9), Analysis(3), {}, {{"of another worker"}, 0});
  records.Report(kWorker, LeaseId(9), Analysis(4), {}, {{"of another task"}, 0});
  records.Report(kWorker, LeaseId(8), Analysis(3), {}, {{"of another lease"}, 0});
  records.End({LeaseId(9), Analysis(3), AttemptOutcome::kExpired, {}}, kStart);
  records.Report(kWorker, LeaseId(9), Analysis(3), {}, {{"too late"}, 0});
  records.End({LeaseId(9), Analysis(3), AttemptOutcome::kDone, {}}, kStart);
  EXPECT_THAT(All(records)[0].log.lines, IsEmpty());
  EXPECT_EQ(All(records)[0].outcome, AttemptOutcome::kExpired);
}

TEST(AttemptRecords, KeepsFailuresAndTheNewestOfTheOthers) {
  AttemptRecords records({.well_of_job = 2, .failed_of_job = 3, .in_all = 100, .text_bytes = 100});
  records.Begin(LeaseId(1), Attempt(Analysis(1)));
  BeginAndEnd(records, 2, Analysis(2), AttemptOutcome::kFailed);
  for (int frame = 3; frame < 8; ++frame)
    BeginAndEnd(records, static_cast<std::uint64_t>(frame), Analysis(frame), AttemptOutcome::kDone);
  EXPECT_THAT(Frames(records), ElementsAre(1, 2, 6, 7));
  EXPECT_EQ(records.Forgotten(JobId(1)), 3U);
  for (int frame = 8; frame < 11; ++frame)
    BeginAndEnd(records, static_cast<std::uint64_t>(frame), Analysis(frame), AttemptOutcome::kWorkerLost);
  EXPECT_THAT(Frames(records), ElementsAre(1, 6, 7, 8, 9, 10));
  EXPECT_EQ(records.size(), 6U);
}

TEST(AttemptRecords, OfAllJobsTheOldestGoFirstAndFailuresLast) {
  AttemptRecords records({.well_of_job = 10, .failed_of_job = 10, .in_all = 3, .text_bytes = 100});
  BeginAndEnd(records, 1, Analysis(1, 1), AttemptOutcome::kFailed);
  BeginAndEnd(records, 2, Analysis(2, 1), AttemptOutcome::kDone);
  BeginAndEnd(records, 3, Analysis(3, 2), AttemptOutcome::kDone);
  BeginAndEnd(records, 4, Analysis(4, 2), AttemptOutcome::kDone);
  EXPECT_THAT(Frames(records, 1), ElementsAre(1));
  EXPECT_THAT(Frames(records, 2), ElementsAre(3, 4));
  for (std::uint64_t lease = 5; lease < 8; ++lease)
    BeginAndEnd(records, lease, Analysis(5, 3), AttemptOutcome::kFailed);
  EXPECT_THAT(Frames(records, 1), IsEmpty());
  EXPECT_THAT(Frames(records, 2), IsEmpty());
  EXPECT_EQ(records.size(), 3U);
}

TEST(AttemptRecords, KeepsTheNewestTexts) {
  AttemptRecords records({.well_of_job = 10, .failed_of_job = 10, .in_all = 100, .text_bytes = 25});
  for (std::uint64_t lease = 1; lease < 4; ++lease)
    BeginAndEnd(records, lease, Analysis(static_cast<int>(lease)), AttemptOutcome::kDone, "ten bytes.");
  EXPECT_THAT(All(records)[0].log.lines, IsEmpty());
  EXPECT_EQ(All(records)[0].log.left_out, 1U);
  EXPECT_THAT(All(records)[1].log.lines, ElementsAre("ten bytes."));
  EXPECT_THAT(All(records)[2].log.lines, ElementsAre("ten bytes."));
}

TEST(AttemptRecords, ForgetsJobsThatNobodyKnows) {
  AttemptRecords records({.well_of_job = 10, .failed_of_job = 10, .in_all = 100, .text_bytes = 15});
  BeginAndEnd(records, 1, Analysis(1, 1), AttemptOutcome::kDone, "ten bytes.");
  records.Begin(LeaseId(2), Attempt(Analysis(2, 1)));
  records.KeepJobs([](JobId job) { return job == JobId(2); });
  EXPECT_EQ(records.size(), 0U);
  records.End({LeaseId(2), Analysis(2, 1), AttemptOutcome::kDone, {}}, kStart);
  EXPECT_THAT(All(records), IsEmpty());
  BeginAndEnd(records, 3, Analysis(3, 2), AttemptOutcome::kDone, "ten bytes.");
  EXPECT_THAT(All(records, 2)[0].log.lines, ElementsAre("ten bytes.")) << "their texts do not count any more";
}

TEST(AttemptRecords, GoesOnWhereItStopped) {
  AttemptRecords records;
  for (int frame = 1; frame <= 5; ++frame)
    BeginAndEnd(records, static_cast<std::uint64_t>(frame), Analysis(frame), AttemptOutcome::kDone);
  std::vector<int> frames;
  LeaseId after(0);
  int pages = 0;
  for (bool more = true; more; ++pages) {
    std::size_t of_page = 0;
    const std::optional<LeaseId> last = records.ForEach(
        JobId(1), after, [](const TaskId& task) { return task.frame != 3; },
        [&](const AttemptRecord& attempt) {
          if (of_page == 2) return false;
          ++of_page;
          frames.push_back(attempt.task.frame);
          return true;
        });
    more = last.has_value();
    if (more) after = *last;
  }
  EXPECT_THAT(frames, ElementsAre(1, 2, 4, 5));
  EXPECT_EQ(pages, 2);
}

}  // namespace
}  // namespace depthfarm
