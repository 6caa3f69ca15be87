// Keys: who may talk to a farm over tcp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

TEST_F(Curve, AKeyThatIsNotAuthorizedIsRefused) {
  const std::string others = folder_ / "others";
  ASSERT_EQ(Depthfarm({"keygen", "-o", others}).exit_code, 0);
  // It knows the coordinator, but the coordinator does not know it.
  fs::copy_file(fs::path(keys_) / "coordinator.pub", fs::path(others) / "coordinator.pub",
                fs::copy_options::overwrite_existing);
  const Outcome refused = Depthfarm({"jobs", "--coordinator", farm_->endpoint(), "--keys", others, "--timeout", "2"});
  EXPECT_EQ(refused.exit_code, 3) << refused.output;
  const Outcome admitted = Depthfarm({"jobs", "--coordinator", farm_->endpoint(), "--keys", keys_});
  EXPECT_EQ(admitted.exit_code, 0) << admitted.output;
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
