#include "common/files/pending_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;
using testing_support::TemporaryFolder;

void Fill(const PendingFile& file, const std::string& text) { std::ofstream(file.temporary()) << text; }

std::string Text(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST(PendingFile, ReplacesTheOldFileOnlyAtCommit) {
  const TemporaryFolder folder;
  const std::string path = folder.Write("f", "old");
  PendingFile file(path);
  Fill(file, "new");
  EXPECT_EQ(Text(path), "old");
  ASSERT_TRUE(file.Commit().ok());
  EXPECT_EQ(Text(path), "new");
  EXPECT_FALSE(std::filesystem::exists(file.temporary()));
}

TEST(PendingFile, WithoutCommitNothingIsLeft) {
  const TemporaryFolder folder;
  const std::string path = folder.Write("f", "old");
  std::string temporary;
  {
    const PendingFile file(path);
    temporary = file.temporary();
    Fill(file, "new");
  }
  EXPECT_EQ(Text(path), "old");
  EXPECT_FALSE(std::filesystem::exists(temporary));
}

TEST(PendingFile, TwoOfOnePathHaveTheirOwnNames) {
  EXPECT_NE(PendingFile("f").temporary(), PendingFile("f").temporary());
}

TEST(PendingFile, AFailedCommitNamesThePathAndLeavesNothing) {
  const TemporaryFolder folder;
  const std::string path = (folder.path() / "none" / "f").string();
  PendingFile file(path);
  const Status status = file.Commit();
  EXPECT_EQ(status.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr(path));
}

}  // namespace
}  // namespace depthfarm
