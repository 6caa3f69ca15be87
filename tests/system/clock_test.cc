// Clocks of coordinator and workers that are set forward and back while a job runs.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): setenv is POSIX
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

#include "common/text/utc_time.h"
#include "tests/system/disturbed_job.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

using std::chrono::hours;
using std::chrono::seconds;
using testing::HasSubstr;

// The clock of the day of programs that are started while it is set up for them.
class Clock {
 public:
  explicit Clock(std::string file) : file_(std::move(file)) { Move(seconds(0)); }

  // From now on so far from the true time.
  void Move(seconds offset) const {
    const int file = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    const std::int64_t value = offset.count();
    EXPECT_EQ(::pwrite(file, &value, sizeof(value), 0), static_cast<ssize_t>(sizeof(value)));  // at once
    ::close(file);
  }

  // What is started while it lives has this clock.
  // NOLINTBEGIN(concurrency-mt-unsafe): no other thread of the test looks at the environment
  class SetUpFor {
   public:
    explicit SetUpFor(const Clock& clock) {
      ::setenv("DEPTHFARM_CLOCK_OFFSET", clock.file_.c_str(), 1);
      ::setenv("LD_PRELOAD", DEPTHFARM_JUMPING_CLOCK, 1);
    }
    ~SetUpFor() {
      ::unsetenv("LD_PRELOAD");
      ::unsetenv("DEPTHFARM_CLOCK_OFFSET");
    }
    SetUpFor(const SetUpFor&) = delete;
    SetUpFor& operator=(const SetUpFor&) = delete;
  };
  // NOLINTEND(concurrency-mt-unsafe)

 private:
  std::string file_;
};

// The year that the log has a line of.
std::string YearAt(seconds offset) {
  return FormatUtc(std::chrono::system_clock::now() + offset).substr(0, 5);  // "2031-"
}

class ClockJump : public DisturbedJob {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the sanitizers must be loaded before anything else";
#endif
    DisturbedJob::SetUp();
    expected_ = Undisturbed();
    const Clock::SetUpFor coordinator(coordinators_);
    farm_.emplace();
    ASSERT_TRUE(farm_->ok()) << farm_->problem();
  }
  int AddWorker(const Clock& clock) {
    const Clock::SetUpFor worker(clock);
    return farm_->AddWorker();
  }

  const Clock coordinators_{folder_ / "clock-of-the-coordinator"};
  const Clock first_{folder_ / "clock-of-the-first-worker"};
  const Clock second_{folder_ / "clock-of-the-second-worker"};
  std::map<std::string, std::string> expected_;
  std::optional<Farm> farm_;
};

TEST_F(ClockJump, ForwardAndBackChangesNothing) {
  constexpr hours kYears(24 * 365 * 5);
  const int first = AddWorker(first_);
  const int second = AddWorker(second_);
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 10));
  first_.Move(kYears);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 30));
  second_.Move(-kYears);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 50));
  coordinators_.Move(kYears);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 70));
  first_.Move(-kYears);
  coordinators_.Move(-kYears);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 90));
  for (const Clock* clock : {&first_, &second_, &coordinators_}) clock->Move(seconds(1));
  ExpectDone(*farm_, job, output, expected_);
  ExpectNextJobIsRight(*farm_, expected_);
  // Nobody was taken for silent, no lease for over.
  const v1::JobStatus status = farm_->client().GetStatus(job).value();
  EXPECT_EQ(status.retries(), 0U) << farm_->Logs();
  EXPECT_EQ(farm_->client().ListWorkers().value().size(), 2U);
  // The clocks did jump.
  EXPECT_THAT(farm_->LogOf(first), HasSubstr("\n" + YearAt(kYears)));
  EXPECT_THAT(farm_->LogOf(second), HasSubstr("\n" + YearAt(-kYears)));
  EXPECT_THAT(farm_->CoordinatorLogged(), HasSubstr("\n" + YearAt(kYears)));
}

TEST_F(ClockJump, BackBetweenTwoCoordinatorsLosesNoJob) {
  AddWorker(first_);
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForFrames(*farm_, job, 1));
  coordinators_.Move(-hours(1));
  {
    const Clock::SetUpFor coordinator(coordinators_);
    ASSERT_TRUE(farm_->RestartCoordinator(SIGKILL)) << farm_->problem();
  }
  ExpectDone(*farm_, job, output, expected_);
  ExpectNextJobIsRight(*farm_, expected_);
}

}  // namespace
}  // namespace depthfarm::system_test
