#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "common/log/log.h"
#include "tests/simulation/random_run.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm::simulation {
namespace {

constexpr std::uint64_t kSeedsOfATest = 250;

class SimulationTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { ASSERT_TRUE(SetLogLevel("off").ok()); }

  const testing_support::TemporaryFolder scratch_{
      std::filesystem::is_directory("/dev/shm") ? "/dev/shm" : std::filesystem::temp_directory_path()};
};

class FarmWithFaults : public SimulationTest, public ::testing::WithParamInterface<int> {};

TEST_P(FarmWithFaults, EndsEveryJobWithTheRightBytesAndKeepsNothing) {
  const std::uint64_t first = 1 + kSeedsOfATest * static_cast<std::uint64_t>(GetParam());
  Tally tally;
  for (std::uint64_t seed = first; seed < first + kSeedsOfATest; ++seed) {
    const RunResult result = RunSeed(seed, scratch_.path().string());
    for (const std::string& problem : result.problems) ADD_FAILURE() << problem;
    tally.Add(result.tally);
    if (HasFailure()) return;
  }
  // Things did go wrong, and jobs were done all the same.
  EXPECT_GT(tally.jobs_done, kSeedsOfATest);
  EXPECT_GT(tally.coordinator_crashes, kSeedsOfATest / 2);
  EXPECT_GT(tally.torn_writes, kSeedsOfATest / 10);
  EXPECT_GT(tally.worker_crashes, kSeedsOfATest / 2);
  EXPECT_GT(tally.deaths_told, kSeedsOfATest / 5);
  EXPECT_GT(tally.late_results, kSeedsOfATest / 10);
  EXPECT_GT(tally.given_back, kSeedsOfATest / 10);
  EXPECT_GT(tally.duplicates, kSeedsOfATest / 10);
  EXPECT_GT(tally.duplicates_won, kSeedsOfATest / 50);
}

INSTANTIATE_TEST_SUITE_P(Seeds, FarmWithFaults, ::testing::Range(0, 8));

TEST_F(SimulationTest, ASeedGivesTheSameRunAgain) {
  for (const std::uint64_t seed : {3, 14, 159}) {
    EXPECT_EQ(RunSeed(seed, scratch_.path().string()).trace, RunSeed(seed, scratch_.path().string()).trace);
  }
}

}  // namespace
}  // namespace depthfarm::simulation
