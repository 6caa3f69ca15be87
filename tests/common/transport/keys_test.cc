#include "common/transport/keys.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>

#include "common/transport/farm_keys.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

TEST(CurveKeys, GeneratedOnesAreKeysAndDiffer) {
  const Result<CurveKeys> first = GenerateCurveKeys();
  const Result<CurveKeys> second = GenerateCurveKeys();
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_TRUE(IsCurveKey(first->public_key) && IsCurveKey(first->secret_key));
  EXPECT_NE(first->secret_key, second->secret_key);
}

TEST(CurveKeys, OtherTextIsNoKey) {
  EXPECT_FALSE(IsCurveKey(""));
  EXPECT_FALSE(IsCurveKey(std::string(39, 'a')));
  EXPECT_FALSE(IsCurveKey(std::string(40, '~')));
}

TEST(KeyFiles, ASecretComesBackAndIsClosedToOthers) {
  const testing_support::TemporaryFolder folder;
  const std::string secret = GenerateCurveKeys()->secret_key;
  ASSERT_TRUE(WriteSecretKey(folder.path() / "a.key", secret).ok());
  struct stat info {};
  ASSERT_EQ(::stat((folder.path() / "a.key").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0600U);
  const Result<std::string> read = ReadSecretKey(folder.path() / "a.key");
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(*read, secret);
}

TEST(KeyFiles, ASecretOpenToGroupOrOthersIsRefused) {
  const testing_support::TemporaryFolder folder;
  const auto file = folder.path() / "a.key";
  ASSERT_TRUE(WriteSecretKey(file, GenerateCurveKeys()->secret_key).ok());
  for (const mode_t mode : {0640, 0604, 0620, 0602}) {
    ASSERT_EQ(::chmod(file.c_str(), mode), 0);
    const Result<std::string> read = ReadSecretKey(file);
    EXPECT_EQ(read.status().code(), ErrorCode::kInvalidArgument);
    EXPECT_NE(read.status().message().find("chmod 600"), std::string::npos);
  }
}

TEST(KeyFiles, AreNeverReplaced) {
  const testing_support::TemporaryFolder folder;
  ASSERT_TRUE(WritePublicKey(folder.path() / "a.pub", GenerateCurveKeys()->public_key).ok());
  EXPECT_EQ(WritePublicKey(folder.path() / "a.pub", GenerateCurveKeys()->public_key).code(),
            ErrorCode::kInvalidArgument);
}

TEST(KeyFiles, RubbishIsRefused) {
  const testing_support::TemporaryFolder folder;
  std::ofstream(folder.path() / "a.pub") << "not a key\n";
  EXPECT_EQ(ReadPublicKey(folder.path() / "a.pub").status().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(ReadPublicKey(folder.path() / "absent").status().code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(ReadSecretKey(folder.path()).status().code(), ErrorCode::kInvalidArgument);
}

TEST(FarmKeys, CreatedOnesServeAllThreePrograms) {
  const testing_support::TemporaryFolder folder;
  const auto dir = folder.path() / "keys";
  ASSERT_TRUE(CreateFarmKeys(dir).ok());
  const Result<CoordinatorKeys> coordinator = ReadCoordinatorKeys(dir);
  const Result<WorkerKeys> worker = ReadWorkerKeys(dir);
  const Result<ClientKeys> client = ReadClientKeys(dir);
  ASSERT_TRUE(coordinator.ok() && worker.ok() && client.ok());
  EXPECT_EQ(worker->coordinator_public_key, coordinator->own.public_key);
  EXPECT_EQ(client->coordinator_public_key, coordinator->own.public_key);
  EXPECT_EQ(RoleOfUser(coordinator->allowed.at(worker->own.public_key)).value(), Role::kWork);
  EXPECT_EQ(RoleOfUser(coordinator->allowed.at(client->own.public_key)).value(), Role::kAdmin);
  EXPECT_EQ(worker->allowed_peers.size(), 2U);
  EXPECT_TRUE(worker->allowed_peers.contains(worker->own.public_key));
  EXPECT_TRUE(worker->allowed_peers.contains(client->own.public_key));
  EXPECT_EQ(CreateFarmKeys(dir).code(), ErrorCode::kInvalidArgument);
}

TEST(FarmKeys, AWorkerWithoutTheListTrustsItsOwnKeyAlone) {
  const testing_support::TemporaryFolder folder;
  ASSERT_TRUE(CreateFarmKeys(folder.path()).ok());
  std::filesystem::remove(folder.path() / "authorized");
  const Result<WorkerKeys> worker = ReadWorkerKeys(folder.path());
  ASSERT_TRUE(worker.ok());
  EXPECT_EQ(worker->allowed_peers.size(), 1U);
}

TEST(Authorized, ErrorsNameTheLine) {
  const testing_support::TemporaryFolder folder;
  const auto file = folder.path() / "authorized";
  const std::string key = GenerateCurveKeys()->public_key;
  const auto message = [&](const std::string& text) {
    std::ofstream(file) << "# comment\n\n" << text;
    const Result<AllowedKeys> allowed = ReadAuthorized(file);
    return allowed.ok() ? "" : allowed.status().message();
  };
  EXPECT_NE(message("boss " + key + "\n").find("line 3: role is 'boss'"), std::string::npos);
  EXPECT_NE(message("work short\n").find("line 3"), std::string::npos);
  EXPECT_NE(message("work " + key + "\nadmin " + key + "\n").find("line 4: the key is listed twice"),
            std::string::npos);
  EXPECT_NE(message("work " + key + " name more\n").find("'more'"), std::string::npos);
  EXPECT_EQ(message("work " + key + " node7\n"), "");
}

TEST(Authorized, AListThatOthersCanWriteIsRefused) {
  const testing_support::TemporaryFolder folder;
  ASSERT_TRUE(CreateFarmKeys(folder.path()).ok());
  const auto file = folder.path() / "authorized";
  ASSERT_TRUE(ReadAuthorized(file).ok());
  for (const mode_t mode : {0664, 0646}) {
    ASSERT_EQ(::chmod(file.c_str(), mode), 0);
    const Result<AllowedKeys> read = ReadAuthorized(file);
    EXPECT_EQ(read.status().code(), ErrorCode::kInvalidArgument);
    EXPECT_NE(read.status().message().find("chmod go-w"), std::string::npos) << read.status().message();
  }
}

TEST(FarmKeys, AFolderThatWasThereStaysAsOpenAsItWas) {
  const testing_support::TemporaryFolder folder;
  const auto open = std::filesystem::perms(0755);
  std::filesystem::permissions(folder.path(), open);
  ASSERT_TRUE(CreateFarmKeys(folder.path()).ok());
  EXPECT_EQ(std::filesystem::status(folder.path()).permissions(), open);
  ASSERT_TRUE(CreateFarmKeys(folder.path() / "made").ok());
  EXPECT_EQ(std::filesystem::status(folder.path() / "made").permissions(), std::filesystem::perms(0700));
}

TEST(FarmKeys, TheListIsClosedToOthersWhateverTheUmask) {
  const testing_support::TemporaryFolder folder;
  const mode_t before = ::umask(0);
  const Status made = CreateFarmKeys(folder.path());
  ::umask(before);
  ASSERT_TRUE(made.ok()) << made.message();
  EXPECT_TRUE(ReadAuthorized(folder.path() / "authorized").ok());
  EXPECT_TRUE(ReadCoordinatorKeys(folder.path()).ok());
}

TEST(RoleOfUser, NeedsARoleAndAName) {
  EXPECT_EQ(RoleOfUser("submit:anna").value(), Role::kSubmit);
  EXPECT_FALSE(RoleOfUser("").ok());
  EXPECT_FALSE(RoleOfUser("work").ok());
  EXPECT_FALSE(RoleOfUser("worker:x").ok());
}

}  // namespace
}  // namespace depthfarm
