#include "coordinator/fetching/fetched_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class FetchedFolderTest : public testing::Test {
 protected:
  [[nodiscard]] fs::path dir() const { return folder_.path() / "out"; }
  [[nodiscard]] Result<FetchedFolder> Open(const std::string& identity) const {
    return FetchedFolder::Open(dir(), identity);
  }
  [[nodiscard]] std::string RefusalOf(const std::string& identity) const {
    const Result<FetchedFolder> folder = Open(identity);
    EXPECT_EQ(folder.status().code(), ErrorCode::kInvalidArgument);
    return folder.status().message();
  }
  void Put(const std::string& name, const std::string& bytes) const {
    ASSERT_TRUE(MakeDirectories((dir() / name).parent_path().string()).ok());
    ASSERT_TRUE(WriteFileAtomically((dir() / name).string(), bytes).ok());
  }

  testing_support::TemporaryFolder folder_;
};

TEST_F(FetchedFolderTest, HoldsTheFilesAndNothingElseInTheEnd) {
  const FetchedFolder folder = Open("job").value();
  EXPECT_FALSE(folder.finished());
  ASSERT_TRUE(folder.Write("depth/cam0/0000.png", "bytes").ok());
  EXPECT_TRUE(fs::exists(dir() / ".depthfarm-job"));
  ASSERT_TRUE(folder.Finish("{}").ok());
  EXPECT_EQ(ReadFileBytes((dir() / "depth/cam0/0000.png").string(), 100).value(), "bytes");
  EXPECT_EQ(ReadFileBytes((dir() / "depth.json").string(), 100).value(), "{}");
  EXPECT_FALSE(fs::exists(dir() / ".depthfarm-job"));
  EXPECT_FALSE(fs::exists(dir() / ".depthfarm-staging"));
}

TEST_F(FetchedFolderTest, IsOneFetchsAtATime) {
  {
    const FetchedFolder first = Open("job").value();
    EXPECT_THAT(RefusalOf("job"), HasSubstr("another depthfarm fetch writes there just now"));
  }
  EXPECT_TRUE(Open("job").ok());
}

TEST_F(FetchedFolderTest, KnowsWhichFilesAreRight) {
  const FetchedFolder folder = Open("job").value();
  const FileDigest digest{Sha256("bytes"), 5};
  EXPECT_FALSE(folder.Has("depth/cam0/0000.png", digest));
  ASSERT_TRUE(folder.Write("depth/cam0/0000.png", "bytes").ok());
  EXPECT_TRUE(folder.Has("depth/cam0/0000.png", digest));
  ASSERT_TRUE(folder.Write("depth/cam0/0000.png", "bytez").ok());
  EXPECT_FALSE(folder.Has("depth/cam0/0000.png", digest));
  ASSERT_TRUE(folder.Write("depth/cam0/0000.png", "longer").ok());
  EXPECT_FALSE(folder.Has("depth/cam0/0000.png", digest));
}

TEST_F(FetchedFolderTest, IsTakenUpByTheSameJobOnly) {
  ASSERT_TRUE(Open("job").ok());
  Put(".depthfarm-staging/fetch/0000.png.tmp-1-2", "half");
  const Result<FetchedFolder> again = Open("job");
  ASSERT_TRUE(again.ok()) << again.status().message();
  EXPECT_FALSE(fs::exists(dir() / ".depthfarm-staging"));
  EXPECT_THAT(RefusalOf("other"), HasSubstr("belongs to another job"));
}

TEST_F(FetchedFolderTest, OfAJobThatWritesThereIsRefused) {
  Put(".depthfarm-job", "a depthfarm job writes into this folder\n");
  EXPECT_THAT(RefusalOf("job"), HasSubstr("belongs to another job"));
}

TEST_F(FetchedFolderTest, WithDepthOfSomebodyElseIsRefused) {
  Put("confidence/cam0/0000.png", "theirs");
  EXPECT_THAT(RefusalOf("job"), HasSubstr("confidence: exists and no job of depthfarm made it"));
}

TEST_F(FetchedFolderTest, TellsTheManifestOfAFinishedResult) {
  Put("depth.json", "{1}");
  Put("depth/cam0/0000.png", "bytes");
  EXPECT_EQ(Open("job").value().finished(), "{1}");
  EXPECT_FALSE(fs::exists(dir() / ".depthfarm-job"));
}

}  // namespace
}  // namespace depthfarm
