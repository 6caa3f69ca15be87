#include "coordinator/service/logs_wire.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

const TimePoint kSubmitted(std::chrono::hours(1));

AttemptRecords Analyses(int count, std::size_t line_bytes = 0) {
  AttemptRecords records;
  for (int frame = 0; frame < count; ++frame) {
    const LeaseId lease(static_cast<std::uint64_t>(frame) + 1);
    AttemptRecord attempt;
    attempt.task = {JobId(1), frame, TaskKind::kAnalyse, 0, 0};
    attempt.started = kSubmitted + Milliseconds(500);
    if (line_bytes > 0) attempt.log.lines = {std::string(line_bytes, 'x')};
    records.Begin(lease, attempt);
    records.End({lease, attempt.task, AttemptOutcome::kDone, {}}, kSubmitted + Milliseconds(2500));
  }
  return records;
}

int CountPages(const AttemptRecords& records, const std::string& task, int& attempts) {
  v1::GetJobLogs request;
  request.set_job_id(1);
  request.set_task(task);
  int pages = 0;
  do {
    const v1::JobLogs logs = LogsToProto(records, request, kSubmitted, kSubmitted).value();
    EXPECT_LE(logs.ByteSizeLong(), (std::size_t{4} << 20) + 20'000);
    attempts += logs.attempts_size();
    request.set_after(logs.next());
    ++pages;
  } while (request.after() != 0 && pages < 1000);
  return pages;
}

TEST(LogsToProto, TellsTimesSinceTheJobWasSubmitted) {
  v1::GetJobLogs request;
  request.set_job_id(1);
  const v1::JobLogs logs = LogsToProto(Analyses(1), request, kSubmitted, kSubmitted).value();
  ASSERT_EQ(logs.attempts_size(), 1);
  EXPECT_EQ(logs.attempts(0).started_seconds(), 0.5);
  EXPECT_EQ(logs.attempts(0).seconds(), 2);
  EXPECT_EQ(logs.attempts(0).outcome(), v1::ATTEMPT_OUTCOME_DONE);
  EXPECT_FALSE(logs.attempts(0).has_error());
  EXPECT_EQ(logs.next(), 0U);
}

TEST(LogsToProto, FitsAnswersIntoMessages) {
  int attempts = 0;
  EXPECT_EQ(CountPages(Analyses(2500), "", attempts), 3);
  EXPECT_EQ(attempts, 2500);
  attempts = 0;
  EXPECT_EQ(CountPages(Analyses(2500), "frame 2400", attempts), 1);
  EXPECT_EQ(attempts, 1);
  attempts = 0;
  EXPECT_EQ(CountPages(Analyses(900, 16'000), "", attempts), 4);
  EXPECT_EQ(attempts, 900);
}

TEST(LogsToProto, RefusesTasksThatAreNone) {
  v1::GetJobLogs request;
  request.set_task("sing");
  EXPECT_EQ(LogsToProto(AttemptRecords(), request, kSubmitted, kSubmitted).status().code(),
            ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
