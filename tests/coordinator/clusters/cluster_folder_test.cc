#include "coordinator/clusters/cluster_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(ClusterFolder, IsMadePrivateAndKeepsWhatItIsTold) {
  const testing_support::TemporaryFolder parent;
  const fs::path path = parent.path() / "a" / "b";
  EXPECT_EQ(ClusterFolder::Open(path).status().code(), ErrorCode::kInvalidArgument);
  const Result<ClusterFolder> folder = ClusterFolder::Make(path);
  ASSERT_TRUE(folder.ok()) << folder.status().message();
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
  EXPECT_EQ(folder->ReadRecord().value().has_value(), false);

  ClusterOptions options;
  options.name = "render";
  options.workers = {2, 7};
  ASSERT_TRUE(folder->WriteOptions(options).ok());
  ASSERT_TRUE(ClusterFolder::Open(path).ok());
  EXPECT_EQ(folder->ReadOptions().value(), options);

  ASSERT_TRUE(
      folder->WriteRecord({options, "tcp://head:7700", "/keys", "render-1x2", "head", 4711, "2024-05-17T08:30:00Z"})
          .ok());
  const auto record = folder->ReadRecord();
  ASSERT_TRUE(record.ok() && record->has_value());
  EXPECT_EQ((*record)->options, options);
  EXPECT_EQ((*record)->coordinator, "tcp://head:7700");
  EXPECT_EQ((*record)->keys_dir, "/keys");
  EXPECT_EQ((*record)->instance, "render-1x2");
  EXPECT_EQ((*record)->manager_host, "head");
  EXPECT_EQ((*record)->manager_pid, 4711);
  folder->RemoveRecord();
  EXPECT_EQ(folder->ReadRecord().value().has_value(), false);
}

TEST(ClusterFolder, RefusesOneThatOthersMayEnter) {
  const testing_support::TemporaryFolder parent;
  const fs::path path = parent.path() / "open";
  fs::create_directory(path);
  fs::permissions(path, fs::perms::owner_all | fs::perms::group_exec);
  const auto folder = ClusterFolder::Make(path);
  EXPECT_EQ(folder.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(folder.status().message(), HasSubstr("others may enter"));
}

TEST(ClusterFolder, OneManagerHasIt) {
  const testing_support::TemporaryFolder parent;
  const ClusterFolder folder = ClusterFolder::Make(parent.path() / "c").value();
  auto lock = folder.TryLock();
  ASSERT_TRUE(lock.ok());
  ASSERT_NE(*lock, nullptr);
  EXPECT_EQ(folder.TryLock().value(), nullptr);
  lock->reset();
  EXPECT_NE(folder.TryLock().value(), nullptr);
}

TEST(ClusterFolder, AManagerIsAskedToEndTheCluster) {
  const testing_support::TemporaryFolder parent;
  const ClusterFolder folder = ClusterFolder::Make(parent.path() / "c").value();
  EXPECT_FALSE(folder.AskedDown());
  ASSERT_TRUE(folder.AskDown().ok());
  EXPECT_TRUE(folder.AskedDown());
  folder.ForgetDown();
  EXPECT_FALSE(folder.AskedDown());
}

TEST(ClusterFolder, ABrokenRecordIsNamed) {
  const testing_support::TemporaryFolder parent;
  const ClusterFolder folder = ClusterFolder::Make(parent.path() / "c").value();
  for (const char* broken : {"", "{}", "{\"coordinator\": 3}"}) {
    std::ofstream(folder.path() / "cluster.json") << broken;
    EXPECT_THAT(folder.ReadRecord().status().message(), HasSubstr("cluster.json")) << broken;
  }
}

}  // namespace
}  // namespace depthfarm
