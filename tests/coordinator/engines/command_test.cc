#include "coordinator/engines/command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <string>

namespace depthfarm {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::HasSubstr;

const CommandLimit kLong{.usual = seconds(60)};

TEST(RunCommand, ReturnsWhatAProgramWroteAndItsExitCode) {
  const Result<CommandOutput> ran = RunCommand({"sh", "-c", "cat; echo problem >&2; exit 3"}, "some\ninput", kLong);
  ASSERT_TRUE(ran.ok()) << ran.status().message();
  EXPECT_EQ(ran->exit_code, 3);
  EXPECT_EQ(ran->output, "some\ninput");
  EXPECT_EQ(ran->error, "problem\n");
}

TEST(RunCommand, TakesNoShell) {
  const Result<CommandOutput> ran = RunCommand({"echo", "$HOME; `id` *"}, "", kLong);
  ASSERT_TRUE(ran.ok());
  EXPECT_EQ(ran->output, "$HOME; `id` *\n");
}

TEST(RunCommand, MoreThanAPipeHoldsGoesBothWays) {
  const std::string input(3'000'000, 'x');
  const Result<CommandOutput> ran = RunCommand({"cat"}, input, kLong);
  ASSERT_TRUE(ran.ok());
  EXPECT_EQ(ran->output, input);
}

TEST(RunCommand, AProgramThatDoesNotWantItsInputIsNoFailure) {
  const Result<CommandOutput> ran = RunCommand({"true"}, std::string(3'000'000, 'x'), kLong);
  ASSERT_TRUE(ran.ok()) << ran.status().message();
  EXPECT_EQ(ran->exit_code, 0);
}

TEST(RunCommand, SaysWhatCannotBeRunOrDidNotEndWell) {
  EXPECT_THAT(RunCommand({"depthfarm-no-such-program"}, "", kLong).status().message(),
              HasSubstr("cannot run depthfarm-no-such-program: No such file"));
  EXPECT_THAT(RunCommand({"sh", "-c", "kill -9 $$"}, "", kLong).status().message(), HasSubstr("signal 9"));
  // With what it started.
  EXPECT_THAT(RunCommand({"sh", "-c", "sleep 1000 & sleep 1000"}, "", {.usual = milliseconds(100)}).status().message(),
              HasSubstr("did not end in time"));
  EXPECT_THAT(RunCommand({"sh", "-c", "head -c 20000000 /dev/zero"}, "", kLong).status().message(),
              HasSubstr("wrote too much"));
}

TEST(RunCommand, WhoIsInAHurryDoesNotWaitAsLong) {
  const auto start = std::chrono::steady_clock::now();
  int questions = 0;
  const CommandLimit limit{
      .usual = seconds(1000), .in_hurry = [&questions] { return ++questions > 3; }, .hurried = milliseconds(100)};
  EXPECT_THAT(RunCommand({"sleep", "1000"}, "", limit).status().message(), HasSubstr("did not end in time"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, seconds(500));
  EXPECT_EQ(questions, 4);
}

TEST(RunCommand, AHurryHasNoMoreTimeThanUsual) {
  const CommandLimit limit{.usual = milliseconds(100), .in_hurry = [] { return true; }, .hurried = seconds(1000)};
  EXPECT_THAT(RunCommand({"sleep", "1000"}, "", limit).status().message(), HasSubstr("did not end in time"));
  EXPECT_TRUE(RunCommand({"true"}, "", {.usual = seconds(60), .in_hurry = [] { return true; }}).ok());
}

TEST(ShellQuoted, AShellTakesBackWhatWasGiven) {
  for (const std::string& word : {std::string("plain"), std::string("/a/b-c_d.e:f=g,h@i%j+k"), std::string(""),
                                  std::string("two words"), std::string("it's"), std::string("$HOME `id` \"x\" \\ *"),
                                  std::string("a\nb"), std::string("~root"), std::string("#no comment")}) {
    const Result<CommandOutput> ran = RunCommand({"sh", "-c", "printf %s " + ShellQuoted(word)}, "", kLong);
    ASSERT_TRUE(ran.ok());
    EXPECT_EQ(ran->output, word) << ShellQuoted(word);
  }
  EXPECT_EQ(ShellQuoted("plain/path"), "plain/path");
}

}  // namespace
}  // namespace depthfarm
