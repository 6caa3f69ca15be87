#include "coordinator/engines/process_engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <functional>
#include <set>
#include <sstream>
#include <thread>

#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

bool WaitUntil(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

std::string ReadAll(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// A program in place of the worker, or of ssh.
std::string Script(const testing_support::TemporaryFolder& folder, const std::string& name, const std::string& body) {
  const std::string file = folder.Write(name, "#!/bin/sh\n" + body);
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  return file;
}

TEST(ParseSshHosts, TakesHostsAndHowManyWorkers) {
  const auto hosts = ParseSshHosts("# render nodes\nnode1 4\n\n  anna@node2\t2 \nnode3\n");
  ASSERT_TRUE(hosts.ok()) << hosts.status().message();
  EXPECT_THAT(*hosts, ElementsAre(SshHost{"node1", 4}, SshHost{"anna@node2", 2}, SshHost{"node3", 1}));
}

TEST(ParseSshHosts, SaysWhichLineIsWrong) {
  for (const auto& [text, expected] : std::initializer_list<std::pair<const char*, const char*>>{
           {"", "no host is named"},
           {"# none\n", "no host is named"},
           {"node1 0\n", "line 1: '0' workers on node1"},
           {"node1 four\n", "line 1: 'four' workers"},
           {"node1 4x\n", "line 1: '4x' workers"},
           {"node1 2000\n", "line 1: '2000' workers"},
           {"node1\nnode1 2\n", "line 2: host node1 is there twice"},
           {"node1 2 3\n", "line 1: '3' is too much"},
           {"-oProxyCommand=x 1\n", "line 1: '-oProxyCommand=x' is no host"}}) {
    const auto hosts = ParseSshHosts(text);
    EXPECT_EQ(hosts.status().code(), ErrorCode::kInvalidArgument) << text;
    EXPECT_THAT(hosts.status().message(), HasSubstr(expected)) << text;
  }
}

TEST(ProcessEngine, WorkersOfThisMachineComeAndGo) {
  const testing_support::TemporaryFolder folder;
  const std::string worker = Script(folder, "worker", "echo \"$@\"\nexec sleep 1000\n");
  ProcessEngine engine({.hosts = {}, .ssh_arguments = {}, .log_dir = folder.path()},
                       {.cluster = "c", .worker_program = worker, .coordinator = "ipc:///c"});
  EXPECT_THAT(engine.List().value(), IsEmpty());
  ASSERT_TRUE(engine.Launch(2).ok());
  const std::vector<Pilot> pilots = engine.List().value();
  ASSERT_THAT(pilots, SizeIs(2));
  EXPECT_EQ(pilots[0].id, "1");
  EXPECT_TRUE(pilots[0].running);
  ASSERT_TRUE(WaitUntil([&] { return !ReadAll(folder.path() / "worker-2.log").empty(); }));
  const std::string said = ReadAll(folder.path() / "worker-2.log");
  EXPECT_THAT(said, HasSubstr("--coordinator ipc:///c"));
  EXPECT_THAT(said, HasSubstr("--name c.2.0"));
  EXPECT_THAT(said, HasSubstr("--exit-with-parent"));
  ASSERT_TRUE(engine.Cancel({"1", "77"}).ok());
  EXPECT_TRUE(WaitUntil([&] { return engine.List().value().size() == 1; }));
  EXPECT_EQ(engine.List().value()[0].id, "2");
  // Ids are not used again.
  ASSERT_TRUE(engine.Launch(1).ok());
  EXPECT_EQ(engine.List().value()[1].id, "3");
}

TEST(ProcessEngine, SshHostsAreDealtWorkersByTheirRoom) {
  const testing_support::TemporaryFolder folder;
  // As ssh does: the shell of the other side gets the last word.
  const std::string ssh = Script(folder, "ssh", "for last; do :; done\necho \"$@\"\nexec sh -c \"$last\"\n");
  const std::string worker = Script(folder, "remote worker", "echo remote \"$@\"\nexec sleep 1000\n");
  ProcessEngine engine(
      {.hosts = {{"one", 1}, {"two", 2}}, .ssh_arguments = {"-p2222"}, .ssh_program = ssh, .log_dir = folder.path()},
      {.cluster = "c", .worker_program = worker, .coordinator = "tcp://head:7700", .tags = {"a b"}});
  ASSERT_TRUE(engine.Launch(3).ok());
  std::multiset<std::string> hosts;
  const std::vector<Pilot> pilots = engine.List().value();
  for (const Pilot& pilot : pilots) hosts.insert(pilot.host);
  EXPECT_THAT(hosts, ElementsAre("one", "two", "two"));
  const Status full = engine.Launch(1);
  EXPECT_EQ(full.code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(full.message(), HasSubstr("no room for 1 more workers beside 3"));
  ASSERT_TRUE(WaitUntil([&] { return ReadAll(folder.path() / "worker-1.log").find("\nremote") != std::string::npos; }));
  const std::string said = ReadAll(folder.path() / "worker-1.log");
  EXPECT_THAT(said, HasSubstr("BatchMode=yes"));
  EXPECT_THAT(said, HasSubstr("-p2222 -- two exec '"));
  EXPECT_THAT(said, HasSubstr("\nremote --coordinator tcp://head:7700"));
  EXPECT_THAT(said, HasSubstr("--name c.1.0"));
}

TEST(ProcessEngine, SaysWhatCannotBeStarted) {
  const testing_support::TemporaryFolder folder;
  ProcessEngine engine({.hosts = {}, .ssh_arguments = {}, .log_dir = folder.path()},
                       {.cluster = "c", .worker_program = "/nonexistent/worker", .coordinator = "ipc:///c"});
  EXPECT_THAT(engine.Launch(1).message(), HasSubstr("/nonexistent/worker"));
}

}  // namespace
}  // namespace depthfarm
