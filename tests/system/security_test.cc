// Keys: who may talk to a farm over tcp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <optional>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::SizeIs;

fs::perms Mode(const fs::path& file) { return fs::status(file).permissions(); }

TEST(Keygen, SecretKeysAreReadableByTheirOwnerOnly) {
  const TemporaryFolder folder;
  const fs::path keys = folder.path() / "keys";
  const Outcome made = Depthfarm({"keygen", "-o", keys.string()});
  ASSERT_EQ(made.exit_code, 0) << made.output;
  EXPECT_EQ(Mode(keys), fs::perms::owner_all);
  for (const char* name : {"coordinator", "worker", "client"}) {
    EXPECT_EQ(Mode(keys / (std::string(name) + ".key")), fs::perms::owner_read | fs::perms::owner_write) << name;
    EXPECT_TRUE(fs::exists(keys / (std::string(name) + ".pub"))) << name;
  }
  EXPECT_TRUE(fs::exists(keys / "authorized"));
}

TEST(Keygen, NeverReplacesKeys) {
  const TemporaryFolder folder;
  const fs::path keys = folder.path() / "keys";
  ASSERT_EQ(Depthfarm({"keygen", "-o", keys.string()}).exit_code, 0);
  const std::string before = ReadFile(keys / "coordinator.key");
  EXPECT_EQ(Depthfarm({"keygen", "-o", keys.string()}).exit_code, 2);
  EXPECT_EQ(ReadFile(keys / "coordinator.key"), before);
}

class Curve : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(Depthfarm({"keygen", "-o", keys_}).exit_code, 0);
    farm_.emplace("tcp://127.0.0.1:*", keys_);
    ASSERT_TRUE(farm_->ok()) << farm_->problem();
  }

  TemporaryFolder folder_;
  std::string keys_ = folder_ / "keys";
  std::optional<Farm> farm_;
};

TEST_F(Curve, AJobRunsOverTcpWithTheFarmsKeys) {
  farm_->AddWorker();
  farm_->AddWorker();
  const std::string sequence = RenderScene(folder_.path() / "scene");
  const std::string output = folder_ / "out";
  const Outcome waited = Depthfarm(Words{"submit", sequence, "-o", output, "--wait", "--level-blocks", "4"} +
                                   SmallJob() + farm_->Options());
  EXPECT_EQ(waited.exit_code, 0) << waited.output << farm_->Logs();
  EXPECT_THAT(DepthOf(output), SizeIs(3 * 4 + 1));
}

// A folder of keys that the farm's coordinator does not know, but which knows the coordinator.
std::string KeysOfSomebodyElse(const TemporaryFolder& folder, const std::string& farm_keys) {
  std::string keys = folder / "others";
  EXPECT_EQ(Depthfarm({"keygen", "-o", keys}).exit_code, 0);
  fs::copy_file(fs::path(farm_keys) / "coordinator.pub", fs::path(keys) / "coordinator.pub",
                fs::copy_options::overwrite_existing);
  return keys;
}

std::size_t Count(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST_F(Curve, AKeyThatIsNotAuthorizedIsRefused) {
  const std::string others = KeysOfSomebodyElse(folder_, keys_);
  const Outcome refused = Depthfarm({"jobs", "--coordinator", farm_->endpoint(), "--keys", others, "--timeout", "2"});
  EXPECT_EQ(refused.exit_code, 3) << refused.output;
  const Outcome admitted = Depthfarm({"jobs", "--coordinator", farm_->endpoint(), "--keys", keys_});
  EXPECT_EQ(admitted.exit_code, 0) << admitted.output;
  // It is told in the log, and not once for each time that it tried.
  EXPECT_TRUE(WaitUntil([&] { return Count(farm_->CoordinatorLogged(), "refused_so_far") == 1U; })) << farm_->Logs();
}

TEST_F(Curve, AnotherCoordinatorsKeyIsNotBelieved) {
  const std::string others = folder_ / "others";
  ASSERT_EQ(Depthfarm({"keygen", "-o", others}).exit_code, 0);
  fs::copy_file(fs::path(others) / "coordinator.pub", fs::path(keys_) / "coordinator.pub",
                fs::copy_options::overwrite_existing);
  EXPECT_EQ(Depthfarm({"jobs", "--coordinator", farm_->endpoint(), "--keys", keys_, "--timeout", "2"}).exit_code, 3);
}

TEST_F(Curve, AClientWithoutKeysGetsNoAnswer) {
  EXPECT_EQ(Depthfarm({"jobs", "--coordinator", farm_->endpoint(), "--insecure", "--timeout", "2"}).exit_code, 3);
}

TEST_F(Curve, AKeyFileThatOthersCanReadIsRefused) {
  fs::permissions(fs::path(keys_) / "client.key", fs::perms::group_read, fs::perm_options::add);
  const Outcome refused = Depthfarm({"jobs", "--coordinator", farm_->endpoint(), "--keys", keys_});
  EXPECT_EQ(refused.exit_code, 2) << refused.output;
  EXPECT_THAT(refused.output, testing::HasSubstr("client.key"));
}

TEST_F(Curve, AWorkersKeyMaySubmitNothing) {
  const fs::path impostor = folder_.path() / "impostor";
  fs::create_directories(impostor);
  fs::copy_file(fs::path(keys_) / "coordinator.pub", impostor / "coordinator.pub");
  fs::copy_file(fs::path(keys_) / "worker.key", impostor / "client.key");
  fs::copy_file(fs::path(keys_) / "worker.pub", impostor / "client.pub");
  fs::permissions(impostor / "client.key", fs::perms::owner_read | fs::perms::owner_write);
  const Outcome refused = Depthfarm({"cancel", "1", "--coordinator", farm_->endpoint(), "--keys", impostor.string()});
  EXPECT_EQ(refused.exit_code, 2) << refused.output;
}

TEST_F(Curve, TheListOfKeysIsReadAgainOnSighupWhileAJobGoesOn) {
  const std::string others = KeysOfSomebodyElse(folder_, keys_);
  const fs::path authorized = fs::path(keys_) / "authorized";
  const std::string before = ReadFile(authorized);
  const auto reread = [&](const std::string& list, const std::string& event) {
    std::ofstream(authorized) << list;
    const std::size_t lines = Count(farm_->CoordinatorLogged(), event);
    farm_->SignalCoordinator(SIGHUP);
    return WaitUntil([&] { return Count(farm_->CoordinatorLogged(), event) > lines; });
  };
  const auto workers = [&] { return farm_->client().ListWorkers().value().size(); };

  farm_->AddWorker();
  const std::string sequence = RenderScene(folder_.path() / "scene", {.frames = 12});
  const std::string output = folder_ / "out";
  const Outcome submitted = Depthfarm(Words{"submit", sequence, "-o", output} + SmallJob() + farm_->Options());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output;

  // Added: it may come.
  std::string other_key = ReadFile(fs::path(others) / "worker.pub");
  other_key.pop_back();
  ASSERT_TRUE(reread(before + "work " + other_key + " other\n", "keys_reread")) << farm_->Logs();
  const int added = farm_->AddWorker({}, others);
  EXPECT_TRUE(WaitUntil([&] { return workers() == 2U; })) << farm_->Logs();

  // Broken: as it was.
  ASSERT_TRUE(reread("work " + other_key + " other\nrubbish\n", "keys_not_reread")) << farm_->Logs();
  EXPECT_NE(farm_->CoordinatorLogged().find("line 2: role is 'rubbish'"), std::string::npos);
  EXPECT_EQ(workers(), 2U) << farm_->Logs();

  // Removed: its worker ends, and one that comes with that key is not let in.
  ASSERT_TRUE(reread(before, "keys_reread")) << farm_->Logs();
  EXPECT_TRUE(WaitUntil([&] { return farm_->worker(added).Poll().has_value(); })) << farm_->Logs();
  EXPECT_NE(farm_->LogOf(added).find("taken off the farm"), std::string::npos);
  EXPECT_EQ(workers(), 1U) << farm_->Logs();
  EXPECT_EQ(Depthfarm({"jobs", "--coordinator", farm_->endpoint(), "--keys", others, "--timeout", "2"}).exit_code, 3);

  const Outcome watched = Depthfarm(Words{"watch", "1"} + farm_->Options());
  EXPECT_EQ(watched.exit_code, 0) << watched.output << farm_->Logs();
  EXPECT_EQ(Depthfarm({"verify", output}).exit_code, 0);
}

TEST_F(Curve, AWorkerReadsAgainOnSighupWhoMayFetchFromIt) {
  const int worker = farm_->AddWorker();
  const auto logged = [&](const std::string& event) {
    return WaitUntil([&] { return farm_->LogOf(worker).find(event) != std::string::npos; });
  };
  ASSERT_TRUE(logged("welcomed")) << farm_->Logs();
  std::ofstream(fs::path(keys_) / "authorized", std::ios::app) << "# one more line\n";
  farm_->worker(worker).Signal(SIGHUP);
  EXPECT_TRUE(logged("keys_reread")) << farm_->Logs();
  std::ofstream(fs::path(keys_) / "authorized", std::ios::app) << "rubbish\n";
  farm_->worker(worker).Signal(SIGHUP);
  EXPECT_TRUE(logged("keys_not_reread")) << farm_->Logs();
  EXPECT_FALSE(farm_->worker(worker).Poll().has_value());
}

// Secret keys of a folder, as they stand in its files.
Words SecretsOf(const fs::path& keys) {
  Words secrets;
  for (const char* name : {"coordinator", "worker", "client"}) {
    secrets.push_back(ReadFile(keys / (std::string(name) + ".key")));
    secrets.back().pop_back();
  }
  return secrets;
}

TEST_F(Curve, SecretKeysAreInNoLogAndOnNoCommandLine) {
  const int worker = farm_->AddWorker({"--log-level", "debug"});
  const std::string sequence = RenderScene(folder_.path() / "scene");
  const Outcome waited =
      Depthfarm(Words{"submit", sequence, "-o", folder_ / "out", "--wait"} + SmallJob() + farm_->Options());
  ASSERT_EQ(waited.exit_code, 0) << waited.output << farm_->Logs();
  std::string seen = farm_->Logs() + waited.output;
  for (const pid_t pid : {farm_->coordinator_pid(), farm_->worker(worker).pid()}) {
    const fs::path process = fs::path("/proc") / std::to_string(pid);
    seen += ReadFile(process / "cmdline") + ReadFile(process / "environ");
  }
  EXPECT_NE(seen.find("--keys"), std::string::npos);
  for (const std::string& secret : SecretsOf(keys_)) EXPECT_EQ(seen.find(secret), std::string::npos);
}

TEST(Insecure, AJobRunsOverLoopbackTcpWithoutKeys) {
  Farm farm("tcp://127.0.0.1:*");
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  farm.AddWorker();
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene");
  const Outcome waited = Depthfarm(Words{"submit", sequence, "-o", folder / "out", "--wait", "--level-blocks", "4"} +
                                   SmallJob() + farm.Options());
  EXPECT_EQ(waited.exit_code, 0) << waited.output << farm.Logs();
  EXPECT_THAT(DepthOf(folder / "out"), SizeIs(3 * 4 + 1));
}

}  // namespace
}  // namespace depthfarm::system_test
