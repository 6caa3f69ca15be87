// Processes that are killed or stand still, again and again, at random moments of real jobs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/random.h"
#include "tests/system/disturbed_job.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

using std::chrono::milliseconds;
using testing::IsEmpty;

constexpr int kWorkers = 3;

// A number from the environment: deploy/kill-storm.sh asks for more than a test has time for.
int Setting(const char* name, int usual) {
  const char* value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nobody sets it
  return value == nullptr ? usual : std::atoi(value);
}

class KillStorm : public DisturbedJob {
 protected:
  void Pause(int from_ms, int to_ms) { std::this_thread::sleep_for(milliseconds(random_.Int(from_ms, to_ms))); }

  void AddWorkers(Farm& farm) {
    while (workers_.size() < kWorkers) workers_.push_back(farm.AddWorker({"--slots", random_.Chance(50) ? "1" : "2"}));
  }
  void KillWorker(Farm& farm, std::size_t which) {
    farm.worker(workers_[which]).Signal(SIGKILL);
    workers_.erase(workers_.begin() + static_cast<std::ptrdiff_t>(which));
  }
  // One process is killed and replaced, or stands still for a while: at times for more than a lease.
  void Disturb(Farm& farm) {
    const auto victim = static_cast<std::size_t>(random_.Int(0, kWorkers - 1));
    const int how = random_.Int(1, 10);
    if (how <= 4) {
      KillWorker(farm, victim);
      AddWorkers(farm);
    } else if (how <= 7) {
      farm.worker(workers_[victim]).Signal(SIGSTOP);
      Pause(100, random_.Chance(30) ? 9000 : 1500);
      farm.worker(workers_[victim]).Signal(SIGCONT);
    } else if (how <= 9) {
      ASSERT_TRUE(farm.RestartCoordinator(SIGKILL)) << farm.problem();
    } else {
      farm.SignalCoordinator(SIGSTOP);
      Pause(100, 3000);
      farm.SignalCoordinator(SIGCONT);
    }
  }
  [[nodiscard]] static v1::JobState StateOf(Farm& farm, std::uint64_t job) {
    const Result<v1::JobStatus> status = farm.client().GetStatus(job);
    return status.ok() ? status->state() : v1::JOB_STATE_UNSPECIFIED;
  }

  const int seed_ = Setting("DEPTHFARM_STORM_SEED", 1);
  test::Random random_{static_cast<std::uint64_t>(seed_)};
  std::vector<int> workers_;  // that are alive
};

TEST_F(KillStorm, EveryJobGivesItsBytes) {
  SCOPED_TRACE("seed " + std::to_string(seed_));
  int left = Setting("DEPTHFARM_STORM_KILLS", 8);
  const auto expected = Undisturbed();
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  int disturbed = 0;
  for (int round = 1; left > 0; ++round) {
    AddWorkers(farm);
    const std::string output = folder_ / ("storm-" + std::to_string(round));
    const std::uint64_t job = Submit(farm, output);
    v1::JobState state = v1::JOB_STATE_RUNNING;
    while (left > 0 && state != v1::JOB_STATE_DONE) {
      Pause(50, 1200);
      ASSERT_NO_FATAL_FAILURE(Disturb(farm));
      --left;
      state = StateOf(farm, job);
      disturbed += state == v1::JOB_STATE_RUNNING ? 1 : 0;
      // Four of its workers may have been killed under one task.
      if (state == v1::JOB_STATE_FAILED) {
        ASSERT_TRUE(farm.client().Retry(job).ok()) << farm.Logs();
      }
    }
    v1::JobStatus last = WaitForTheEnd(farm, job);
    if (last.state() == v1::JOB_STATE_FAILED) {
      EXPECT_THAT(last.error().message(), testing::HasSubstr("failed 4 times")) << farm.Logs();
      ASSERT_TRUE(farm.client().Retry(job).ok()) << farm.Logs();
      last = WaitForTheEnd(farm, job);
    }
    ASSERT_EQ(last.state(), v1::JOB_STATE_DONE) << last.error().message() << "\n" << farm.Logs();
    EXPECT_EQ(last.determinism_violations(), 0U);
    ASSERT_THAT(Differences(expected, DepthOf(output)), IsEmpty()) << farm.Logs();
    EXPECT_THAT(Leftovers(output), IsEmpty());
    // What they hold goes with them, so that the next job is computed anew.
    while (!workers_.empty()) KillWorker(farm, 0);
  }
  EXPECT_GT(disturbed, 0) << "every disturbance came when the job had ended";
}

}  // namespace
}  // namespace depthfarm::system_test
