// Workers of one host that share a folder of artifacts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <map>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;

// Artifact keys by how often these workers fetched them.
std::map<std::string, int> Fetched(const Farm& farm, std::initializer_list<int> workers) {
  std::map<std::string, int> times;
  const std::string event = "artifact_fetched key=";
  for (const int worker : workers) {
    const std::string log = farm.LogOf(worker);
    for (std::size_t at = log.find(event); at != std::string::npos; at = log.find(event, at + 1))
      ++times[log.substr(at + event.size(), 64)];
  }
  return times;
}

class SharedCache : public testing::Test {
 protected:
  void SetUp() override { sequence_ = RenderScene(folder_.path() / "scene", {.cameras = 3, .frames = 4}); }

  std::map<std::string, std::string> Undisturbed() {
    const Outcome run = Depthfarm(Words{"run", sequence_, "-o", folder_ / "undisturbed", "--workers", "1"} + job_);
    EXPECT_EQ(run.exit_code, 0) << run.output;
    return DepthOf(folder_ / "undisturbed");
  }
  Outcome Submit(const Farm& farm, const std::string& output) {
    return Depthfarm(Words{"submit", sequence_, "-o", folder_ / output, "--wait", "--json"} + job_ + farm.Options());
  }
  Words Sharing() { return {"--cache-dir", folder_ / "cache", "--log-level", "debug"}; }

  TemporaryFolder folder_;
  std::string sequence_;
  // One GOP: all frames need the artifacts of the I frame.
  Words job_ = {"--segments", "1200", "--levels", "32", "--gop", "4", "--level-blocks", "3"};
};

TEST_F(SharedCache, FetchesEachArtifactOncePerHost) {
  const auto expected = Undisturbed();
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const int second = farm.AddWorker(Sharing());
  const int third = farm.AddWorker(Sharing() + Words{"--slots", "2"});
  const Outcome submitted = Submit(farm, "out");
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output << farm.Logs();
  EXPECT_THAT(Differences(expected, DepthOf(folder_ / "out")), IsEmpty());
  const std::map<std::string, int> fetched = Fetched(farm, {second, third});
  EXPECT_FALSE(fetched.empty()) << "they should have needed something of the first worker";
  for (const auto& [key, times] : fetched) EXPECT_EQ(times, 1) << key;
}

// Each with a folder of its own: the I frame, which all frames of the GOP read, comes to a worker once.
TEST_F(SharedCache, OrOncePerWorkerWithoutOne) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  const Words logging = {"--log-level", "debug"};
  const int first = farm.AddWorker(logging);
  const int second = farm.AddWorker(logging + Words{"--slots", "2"});
  const Outcome submitted = Submit(farm, "out");
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output << farm.Logs();
  EXPECT_FALSE(Fetched(farm, {first, second}).empty()) << "they should have needed something of each other";
  for (const int worker : {first, second}) {
    for (const auto& [key, times] : Fetched(farm, {worker})) EXPECT_EQ(times, 1) << key << " on worker " << worker;
  }
}

TEST_F(SharedCache, WorkersOfOneFolderFetchNothingFromEachOther) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  for (int i = 0; i < 3; ++i) farm.AddWorker(Sharing());
  const Outcome submitted = Submit(farm, "out");
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output << farm.Logs();
  EXPECT_THAT(Fetched(farm, {0, 1, 2}), IsEmpty());
}

TEST_F(SharedCache, AFolderThatIsTooSmallAndAKilledWorkerChangeNothing) {
  const auto expected = Undisturbed();
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker(Sharing() + Words{"--cache-size", "1MB"});
  farm.AddWorker();
  const int victim = farm.AddWorker(Sharing() + Words{"--cache-size", "1MB"});
  const Outcome handed_in =
      Depthfarm(Words{"submit", sequence_, "-o", folder_ / "out", "--json"} + job_ + farm.Options());
  ASSERT_EQ(handed_in.exit_code, 0) << handed_in.output;
  ASSERT_TRUE(WaitUntil([&] {
    const Result<v1::JobStatus> job = farm.client().GetStatus(1);
    return !job.ok() || job->frames_done() > 0 || job->state() != v1::JOB_STATE_RUNNING;
  }));
  farm.worker(victim).Signal(SIGKILL);
  const Outcome watched = Depthfarm(Words{"watch", "1", "--json"} + farm.Options());
  ASSERT_EQ(watched.exit_code, 0) << watched.output << farm.Logs();
  EXPECT_THAT(Differences(expected, DepthOf(folder_ / "out")), IsEmpty());
}

}  // namespace
}  // namespace depthfarm::system_test
