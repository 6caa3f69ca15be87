#include "common/files/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <thread>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;
using testing_support::TemporaryFolder;

std::size_t EntriesIn(const TemporaryFolder& folder) {
  const std::filesystem::directory_iterator entries(folder.path());
  return static_cast<std::size_t>(std::distance(begin(entries), end(entries)));
}

TEST(AtomicFile, ReadsBackWhatItWrote) {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\xff\n", 5);
  for (const Durability durability : {Durability::kCached, Durability::kSynced}) {
    ASSERT_TRUE(WriteFileAtomically(folder.File("f"), bytes, durability).ok());
    const auto read = ReadFileBytes(folder.File("f"), 5);
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(*read, bytes);
  }
  EXPECT_EQ(EntriesIn(folder), 1U) << "a temporary file is left";
}

TEST(AtomicFile, ReplacesAnOlderLongerFileWhole) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteFileAtomically(folder.File("f"), "a long old text").ok());
  ASSERT_TRUE(WriteFileAtomically(folder.File("f"), "new").ok());
  EXPECT_EQ(*ReadFileBytes(folder.File("f"), 100), "new");
}

TEST(AtomicFile, FailedWriteLeavesNothingBehind) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "taken" / "inner");  // a folder cannot be replaced by a file
  const Status status = WriteFileAtomically(folder.File("taken"), "x");
  EXPECT_EQ(status.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("taken"));
  EXPECT_EQ(EntriesIn(folder), 1U);
}

TEST(AtomicFile, MissingFolderIsUnavailableAndNamed) {
  const TemporaryFolder folder;
  const Status status = WriteFileAtomically(folder.File("no/such/f"), "x");
  EXPECT_EQ(status.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(status.message(), HasSubstr("no/such/f"));
}

TEST(AtomicFile, WritersOfOnePathLeaveOneOfTheirFilesWhole) {
  const TemporaryFolder folder;
  const std::string path = folder.File("f");
  std::vector<std::thread> writers;
  for (char letter = 'a'; letter < 'e'; ++letter) {
    writers.emplace_back([&path, letter] {
      for (int i = 0; i < 50; ++i) EXPECT_TRUE(WriteFileAtomically(path, std::string(20'000, letter)).ok());
    });
  }
  for (std::thread& writer : writers) writer.join();
  const auto read = ReadFileBytes(path, 20'000);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(*read, std::string(20'000, read->front()));
  EXPECT_EQ(EntriesIn(folder), 1U);
}

TEST(ReadFileBytes, RefusesMoreThanTheBoundWithBothNumbers) {
  const TemporaryFolder folder;
  const auto read = ReadFileBytes(folder.Write("f", "123456"), 5);
  EXPECT_EQ(read.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(read.status().message(), HasSubstr("6 bytes"));
  EXPECT_THAT(read.status().message(), HasSubstr("at most 5"));
}

TEST(ReadFileBytes, MissingFileIsUnavailable) {
  const TemporaryFolder folder;
  EXPECT_EQ(ReadFileBytes(folder.File("none"), 5).status().code(), ErrorCode::kUnavailable);
}

TEST(ReadFileBytes, FoldersAndPipesAreRefusedWithoutWaiting) {
  const TemporaryFolder folder;
  EXPECT_EQ(ReadFileBytes(folder.path().string(), 5).status().code(), ErrorCode::kInvalidArgument);
  ASSERT_EQ(mkfifo(folder.File("pipe").c_str(), 0600), 0);
  EXPECT_EQ(ReadFileBytes(folder.File("pipe"), 5).status().code(), ErrorCode::kInvalidArgument);
}

TEST(MakeDirectories, MakesAllFoldersAndAcceptsThemTwice) {
  const TemporaryFolder folder;
  EXPECT_TRUE(MakeDirectories(folder.File("a/b/c")).ok());
  EXPECT_TRUE(MakeDirectories(folder.File("a/b/c")).ok());
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / "a/b/c"));
}

TEST(MakeDirectories, AFileInTheWayIsAnErrorThatNamesThePath) {
  const TemporaryFolder folder;
  const std::string file = folder.Write("f", "x");
  EXPECT_EQ(MakeDirectories(file).code(), ErrorCode::kUnavailable);
  EXPECT_THAT(MakeDirectories(file + "/a").message(), HasSubstr(file + "/a"));
}

}  // namespace
}  // namespace depthfarm
