#include "coordinator/service/note_pace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using std::chrono::minutes;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr TimePoint kStart{};

// How many of `count` notes are logged.
std::uint64_t Admitted(NotePace& pace, const std::string& event, std::uint64_t count, TimePoint now) {
  std::uint64_t admitted = 0;
  for (std::uint64_t i = 0; i < count; ++i) admitted += pace.Admit(event, now) ? 1 : 0;
  return admitted;
}

TEST(NotePace, AFloodIsLoggedInPartAndTheRestCounted) {
  NotePace pace;
  std::uint64_t logged = 0;
  std::uint64_t left_out = 0;
  constexpr int kSeconds = 600;
  constexpr std::uint64_t kEach = 1000;
  for (int second = 0; second < kSeconds; ++second) {
    const TimePoint now = kStart + seconds(second);
    logged += Admitted(pace, "worker_joined", kEach, now);
    for (const NotePace::LeftOut& told : pace.TakeLeftOut(now)) left_out += told.count;
  }
  EXPECT_LE(logged, 10 * NotePace::kMost);
  for (const NotePace::LeftOut& told : pace.TakeLeftOut(std::nullopt)) left_out += told.count;
  EXPECT_EQ(logged + left_out, kSeconds * kEach);
}

TEST(NotePace, AFarmThatWorksLosesNoLine) {
  NotePace pace;
  for (int minute = 0; minute < 10; ++minute) {
    const TimePoint now = kStart + minutes(minute);
    EXPECT_EQ(Admitted(pace, "task_done", NotePace::kMost, now), NotePace::kMost) << minute;
    EXPECT_THAT(pace.TakeLeftOut(now), IsEmpty()) << minute;
  }
  EXPECT_THAT(pace.TakeLeftOut(std::nullopt), IsEmpty());
}

TEST(NotePace, AFloodOfOneKindHidesNoneOfAnother) {
  NotePace pace;
  EXPECT_EQ(Admitted(pace, "late_result", 3 * NotePace::kMost, kStart), NotePace::kMost);
  EXPECT_TRUE(pace.Admit("job_failed", kStart));
}

TEST(NotePace, WhatIsLeftOutIsToldOnceWhenItsMinuteIsOver) {
  NotePace pace;
  (void)Admitted(pace, "late_result", NotePace::kMost + 7, kStart);
  EXPECT_THAT(pace.TakeLeftOut(kStart + seconds(59)), IsEmpty());
  EXPECT_FALSE(pace.Admit("late_result", kStart + seconds(61))) << "before it was told";
  EXPECT_THAT(pace.TakeLeftOut(kStart + seconds(62)), ElementsAre(NotePace::LeftOut{"late_result", 8}));
  EXPECT_THAT(pace.TakeLeftOut(kStart + minutes(5)), IsEmpty());
  EXPECT_TRUE(pace.Admit("late_result", kStart + minutes(5)));
}

TEST(NotePace, AtTheEndTheMinuteNeedNotBeOver) {
  NotePace pace;
  (void)Admitted(pace, "late_result", NotePace::kMost + 1, kStart);
  EXPECT_THAT(pace.TakeLeftOut(std::nullopt), ElementsAre(NotePace::LeftOut{"late_result", 1}));
}

}  // namespace
}  // namespace depthfarm
