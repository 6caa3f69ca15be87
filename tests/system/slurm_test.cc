// A real Slurm on this machine (slurm/lab.sh): workers as its jobs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <string>

#include "coordinator/engines/command.h"
#include "tests/system/managed_cluster.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

std::string Slurm(const Words& words) {
  const Result<CommandOutput> ran = RunCommand(words, "", {.usual = kDeadline});
  return ran.ok() ? ran->output + ran->error : ran.status().message();
}

class SlurmTest : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* daemon : {"slurmctld", "slurmd", "munged"}) {
      if (!fs::exists(std::string("/usr/sbin/") + daemon)) {
        GTEST_SKIP() << "no " << daemon << " here: deploy/install-deps.sh test installs it";
      }
    }
    // Its ports may be somebody else's.
    std::string said;
    for (int attempt = 0; attempt < 5 && !up_; ++attempt) {
      lab_ = folder_ / ("lab" + std::to_string(attempt));
      const std::string port = std::to_string(20000 + (::getpid() * 37 + attempt * 977) % 20000);
      said = Slurm({kLab, "up", lab_, "3", port});
      up_ = said.find("lab.sh:") == std::string::npos && said.find("error") == std::string::npos;
      if (!up_) Slurm({kLab, "down", lab_});
    }
    ASSERT_TRUE(up_) << said;
    ::setenv("SLURM_CONF", (lab_ + "/slurm.conf").c_str(), 1);   // NOLINT(concurrency-mt-unsafe): one thread
    ::setenv("XDG_STATE_HOME", (folder_ / "state").c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
    sequence_ = RenderScene(folder_.path() / "scene", {.cameras = 4, .frames = 24});
    const Outcome run = Depthfarm(Words{"run", sequence_, "-o", folder_ / "undisturbed", "--workers", "1"} + job_);
    ASSERT_EQ(run.exit_code, 0) << run.output;
    expected_ = DepthOf(folder_ / "undisturbed");
  }
  void TearDown() override {
    (void)cluster_.Call("down");  // of a test that failed: while its engine is there
    if (up_) Slurm({kLab, "down", lab_});
  }

  static std::string Queue() { return Slurm({"squeue", "--noheader"}); }
  std::string Logs() {
    std::string text = cluster_.ManagerLog() + Queue() + Slurm({"sinfo", "-N"});
    return text + ReadFile(lab_ + "/log/slurmctld.log");
  }
  void ExpectDepth(const std::string& output) {
    EXPECT_THAT(Differences(expected_, DepthOf(folder_ / output)), IsEmpty());
    EXPECT_THAT(Leftovers(folder_ / output), IsEmpty());
  }

  static constexpr const char* kLab = DEPTHFARM_SLURM_LAB;
  TemporaryFolder folder_;
  ManagedCluster cluster_{folder_.path() / "cluster"};
  std::string lab_;
  bool up_ = false;
  std::string sequence_;
  // Some ten seconds of one core: the manager looks every two.
  Words job_ = {"--segments", "2500", "--levels", "200", "--gop", "2"};
  std::map<std::string, std::string> expected_;
};

TEST_F(SlurmTest, RunBringsWorkersUpForAJobAndLeavesNothing) {
  const Outcome run = Depthfarm(Words{"run", sequence_, "-o", folder_ / "out", "--engine", "slurm", "--workers", "0..3",
                                      "--slurm-partition", "batch", "--time", "0:30:00", "--worker-memory", "2GB"} +
                                job_);
  ASSERT_EQ(run.exit_code, 0) << run.output << Logs();
  ExpectDepth("out");
  EXPECT_TRUE(WaitUntil([] { return Queue().empty(); })) << Queue();
  EXPECT_TRUE(fs::is_empty(folder_ / "state/depthfarm/clusters")) << "folders of runs must go with them";
  const Outcome refused = Depthfarm(Words{"run", sequence_, "-o", folder_ / "out2", "--engine", "slurm",
                                          "--slurm-partition", "nowhere", "--workers", "1"} +
                                    job_);
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_THAT(refused.output, HasSubstr("invalid partition"));
}

// A node with all that runs on it.
void KillNode(const std::string& lab, const std::string& node, const std::string& pilot) {
  // Its daemon first, or it would tell that the job has ended.
  std::ifstream pid_file(lab + "/" + node + ".pid");
  pid_t slurmd = 0;
  if (pid_file >> slurmd) ::kill(slurmd, SIGKILL);
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const std::string command = ReadFile(entry.path() / "cmdline");
    if (command.find("depthfarm-worker") == std::string::npos || command.find("." + pilot + ".") == std::string::npos)
      continue;
    ::kill(static_cast<pid_t>(std::stol(entry.path().filename().string())), SIGKILL);
  }
}

TEST_F(SlurmTest, AClusterGrowsLosesANodeAndShrinks) {
  const Outcome up = cluster_.Call("up", {"--engine", "slurm", "--workers", "1..3", "--idle-seconds", "2", "--slots",
                                          "2", "--cache-dir", folder_ / "cache", "--worker-memory", "2GB"});
  ASSERT_EQ(up.exit_code, 0) << up.output << Logs();
  ASSERT_TRUE(cluster_.Comes([](const nlohmann::json& status) { return status.at("joined") == 1; })) << Logs();
  const Words target = cluster_.Target();
  const Outcome job = Depthfarm(Words{"submit", sequence_, "-o", folder_ / "out"} + job_ + target);
  ASSERT_EQ(job.exit_code, 0) << job.output;
  // Two slots have work at once: each pilot takes two of the four GOPs.
  ASSERT_TRUE(cluster_.Comes([](const nlohmann::json& status) { return status.at("pilots").size() >= 2; })) << Logs();
  const nlohmann::json pilots = cluster_.Status().at("pilots");
  const auto running = std::ranges::find_if(pilots, [](const nlohmann::json& pilot) { return pilot.at("running"); });
  ASSERT_NE(running, pilots.end());
  KillNode(lab_, running->at("host"), running->at("id"));
  const Outcome watched = Depthfarm(Words{"watch", "1"} + target);
  ASSERT_EQ(watched.exit_code, 0) << watched.output << Logs();
  ExpectDepth("out");

  // What is idle leaves, what Slurm has to start again somewhere is not needed; one worker stays and takes the next
  // job.
  EXPECT_TRUE(cluster_.Comes([](const nlohmann::json& status) {
    return status.at("joined") == 1 && status.at("pilots").size() == 1;
  })) << Logs();
  const Outcome next = Depthfarm(Words{"submit", sequence_, "-o", folder_ / "next", "--wait"} + job_ + target);
  EXPECT_EQ(next.exit_code, 0) << next.output << Logs();
  ExpectDepth("next");
  EXPECT_EQ(cluster_.Call("down").exit_code, 0) << Logs();
  EXPECT_TRUE(WaitUntil([] { return Queue().empty(); })) << Queue();
}

// The manager and the coordinator are a job of Slurm themselves; a worker is preempted and comes back with its cache.
TEST_F(SlurmTest, AClusterOfBatchJobsAloneSurvivesPreemption) {
  const Outcome up = cluster_.Call("up", {"--engine", "slurm", "--workers", "1", "--batch", "--cache-dir",
                                          folder_ / "cache", "--worker-memory", "2GB"});
  ASSERT_EQ(up.exit_code, 0) << up.output << Logs();
  EXPECT_THAT(Queue(), HasSubstr("depthfar"));
  const Words target = cluster_.Target();
  const Outcome job = Depthfarm(Words{"submit", sequence_, "-o", folder_ / "out", "--wait"} + job_ + target);
  ASSERT_EQ(job.exit_code, 0) << job.output << Logs();
  ExpectDepth("out");

  const std::string pilot = cluster_.Status().at("pilots").at(0).at("id");
  EXPECT_EQ(Slurm({"scontrol", "requeue", pilot}), "");
  const std::filesystem::path log = cluster_.Log("worker-" + pilot);
  ASSERT_TRUE(WaitUntil([&] {
    return Depthfarm(Words{"workers", "--json"} + target).output.find("." + pilot + ".1\"") != std::string::npos;
  })) << Logs();
  const std::string restart = ReadFile(log).substr(ReadFile(log).rfind("worker_started"));
  EXPECT_EQ(restart.find("held=0\n"), std::string::npos) << "it should have found its artifacts again: " << restart;
  const Outcome again = Depthfarm(Words{"submit", sequence_, "-o", folder_ / "again", "--wait"} + job_ + target);
  ASSERT_EQ(again.exit_code, 0) << again.output << Logs();
  ExpectDepth("again");

  EXPECT_EQ(cluster_.Call("down").exit_code, 0) << Logs();
  EXPECT_TRUE(WaitUntil([] { return Queue().empty(); })) << Queue();
}

}  // namespace
}  // namespace depthfarm::system_test
