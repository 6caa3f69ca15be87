#include "worker/minding/minder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

void Say(const std::string& text) { (void)!::write(STDERR_FILENO, text.data(), text.size()); }

// Without what the test program does at its end.
[[noreturn]] void End(int code) { ::_exit(code); }

volatile sig_atomic_t stops = 0;

TEST(RunMinded, TellsTheExitCode) {
  const Result<MindedEnd> end = RunMinded({}, []() -> int { End(7); });
  ASSERT_TRUE(end.ok()) << end.status().message();
  EXPECT_EQ(end->exit_code, 7);
  EXPECT_EQ(end->signal, 0);
  EXPECT_THAT(end->last_words.lines, IsEmpty());
  EXPECT_EQ(Describe(*end), "exited with code 7");
}

TEST(RunMinded, TellsTheSignalAndTheLastWords) {
  testing::internal::CaptureStderr();
  const Result<MindedEnd> end = RunMinded({}, []() -> int {
    Say("first\nsecond\nno end of line");
    (void)::signal(SIGSEGV, SIG_DFL);  // a sanitizer's handler would tell of it
    (void)::raise(SIGSEGV);
    End(0);
  });
  const std::string passed_on = testing::internal::GetCapturedStderr();
  ASSERT_TRUE(end.ok()) << end.status().message();
  EXPECT_EQ(end->signal, SIGSEGV);
  EXPECT_EQ(Describe(*end), "was killed by signal 11 (Segmentation fault)");
  EXPECT_THAT(end->last_words.lines, ElementsAre("first", "second", "no end of line"));
  EXPECT_EQ(passed_on, "first\nsecond\nno end of line");
}

TEST(RunMinded, KeepsTheEndOfMuchAndPassesOnAll) {
  constexpr int kLines = 100'000;
  testing::internal::CaptureStderr();
  const Result<MindedEnd> end = RunMinded({}, []() -> int {
    for (int i = 0; i < kLines; ++i) Say("line " + std::to_string(i) + "\n");
    (void)::raise(SIGKILL);
    End(0);
  });
  const std::string passed_on = testing::internal::GetCapturedStderr();
  ASSERT_TRUE(end.ok()) << end.status().message();
  ASSERT_THAT(end->last_words.lines, SizeIs(64));
  EXPECT_EQ(end->last_words.lines.back(), "line 99999");
  EXPECT_EQ(end->last_words.left_out, kLines - 64U);
  EXPECT_EQ(std::count(passed_on.begin(), passed_on.end(), '\n'), kLines);
}

TEST(RunMinded, GoesOnWhenNothingCanBeWrittenAnyMore) {
  const Result<MindedEnd> end = RunMinded({}, []() -> int {
    (void)::close(STDERR_FILENO);
    ::usleep(50'000);
    End(3);
  });
  ASSERT_TRUE(end.ok()) << end.status().message();
  EXPECT_EQ(end->exit_code, 3);
}

// Runs `minding` in a process of its own, which is sent signals; how that ends.
int StatusOf(const std::function<int()>& minding, const std::function<void(pid_t minder)>& meanwhile) {
  const pid_t minder = ::fork();
  if (minder == 0) End(minding());
  meanwhile(minder);
  int status = 0;
  EXPECT_EQ(::waitpid(minder, &status, 0), minder);
  return status;
}

// A pipe through which processes tell the test how far they are.
class Word {
 public:
  Word() { EXPECT_EQ(::pipe(static_cast<int*>(ends_)), 0); }
  ~Word() {
    (void)::close(ends_[0]);
    (void)::close(ends_[1]);
  }
  Word(const Word&) = delete;
  Word& operator=(const Word&) = delete;
  void Give(char word = '.') const { (void)!::write(ends_[1], &word, 1); }
  [[nodiscard]] char Await() const {
    char word = 0;
    (void)!::read(ends_[0], &word, 1);
    return word;
  }

 private:
  int ends_[2] = {-1, -1};
};

// Works until it was asked to stop `times` times, and says so.
int WorkUntilStopped(const Word& word, int times) {
  word.Give('r');
  sigset_t none;
  sigemptyset(&none);
  for (int told = 0; told < times;) {
    ::usleep(1000);
    if (stops <= told) continue;
    ++told;
    word.Give('s');
  }
  return 5;
}

void InstallStop() {
  stops = 0;
  struct sigaction handler {};
  handler.sa_handler = [](int) { stops = stops + 1; };
  (void)::sigaction(MindedStop(), &handler, nullptr);
}

TEST(RunMinded, PassesOnEachRequestToStopOnceThoughTheWholeGroupGetsIt) {
  const Word word;
  const int status = StatusOf(
      [&] {
        (void)::setpgid(0, 0);
        InstallStop();
        const Result<MindedEnd> end = RunMinded({}, [&]() -> int { End(WorkUntilStopped(word, 2)); });
        return end.ok() ? end->exit_code + end->signal : -1;
      },
      [&](pid_t minder) {
        ASSERT_EQ(word.Await(), 'r');
        (void)::kill(-minder, SIGTERM);
        ASSERT_EQ(word.Await(), 's');
        (void)::kill(-minder, SIGINT);
        ASSERT_EQ(word.Await(), 's');
      });
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 5);
}

TEST(RunMinded, IsKilledWithItsMinder) {
  const Word word;
  const Word gone;
  const int status = StatusOf(
      [&] {
        const Result<MindedEnd> end = RunMinded({}, [&]() -> int {
          word.Give();
          for (;;) ::pause();
        });
        return 0;
      },
      [&](pid_t minder) {
        (void)word.Await();
        // The child is the only one of the minder.
        const std::string children =
            "/proc/" + std::to_string(minder) + "/task/" + std::to_string(minder) + "/children";
        FILE* file = std::fopen(children.c_str(), "r");
        ASSERT_NE(file, nullptr);
        int child = 0;
        ASSERT_EQ(std::fscanf(file, "%d", &child), 1);
        (void)std::fclose(file);
        (void)::kill(minder, SIGKILL);
        for (int i = 0; i < 10'000 && ::kill(child, 0) == 0; ++i) ::usleep(1000);
        EXPECT_NE(::kill(child, 0), 0) << "still there after ten seconds";
      });
  EXPECT_TRUE(WIFSIGNALED(status));
}

TEST(RunMinded, IsStoppedWhenTheParentOfItsMinderEnds) {
  const Word word;
  const int status = StatusOf(
      [&] {
        if (::fork() == 0) {  // the minder; its parent ends
          InstallStop();
          const Result<MindedEnd> end =
              RunMinded({.end_with_parent = true}, [&]() -> int { End(WorkUntilStopped(word, 1)); });
          word.Give(end.ok() && end->exit_code == 5 ? 'e' : 'x');
          End(0);
        }
        return word.Await() == 'r' ? 0 : 1;
      },
      [&](pid_t) {});
  ASSERT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(word.Await(), 's');
  EXPECT_EQ(word.Await(), 'e');
}

TEST(EndLike, EndsWithTheSameSignalOrCode) {
  const auto end_of = [](const MindedEnd& end) { return StatusOf([&]() -> int { EndLike(end); }, [](pid_t) {}); };
  const int killed = end_of({.exit_code = 0, .signal = SIGKILL, .last_words = {}});
  ASSERT_TRUE(WIFSIGNALED(killed));
  EXPECT_EQ(WTERMSIG(killed), SIGKILL);
  const int aborted = end_of({.exit_code = 0, .signal = SIGABRT, .last_words = {}});
  ASSERT_TRUE(WIFSIGNALED(aborted));
  EXPECT_EQ(WTERMSIG(aborted), SIGABRT);
  EXPECT_FALSE(WCOREDUMP(aborted));
}

}  // namespace
}  // namespace depthfarm
