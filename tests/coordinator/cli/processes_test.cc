#include "coordinator/cli/processes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

namespace depthfarm {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kLong = seconds(60);  // a deadline of the test, never waited out

std::string ReadAll(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

TEST(ChildProcess, ReportsItsExitCode) {
  Result<ChildProcess> child = ChildProcess::Start("/bin/sh", {"-c", "exit 7"}, "");
  ASSERT_TRUE(child.ok()) << child.status().message();
  const std::optional<ProcessEnd> end = child->WaitFor(kLong);
  ASSERT_TRUE(end.has_value());
  EXPECT_EQ(end->exit_code, 7);
  EXPECT_EQ(Describe(*end), "exited with code 7");
}

TEST(ChildProcess, AProgramThatIsNotThereIsAnError) {
  const Result<ChildProcess> child = ChildProcess::Start("/nonexistent/program", {}, "");
  ASSERT_FALSE(child.ok());
  EXPECT_THAT(child.status().message(), testing::HasSubstr("/nonexistent/program"));
  EXPECT_THAT(child.status().message(), testing::HasSubstr("No such file"));
}

TEST(ChildProcess, AppendsItsOutputToTheLog) {
  const std::filesystem::path log = std::filesystem::path(testing::TempDir()) / "child_process_log";
  std::filesystem::remove(log);
  for (const char* word : {"one", "two"}) {
    Result<ChildProcess> child = ChildProcess::Start("/bin/sh", {"-c", "echo $0; echo err >&2", word}, log);
    ASSERT_TRUE(child.ok());
    ASSERT_TRUE(child->WaitFor(kLong).has_value());
  }
  EXPECT_EQ(ReadAll(log), "one\nerr\ntwo\nerr\n");
  std::filesystem::remove(log);
}

TEST(ChildProcess, StopEndsAProcessThatListens) {
  Result<ChildProcess> child = ChildProcess::Start("/bin/sleep", {"1000"}, "");
  ASSERT_TRUE(child.ok());
  EXPECT_FALSE(child->Poll().has_value());
  EXPECT_EQ(child->Stop(kLong).signal, SIGTERM);
}

TEST(ChildProcess, StopKillsAProcessThatDoesNotListen) {
  const std::filesystem::path ready = std::filesystem::path(testing::TempDir()) / "child_process_ready";
  std::filesystem::remove(ready);
  Result<ChildProcess> child = ChildProcess::Start(
      "/bin/sh", {"-c", "trap '' TERM; : > \"$0\"; while :; do sleep 1000; done", ready.string()}, "");
  ASSERT_TRUE(child.ok());
  const auto deadline = std::chrono::steady_clock::now() + kLong;
  while (!std::filesystem::exists(ready) && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  ASSERT_TRUE(std::filesystem::exists(ready));
  EXPECT_EQ(child->Stop(milliseconds(10)).signal, SIGKILL);
  std::filesystem::remove(ready);
}

TEST(ChildProcess, DestructionKillsIt) {
  pid_t pid = 0;
  {
    Result<ChildProcess> child = ChildProcess::Start("/bin/sleep", {"1000"}, "");
    ASSERT_TRUE(child.ok());
    pid = child->pid();
    EXPECT_EQ(::kill(pid, 0), 0);
  }
  EXPECT_NE(::kill(pid, 0), 0);
}

TEST(ChildProcess, HasAProcessGroupOfItsOwn) {
  Result<ChildProcess> child = ChildProcess::Start("/bin/sleep", {"1000"}, "");
  ASSERT_TRUE(child.ok());
  EXPECT_EQ(::getpgid(child->pid()), child->pid());
}

TEST(SiblingProgram, IsLookedForBesideTheRunningProgram) {
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe");
  const Result<std::filesystem::path> found = SiblingProgram(self.filename().string());
  ASSERT_TRUE(found.ok());
  EXPECT_EQ(*found, self);
  const Result<std::filesystem::path> missing = SiblingProgram("no-such-program");
  ASSERT_FALSE(missing.ok());
  EXPECT_THAT(missing.status().message(), testing::HasSubstr("no-such-program"));
}

}  // namespace
}  // namespace depthfarm
