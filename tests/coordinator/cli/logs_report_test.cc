#include "coordinator/cli/logs_report.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

v1::TaskAttempt& AddAttempt(v1::JobLogs& logs, std::uint32_t attempt, v1::AttemptOutcome outcome) {
  v1::TaskAttempt& added = *logs.add_attempts();
  added.mutable_task()->set_job_id(3);
  added.mutable_task()->set_frame(12);
  added.mutable_task()->set_kind(v1::TASK_KIND_ANALYSE);
  added.set_worker("a:1");
  added.set_attempt(attempt);
  added.set_started_seconds(2.5);
  added.set_seconds(1.5);
  added.set_outcome(outcome);
  return added;
}

v1::JobLogs SmallLogs() {
  v1::JobLogs logs;
  logs.set_job_id(3);
  v1::TaskAttempt& failed = AddAttempt(logs, 1, v1::ATTEMPT_OUTCOME_FAILED);
  failed.mutable_error()->set_code(v1::CODE_UNAVAILABLE);
  failed.mutable_error()->set_message("frame 12: out of reach");
  failed.mutable_log()->add_lines("libpng error: Read Error");
  failed.mutable_log()->set_left_out(2);
  v1::TaskAttempt& done = AddAttempt(logs, 2, v1::ATTEMPT_OUTCOME_DONE);
  done.mutable_stats()->set_wall_seconds(1.25);
  done.mutable_stats()->set_cpu_seconds(1);
  done.mutable_stats()->set_peak_memory_bytes(1 << 20);
  done.mutable_stats()->set_fetched_bytes(2048);
  return logs;
}

TEST(FormatLogs, IsALinePerAttemptAndWhatWentWrongBelow) {
  EXPECT_EQ(FormatLogs(SmallLogs()),
            "task                     worker  try  start   wall    CPU  peak memory  fetched  outcome\n"
            "frame 12 analyse view 0  a:1       1  2.5 s  1.5 s      -            -        -  failed: unavailable\n"
            "    reason: frame 12: out of reach\n"
            "    | (2 lines before)\n"
            "    | libpng error: Read Error\n"
            "frame 12 analyse view 0  a:1       2  2.5 s  1.2 s  1.0 s      1.0 MiB  2.0 KiB  done\n");
}

TEST(FormatLogs, SaysWhatIsNotThere) {
  v1::JobLogs logs;
  EXPECT_EQ(FormatLogs(logs), "no attempts\n");
  logs.set_forgotten(12345);
  EXPECT_EQ(FormatLogs(logs), "12,345 older attempts of the job are not kept any more\nno attempts\n");
}

TEST(LogsToJson, HoldsTheSame) {
  const nlohmann::ordered_json json = LogsToJson(SmallLogs());
  EXPECT_EQ(json["job"], 3);
  EXPECT_EQ(json["attemptsForgotten"], 0);
  ASSERT_EQ(json["attempts"].size(), 2U);
  const nlohmann::ordered_json& failed = json["attempts"][0];
  EXPECT_EQ(failed["task"], "frame 12 analyse view 0");
  EXPECT_EQ(failed["outcome"], "failed");
  EXPECT_EQ(failed["error"]["code"], "unavailable");
  EXPECT_EQ(failed["log"], nlohmann::ordered_json({"libpng error: Read Error"}));
  EXPECT_EQ(failed["logLinesLeftOut"], 2);
  const nlohmann::ordered_json& done = json["attempts"][1];
  EXPECT_TRUE(done["error"].is_null());
  EXPECT_EQ(done["attempt"], 2);
  EXPECT_EQ(done["startSeconds"], 2.5);
  EXPECT_EQ(done["fetchedBytes"], 2048);
}

TEST(OutcomeName, IsUnknownForThoseOfANewerCoordinator) {
  EXPECT_EQ(OutcomeName(v1::ATTEMPT_OUTCOME_EXPIRED), "lease expired");
  EXPECT_EQ(OutcomeName(static_cast<v1::AttemptOutcome>(77)), "unknown");
}

}  // namespace
}  // namespace depthfarm
