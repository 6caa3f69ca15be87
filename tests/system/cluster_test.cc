// Farms whose workers come and go: on this machine, by ssh, for a coordinator that was there before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "tests/system/managed_cluster.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

class ClusterTest : public testing::Test {
 protected:
  void SetUp() override {
    sequence_ = RenderScene(folder_.path() / "scene", {.cameras = 3, .frames = 4});
    const Outcome run =
        Depthfarm(Words{"run", sequence_, "-o", folder_ / "undisturbed", "--workers", "1"} + SmallJob());
    ASSERT_EQ(run.exit_code, 0) << run.output;
    expected_ = DepthOf(folder_ / "undisturbed");
  }
  void ExpectDepth(const std::string& output) {
    EXPECT_THAT(Differences(expected_, DepthOf(folder_ / output)), IsEmpty());
    EXPECT_THAT(Leftovers(folder_ / output), IsEmpty());
  }
  TemporaryFolder folder_;
  ManagedCluster cluster_{folder_.path() / "cluster"};
  std::string sequence_;
  std::map<std::string, std::string> expected_;
};

TEST_F(ClusterTest, WorkersComeWithTheWorkAndLeaveAfterIt) {
  const Outcome up = cluster_.Call("up", {"--workers", "0..2", "--idle-seconds", "1"});
  ASSERT_EQ(up.exit_code, 0) << up.output;
  EXPECT_THAT(up.output, HasSubstr("export DEPTHFARM_COORDINATOR=tcp://127.0.0.1:"));
  EXPECT_EQ(cluster_.Status().at("joined"), 0);
  const Outcome again = cluster_.Call("up", {});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.output, HasSubstr("is up already"));

  const Outcome job =
      Depthfarm(Words{"submit", sequence_, "-o", folder_ / "out", "--wait"} + SmallJob() + cluster_.Target());
  ASSERT_EQ(job.exit_code, 0) << job.output << cluster_.ManagerLog();
  ExpectDepth("out");
  EXPECT_TRUE(cluster_.Comes([](const nlohmann::json& status) { return status.at("joined") == 0; }))
      << cluster_.ManagerLog();
  EXPECT_THAT(cluster_.ManagerLog(), HasSubstr("is not needed and leaves"));

  ASSERT_EQ(cluster_.Call("down").exit_code, 0) << cluster_.ManagerLog();
  const Outcome down = cluster_.Call("status");
  EXPECT_EQ(down.exit_code, 2);
  EXPECT_THAT(down.output, HasSubstr("is not up"));
}

TEST_F(ClusterTest, JobsOutliveTheirCluster) {
  ASSERT_EQ(cluster_.Call("up", {"--workers", "0..1"}).exit_code, 0);
  const Outcome submitted =
      Depthfarm(Words{"submit", sequence_, "-o", folder_ / "out"} + SmallJob() + cluster_.Target());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output;
  ASSERT_EQ(cluster_.Call("down").exit_code, 0) << cluster_.ManagerLog();
  ASSERT_EQ(cluster_.Call("up", {"--workers", "0..2"}).exit_code, 0) << cluster_.ManagerLog();
  const Outcome watched = Depthfarm(Words{"watch", "1"} + cluster_.Target());
  EXPECT_EQ(watched.exit_code, 0) << watched.output << cluster_.ManagerLog();
  ExpectDepth("out");
}

TEST_F(ClusterTest, AKilledManagerLeavesNothingThatDownDoesNotTidyUp) {
  ASSERT_EQ(cluster_.Call("up", {"--workers", "1..1"}).exit_code, 0);
  ASSERT_TRUE(cluster_.Comes([](const nlohmann::json& status) { return status.at("joined") == 1; }))
      << cluster_.ManagerLog();
  const pid_t manager = cluster_.Status().at("manager").at("process");
  const std::vector<pid_t> coordinators = ChildrenOf(manager, "depthfarm-coordinator");
  const std::vector<pid_t> workers = ChildrenOf(manager, "depthfarm-worker");
  ASSERT_EQ(coordinators.size(), 1U);
  ASSERT_EQ(workers.size(), 1U);
  ASSERT_EQ(::kill(manager, SIGKILL), 0);
  EXPECT_TRUE(WaitUntil([&] { return IsGone(coordinators[0]) && IsGone(workers[0]); }));
  const Outcome status = cluster_.Call("status");
  EXPECT_EQ(status.exit_code, 3);
  EXPECT_THAT(status.output, HasSubstr("without a manager"));
  EXPECT_EQ(cluster_.Call("down").exit_code, 0);
  EXPECT_EQ(cluster_.Call("up", {"--workers", "1"}).exit_code, 0) << cluster_.ManagerLog();
}

TEST_F(ClusterTest, ACoordinatorThatDiesIsStartedAgain) {
  ASSERT_EQ(cluster_.Call("up", {"--workers", "1"}).exit_code, 0);
  const Words target = cluster_.Target();
  const std::vector<pid_t> coordinators =
      ChildrenOf(cluster_.Status().at("manager").at("process"), "depthfarm-coordinator");
  ASSERT_EQ(coordinators.size(), 1U);
  ASSERT_EQ(::kill(coordinators[0], SIGKILL), 0);
  ASSERT_TRUE(WaitUntil([&] { return cluster_.ManagerLog().find("starting it again") != std::string::npos; }));
  const Outcome job = Depthfarm(Words{"submit", sequence_, "-o", folder_ / "out", "--wait"} + SmallJob() + target);
  ASSERT_EQ(job.exit_code, 0) << job.output << cluster_.ManagerLog();
  ExpectDepth("out");
}

TEST_F(ClusterTest, ACoordinatorThatWasThereBeforeGetsWorkersAndStays) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  const Outcome up = cluster_.Call("up", {"--coordinator", farm.endpoint(), "--workers", "1..2"});
  ASSERT_EQ(up.exit_code, 0) << up.output;
  const Outcome job =
      Depthfarm(Words{"submit", sequence_, "-o", folder_ / "out", "--wait"} + SmallJob() + farm.Options());
  ASSERT_EQ(job.exit_code, 0) << job.output << cluster_.ManagerLog();
  ExpectDepth("out");
  ASSERT_EQ(cluster_.Call("down").exit_code, 0) << cluster_.ManagerLog();
  const auto workers = farm.client().ListWorkers();
  ASSERT_TRUE(workers.ok()) << "it must still be there";
  EXPECT_THAT(*workers, IsEmpty());
}

TEST_F(ClusterTest, WorkersThatCannotStartAreToldAndNotAskedForInHaste) {
  const Outcome up = cluster_.Call("up", {"--workers", "1", "--worker-program", "/bin/false"});
  ASSERT_EQ(up.exit_code, 0) << up.output;
  EXPECT_TRUE(WaitUntil([&] {
    return cluster_.ManagerLog().find("no worker is started for 5 s") != std::string::npos;
  })) << cluster_.ManagerLog();
}

TEST_F(ClusterTest, WhatCannotBeIsSaid) {
  struct Row {
    Words options;
    const char* expected;
  };
  const std::string empty = folder_ / "hosts";
  std::ofstream(empty) << "# none yet\n";
  const std::vector<Row> rows = {
      {{"--engine", "cloud"}, "engine is 'cloud', expected local, slurm or ssh"},
      {{"--engine", "ssh"}, "--engine ssh needs --hosts"},
      {{"--engine", "ssh", "--hosts", empty}, "no host is named"},
      {{"--engine", "ssh", "--hosts", folder_ / "missing"}, "missing"},
      {{"--partition", "p"}, "--partition is for --engine slurm"},
      {{"--name", "a b"}, "--name is 'a b'"},
      {{"--tags", "a b"}, "--tags"},
      {{"--coordinator", "head:7700"}, "head:7700"},
      {{"--coordinator", "tcp://127.0.0.1:1", "--insecure"}, "127.0.0.1:1"},
      {{"--coordinator", "tcp://127.0.0.1:1"}, "keys"},
  };
  for (const Row& row : rows) {
    const Outcome up = cluster_.Call("up", row.options);
    EXPECT_NE(up.exit_code, 0) << row.expected;
    EXPECT_THAT(up.output, HasSubstr(row.expected));
    EXPECT_EQ(cluster_.Call("status").exit_code, 2) << row.expected;
  }
  const Outcome run = Depthfarm({"run", sequence_, "-o", folder_ / "out", "--hosts", empty});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.output, HasSubstr("need --engine slurm or --engine ssh"));
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

// Slurm whose controller takes requests and then hangs.
class HungSlurm : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(folder_ / "bin");
    Command("sbatch", "cat >/dev/null");
    Command("scancel", "exit 0");
    Command("squeue", "touch " + (folder_ / "asked") + "; exec sleep 1000");
    const char* path = ::getenv("PATH");  // NOLINT(concurrency-mt-unsafe): one thread
    path_ = path != nullptr ? path : "";
    ::setenv("PATH", ((folder_ / "bin") + ":" + path_).c_str(), 1);  // NOLINT(concurrency-mt-unsafe)
  }
  void TearDown() override { ::setenv("PATH", path_.c_str(), 1); }  // NOLINT(concurrency-mt-unsafe)
  void Command(const std::string& name, const std::string& line) {
    const fs::path file = folder_.path() / "bin" / name;
    std::ofstream(file) << "#!/bin/sh\n" << line << "\n";
    fs::permissions(file, fs::perms::owner_all);
  }

  TemporaryFolder folder_;
  std::string path_;
};

TEST_F(HungSlurm, DoesNotHoldWhoInterruptsARun) {
  const std::string sequence = RenderScene(folder_.path() / "scene");
  const Words words =
      Words{"run", sequence, "-o", folder_ / "out", "--engine", "slurm", "--state", folder_ / "state"} + SmallJob();
  Result<ChildProcess> run = ChildProcess::Start(Program("depthfarm"), words, folder_ / "log");
  ASSERT_TRUE(run.ok()) << run.status().message();
  ASSERT_TRUE(WaitUntil([&] { return fs::exists(folder_ / "asked") || run->Poll(); }));
  run->Signal(SIGINT);
  // A command of Slurm may take a minute, and two are under way from here to the end.
  const std::optional<ProcessEnd> end = run->WaitFor(std::chrono::seconds(60));
  ASSERT_TRUE(end.has_value()) << ReadFile(folder_ / "log");
  EXPECT_EQ(end->exit_code, 130) << ReadFile(folder_ / "log");
  EXPECT_FALSE(fs::exists(folder_.path() / "out" / "depth.json"));
}

// A real sshd, for this user alone, on the loopback address.
class SshTest : public ClusterTest {
 protected:
  void SetUp() override {
    if (!fs::exists("/usr/sbin/sshd") || !fs::exists("/usr/bin/ssh")) {
      GTEST_SKIP() << "no sshd here: deploy/install-deps.sh test installs it";
    }
    ClusterTest::SetUp();
    for (const char* key : {"host", "user"}) {
      const auto made = ChildProcess::Start("/usr/bin/ssh-keygen",
                                            {"-q", "-t", "ed25519", "-N", "", "-f", folder_ / key}, "/dev/null");
      ASSERT_TRUE(made.ok());
      ChildProcess process = std::move(const_cast<Result<ChildProcess>&>(made)).value();
      ASSERT_TRUE(process.WaitFor(kDeadline)->ok());
    }
    std::error_code ignored;
    if (::geteuid() == 0) fs::create_directories("/run/sshd", ignored);  // where a privileged one insists on it
    for (int attempt = 0; attempt < 20 && !sshd_; ++attempt) {
      port_ = std::to_string(20000 + (::getpid() * 31 + attempt * 977) % 20000);
      std::ofstream(folder_ / "sshd_config")
          << "ListenAddress 127.0.0.1\nPort " << port_ << "\nHostKey " << folder_ / "host"
          << "\nAuthorizedKeysFile " << folder_ / "user.pub"
          << "\nStrictModes no\nUsePAM no\nPasswordAuthentication no\nPermitRootLogin yes\nPidFile none\n";
      auto sshd =
          ChildProcess::Start("/usr/sbin/sshd", {"-D", "-e", "-f", folder_ / "sshd_config"}, folder_ / "sshd.log");
      ASSERT_TRUE(sshd.ok()) << sshd.status().message();
      // It says so, or ends since the port is another one's.
      (void)WaitUntil([&] {
        return ReadFile(folder_ / "sshd.log").find("Server listening on 127.0.0.1 port " + port_) !=
                   std::string::npos ||
               sshd->Poll();
      });
      if (!sshd->Poll()) sshd_.emplace(std::move(*sshd));
    }
    ASSERT_TRUE(sshd_) << ReadFile(folder_ / "sshd.log");
    std::ofstream(folder_ / "hosts") << "127.0.0.1 2\n";
  }
  Words Ssh() {
    return {"--engine",
            "ssh",
            "--hosts",
            folder_ / "hosts",
            "--engine-option=-p" + port_,
            "--engine-option=-i" + (folder_ / "user"),
            "--engine-option=-oStrictHostKeyChecking=no",
            "--engine-option=-oUserKnownHostsFile=/dev/null",
            "--host",
            "127.0.0.1"};
  }

  std::string port_;
  std::optional<ChildProcess> sshd_;
};

TEST_F(SshTest, RunsAJobOnHostsThatSshReaches) {
  const Outcome run = Depthfarm(Words{"run", sequence_, "-o", folder_ / "out", "--workers", "1..2"} +
                                Words{"--state", folder_ / "run"} + Ssh() + SmallJob());
  ASSERT_EQ(run.exit_code, 0) << run.output << ReadFile(folder_ / "sshd.log");
  ExpectDepth("out");
  EXPECT_THAT(ReadFile(folder_.path() / "run" / "log" / "worker-1.log"), HasSubstr("worker_stopped"));
}

TEST_F(SshTest, AHostWithoutRoomIsSaidBefore) {
  const Outcome up = cluster_.Call("up", Ssh() + Words{"--workers", "0..3"});
  EXPECT_EQ(up.exit_code, 1);
  EXPECT_THAT(up.output, HasSubstr("has room for 2 workers, --workers asks for up to 3"));
}

}  // namespace
}  // namespace depthfarm::system_test
