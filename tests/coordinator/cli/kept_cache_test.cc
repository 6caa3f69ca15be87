#include "coordinator/cli/kept_cache.h"

#include <gtest/gtest.h>
#include <linux/magic.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): setenv is POSIX
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

using testing_support::TemporaryFolder;

constexpr std::uint64_t kGibibyte = std::uint64_t{1} << 30;

TEST(KeptCacheBytes, AreATenthOfTheDiskWithinBounds) {
  EXPECT_EQ(KeptCacheBytes(0), kGibibyte);
  EXPECT_EQ(KeptCacheBytes(10 * kGibibyte), kGibibyte);
  EXPECT_EQ(KeptCacheBytes(40 * kGibibyte), 4 * kGibibyte);
  EXPECT_EQ(KeptCacheBytes(1000 * kGibibyte), 8 * kGibibyte);
}

TEST(IsNetworkFileSystem, TellsThoseOfOtherHosts) {
  for (const std::int64_t type : {std::int64_t{NFS_SUPER_MAGIC}, std::int64_t{SMB_SUPER_MAGIC},
                                  std::int64_t{0xFF534D42}, std::int64_t{CEPH_SUPER_MAGIC}, std::int64_t{0x65735546}})
    EXPECT_TRUE(IsNetworkFileSystem(type)) << type;
  // Where a long has 32 bits the kernel's number is negative.
  EXPECT_TRUE(IsNetworkFileSystem(static_cast<std::int32_t>(0xFF534D42)));
  for (const std::int64_t type : {EXT4_SUPER_MAGIC, XFS_SUPER_MAGIC, TMPFS_MAGIC, OVERLAYFS_SUPER_MAGIC})
    EXPECT_FALSE(IsNetworkFileSystem(type)) << type;
}

class OpenKeptCacheOf : public testing::Test {
 protected:
  void SetUp() override { Name(folder_.path()); }
  void TearDown() override { unsetenv("XDG_CACHE_HOME"); }  // NOLINT(concurrency-mt-unsafe): one thread
  static void Name(const fs::path& cache_home) {
    setenv("XDG_CACHE_HOME", cache_home.c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  }

  TemporaryFolder folder_;
};

TEST_F(OpenKeptCacheOf, TheUserIsClosedToOthersAndLeftOutOfBackups) {
  for (int time = 0; time < 2; ++time) {
    const Result<KeptCache> cache = OpenKeptCache("");
    ASSERT_TRUE(cache.ok()) << cache.status().message();
    EXPECT_EQ(cache->note, "");
    EXPECT_EQ(cache->folder, folder_.path() / "depthfarm" / "artifacts");
    EXPECT_EQ(fs::status(cache->folder).permissions(), fs::perms::owner_all);
    EXPECT_TRUE(fs::exists(folder_.path() / "depthfarm" / "CACHEDIR.TAG"));
    EXPECT_GE(cache->bytes, kGibibyte);
  }
}

TEST_F(OpenKeptCacheOf, AFolderOfSomebodyElseIsNone) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to give a folder away";
  ASSERT_EQ(chown(folder_.path().c_str(), 12345, 12345), 0);
  const Result<KeptCache> cache = OpenKeptCache("");
  ASSERT_TRUE(cache.ok());
  EXPECT_TRUE(cache->folder.empty());
  EXPECT_EQ(cache->note, "nothing is kept for the next run in " + (folder_.path() / "depthfarm/artifacts").string() +
                             ", which belongs to another user; --cache-dir names another folder");
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(OpenKeptCacheOf, AUserMayBeBelowWhatIsTheSystemsButNotItself) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to be another user";
  fs::permissions(folder_.path(), fs::perms::all);
  Name(folder_.path() / "below");
  ASSERT_EQ(seteuid(12345), 0);
  const Result<KeptCache> below = OpenKeptCache("");
  ASSERT_EQ(seteuid(0), 0);
  ASSERT_TRUE(below.ok());
  EXPECT_EQ(below->note, "");
  EXPECT_EQ(below->folder, folder_.path() / "below/depthfarm/artifacts");

  ASSERT_EQ(chown(below->folder.c_str(), 0, 0), 0);
  ASSERT_EQ(seteuid(12345), 0);
  const Result<KeptCache> of_root = OpenKeptCache("");
  ASSERT_EQ(seteuid(0), 0);
  ASSERT_TRUE(of_root.ok());
  EXPECT_TRUE(of_root->folder.empty());
  EXPECT_NE(of_root->note.find("belongs to another user"), std::string::npos) << of_root->note;
}

TEST_F(OpenKeptCacheOf, WhoHasNoFoldersIsNone) {
  Name("relative");
  const Result<KeptCache> cache = OpenKeptCache("");
  ASSERT_TRUE(cache.ok());
  EXPECT_TRUE(cache->folder.empty());
  EXPECT_NE(cache->note.find("XDG_CACHE_HOME"), std::string::npos) << cache->note;
}

TEST_F(OpenKeptCacheOf, AnotherNameIsMadeAsItIsSaid) {
  const Result<KeptCache> cache = OpenKeptCache((folder_.path() / "a/./b").string());
  ASSERT_TRUE(cache.ok());
  EXPECT_EQ(cache->folder, folder_.path() / "a/b");
  EXPECT_TRUE(fs::is_directory(cache->folder));
  EXPECT_EQ(OpenKeptCache(folder_.Write("file", "")).status().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
