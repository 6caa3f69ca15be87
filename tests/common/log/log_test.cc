#include "common/log/log.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace depthfarm {
namespace {

std::string Line(std::string_view event, std::initializer_list<LogField> fields) {
  return FormatLogLine(event, fields);
}

TEST(LogLine, IsAnEventAndItsFieldsInOrder) {
  EXPECT_EQ(Line("task_granted", {{"job", 12}, {"lease", std::uint64_t{991}}, {"reused", true}, {"cpu", 0.25}}),
            "task_granted job=12 lease=991 reused=true cpu=0.25");
}

TEST(LogLine, QuotesValuesThatWouldBreakTheForm) {
  EXPECT_EQ(Line("e", {{"task", "job 3 prepare"}}), "e task=\"job 3 prepare\"");
  EXPECT_EQ(Line("e", {{"empty", ""}}), "e empty=\"\"");
  EXPECT_EQ(Line("e", {{"pair", "a=b"}}), "e pair=\"a=b\"");
}

TEST(LogLine, StaysOneLineWhateverAPeerSent) {
  EXPECT_EQ(Line("e", {{"name", std::string("a\"b\\c\nd\x1b[31m")}}), R"(e name="a\"b\\c\nd\x1b[31m")");
}

TEST(IsRoutineLine, TellsDebugAndInfoOfALogFromAllElse) {
  EXPECT_TRUE(IsRoutineLine("2026-01-02T03:04:05.678Z info task_granted job=12"));
  EXPECT_TRUE(IsRoutineLine("2026-01-02T03:04:05.678Z debug x"));
  for (const char* line : {"", "2026-01-02T03:04:05.678Z ", "2026-01-02T03:04:05.678Z warning worker_lost",
                           "2026-01-02T03:04:05.678Z error worker_died", "2026-01-02 03:04:05.678Z info x", "info x",
                           "terminate called after throwing an instance of 'std::bad_alloc'"})
    EXPECT_FALSE(IsRoutineLine(line)) << line;
}

TEST(IsRoutineLine, KnowsWhatLogWrites) {
  ASSERT_TRUE(SetLogLevel("debug").ok());
  for (const LogLevel level : {LogLevel::kDebug, LogLevel::kInfo, LogLevel::kWarning, LogLevel::kError}) {
    testing::internal::CaptureStderr();
    Log(level, "event", {});
    const std::string text = testing::internal::GetCapturedStderr();
    EXPECT_EQ(IsRoutineLine(text), level < LogLevel::kWarning) << text;
  }
  ASSERT_TRUE(SetLogLevel("info").ok());
}

TEST(LogLevel, UnknownNamesAreRefusedWithTheList) {
  const Status status = SetLogLevel("loud");
  EXPECT_EQ(status.code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(status.message().find("debug, info, warning, error or off"), std::string::npos);
  EXPECT_TRUE(SetLogLevel("info").ok());
}

TEST(Log, WritesToStderrWhatTheLevelLetsThrough) {
  ASSERT_TRUE(SetLogLevel("warning").ok());
  testing::internal::CaptureStderr();
  LogInfo("quiet");
  LogWarning("worker_lost", {{"worker", 4}});
  const std::string text = testing::internal::GetCapturedStderr();
  ASSERT_TRUE(SetLogLevel("info").ok());
  EXPECT_EQ(text.find("quiet"), std::string::npos);
  EXPECT_NE(text.find(" warning worker_lost worker=4\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace depthfarm
