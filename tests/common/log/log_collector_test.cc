#include "common/log/log_collector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <iostream>
#include <string>
#include <thread>

#include "common/log/log.h"

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(LogCollector, KeepsWarningsAndErrorsOfItsThread) {
  LogCollector collector({});
  LogInfo("task_started", {{"lease", 4}});
  LogWarning("slow", {{"seconds", 3}});
  std::thread([] { LogError("of_another_thread"); }).join();
  LogError("broken");
  EXPECT_THAT(collector.TakeLines(), ElementsAre("warning slow seconds=3", "error broken"));
  EXPECT_EQ(collector.left_out(), 0U);
}

TEST(LogCollector, KeepsThemWhateverTheLevelOfTheLog) {
  ASSERT_TRUE(SetLogLevel("off").ok());
  LogCollector collector({});
  LogWarning("slow");
  ASSERT_TRUE(SetLogLevel("info").ok());
  EXPECT_THAT(collector.TakeLines(), ElementsAre("warning slow"));
}

TEST(LogCollector, EndsWithItsScope) {
  { const LogCollector collector({}); }
  EXPECT_EQ(LogCollector::OfThread(), nullptr);
  LogWarning("to_nobody");
}

TEST(LogCollector, KeepsTheLastLinesWithinItsBounds) {
  LogCollector collector({.lines = 2, .bytes = 100, .line_bytes = 10});
  for (const char* line : {"first", "second", "third", "a line that is too long"}) collector.Add(line);
  EXPECT_THAT(collector.TakeLines(), ElementsAre("third", "a line ..."));
  EXPECT_EQ(collector.left_out(), 2U);

  LogCollector short_of_bytes({.lines = 10, .bytes = 8, .line_bytes = 10});
  for (const char* line : {"one", "two", "three"}) short_of_bytes.Add(line);
  EXPECT_THAT(short_of_bytes.TakeLines(), ElementsAre("two", "three"));
}

TEST(LogCollector, CutsTextIntoLines) {
  LogCollector collector({.lines = 10, .bytes = 1000, .line_bytes = 20});
  collector.AddText("libpng ");
  collector.AddText("error: Read\n\nwarning");
  collector.AddText(": x\x1b\n");
  for (int i = 0; i < 100; ++i) collector.AddText("without an end ");
  EXPECT_THAT(collector.TakeLines(), ElementsAre("libpng error: Read", "warning: x?", "without an end wi..."));
}

TEST(LogCollector, PassesOverRoutineLinesOfAnotherProcess) {
  LogCollector collector({});
  collector.AddText("2026-01-02T03:04:05.678Z info task_started\nterminate called\n2026-01-02T03:04:0");
  collector.AddText("5.678Z debug x\n2026-01-02T03:04:05.678Z error y\n2026-01-02T03:04:05.678Z info no end");
  EXPECT_THAT(collector.TakeLines(), ElementsAre("terminate called", "2026-01-02T03:04:05.678Z error y"));
  EXPECT_EQ(collector.left_out(), 0U);
}

TEST(CaptureStandardError, CollectsWhatLibrariesWriteInTheThread) {
  testing::internal::CaptureStderr();
  CaptureStandardError();
  {
    LogCollector collector({});
    std::fprintf(stderr, "libpng error: %s\n", "Read Error");
    std::cerr << "imdecode: can't read " << 3 << "\n";
    std::thread([] { std::fprintf(stderr, "of another thread\n"); }).join();
    LogWarning("slow");
    EXPECT_THAT(collector.TakeLines(),
                ElementsAre("libpng error: Read Error", "imdecode: can't read 3", "warning slow"));
    EXPECT_THAT(collector.TakeLines(), IsEmpty());
  }
  std::fprintf(stderr, "after\n");
  const std::string text = testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("libpng error: Read Error\nimdecode: can't read 3\nof another thread\n"), std::string::npos);
  EXPECT_NE(text.find(" warning slow\n"), std::string::npos) << text;
  EXPECT_NE(text.find("after\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace depthfarm
