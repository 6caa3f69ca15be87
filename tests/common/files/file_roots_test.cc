#include "common/files/file_roots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing_support::TemporaryFolder;

// in/ may be read, out/ written; secret/ is outside.
class FileRootsTest : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"in/cam0", "out", "secret"}) fs::create_directories(folder_.path() / name);
    folder_.Write("in/cam0/0.png", "a picture");
    folder_.Write("secret/key", "a key");
    Result<FileRoots> roots = FileRoots::Of({folder_.File("in")}, {folder_.File("out")});
    ASSERT_TRUE(roots.ok()) << roots.status().message();
    roots_ = *roots;
  }
  [[nodiscard]] bool MayRead(const std::string& name) const { return roots_.CheckRead(folder_.File(name)).ok(); }
  [[nodiscard]] bool MayWrite(const std::string& name) const { return roots_.CheckWrite(folder_.File(name)).ok(); }

  TemporaryFolder folder_;
  FileRoots roots_;
};

TEST_F(FileRootsTest, ReadsBelowBothAndWritesBelowOne) {
  EXPECT_TRUE(roots_.confined());
  for (const char* name : {"in", "in/cam0/0.png", "in/cam0/missing.png", "out", "out/a/b.png"}) {
    EXPECT_TRUE(MayRead(name)) << name;
  }
  for (const char* name : {"out", "out/a/b.png", "out/a/../b.png"}) EXPECT_TRUE(MayWrite(name)) << name;
  for (const char* name : {"in", "in/cam0/0.png", "secret/key", "outside", "out/../in/new"}) {
    EXPECT_FALSE(MayWrite(name)) << name;
  }
  for (const char* name : {"secret/key", "inside", "in/../secret/key", "in/cam0/../../secret/key", "."}) {
    EXPECT_FALSE(MayRead(name)) << name;
  }
  EXPECT_FALSE(roots_.CheckRead("/etc/passwd").ok());
}

TEST_F(FileRootsTest, FollowsLinks) {
  fs::create_directory_symlink(folder_.File("secret"), folder_.File("in/folder"));
  fs::create_symlink(folder_.File("secret/key"), folder_.File("in/file"));
  fs::create_symlink("../secret/key", folder_.File("in/relative"));
  fs::create_symlink(folder_.File("secret/not there yet"), folder_.File("in/dangling"));
  fs::create_directory_symlink(folder_.File("secret"), folder_.File("out/folder"));
  fs::create_symlink("cam0/0.png", folder_.File("in/inner"));
  for (const char* name : {"in/folder/key", "in/file", "in/relative", "in/dangling", "in/folder/none", "in/file/x"}) {
    EXPECT_FALSE(MayRead(name)) << name;
  }
  EXPECT_FALSE(MayWrite("out/folder/new/depth.json"));
  EXPECT_TRUE(MayRead("in/inner"));
  // Roots may be links themselves.
  fs::create_directory_symlink(folder_.File("in"), folder_.File("alias"));
  const Result<FileRoots> alias = FileRoots::Of({folder_.File("alias")}, {});
  ASSERT_TRUE(alias.ok());
  EXPECT_TRUE(alias->CheckRead(folder_.File("in/cam0/0.png")).ok());
  EXPECT_TRUE(alias->CheckRead(folder_.File("alias/cam0/0.png")).ok());
  EXPECT_FALSE(alias->CheckWrite(folder_.File("alias/new")).ok());
}

TEST_F(FileRootsTest, SaysWhereAPathLeadsAndWhatIsAllowed) {
  fs::create_symlink(folder_.File("secret/key"), folder_.File("in/file"));
  const Status read = roots_.CheckRead(folder_.File("in/file"));
  EXPECT_EQ(read.code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(read.message(), folder_.File("in/file") + ": leads to " + folder_.File("secret/key") +
                                ", which is outside of what jobs may read on this worker (--read-root " +
                                folder_.File("in") + ", --write-root " + folder_.File("out") + ")");
  EXPECT_EQ(roots_.CheckWrite(folder_.File("in/new")).message(),
            folder_.File("in/new") + ": is outside of what jobs may write on this worker (--read-root " +
                folder_.File("in") + ", --write-root " + folder_.File("out") + ")");
  EXPECT_THAT(roots_.CheckRead("cam0/0.png").message(), HasSubstr("absolute"));
}

TEST_F(FileRootsTest, ALoopOfLinksLeadsNowhere) {
  fs::create_symlink(folder_.File("in/b"), folder_.File("in/a"));
  fs::create_symlink(folder_.File("in/a"), folder_.File("in/b"));
  EXPECT_FALSE(MayRead("in/a"));
}

TEST_F(FileRootsTest, MustBeFoldersThatExist) {
  const auto refusal = [](const std::vector<std::string>& read, const std::vector<std::string>& write) {
    const Result<FileRoots> roots = FileRoots::Of(read, write);
    EXPECT_EQ(roots.status().code(), ErrorCode::kInvalidArgument);
    return roots.status().message();
  };
  EXPECT_THAT(refusal({"in"}, {}), AllOf(HasSubstr("--read-root 'in'"), HasSubstr("absolute")));
  EXPECT_THAT(refusal({}, {""}), AllOf(HasSubstr("--write-root ''"), HasSubstr("absolute")));
  EXPECT_THAT(refusal({folder_.File("none")}, {}), HasSubstr("No such file"));
  EXPECT_THAT(refusal({}, {folder_.File("secret/key")}), HasSubstr("is not a folder"));
}

TEST(FileRoots, WithoutRootsEverythingIsAllowed) {
  EXPECT_FALSE(FileRoots().confined());
  EXPECT_TRUE(FileRoots().CheckRead("/etc/passwd").ok());
  EXPECT_TRUE(FileRoots().CheckWrite("relative").ok());
}

}  // namespace
}  // namespace depthfarm
