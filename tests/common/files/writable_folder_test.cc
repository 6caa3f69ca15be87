#include "common/files/writable_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;
using testing_support::TemporaryFolder;

TEST(CheckWritableFolder, TakesWhatIsThereAndWhatCanBeMadeAndMakesNothing) {
  const TemporaryFolder folder;
  EXPECT_TRUE(CheckWritableFolder(folder.path().string()).ok());
  EXPECT_TRUE(CheckWritableFolder(folder.File("a/b/c")).ok());
  EXPECT_TRUE(CheckWritableFolder(folder.File("a/../b/")).ok());
  EXPECT_FALSE(std::filesystem::exists(folder.File("a")));
}

TEST(CheckWritableFolder, NamesWhatIsInTheWay) {
  const TemporaryFolder folder;
  const std::string file = folder.Write("file", "x");
  const Status itself = CheckWritableFolder(file);
  EXPECT_EQ(itself.code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(itself.message(), "output folder " + file + " is a file: choose another folder");
  const Status below = CheckWritableFolder(file + "/a/b");
  EXPECT_EQ(below.code(), ErrorCode::kInvalidArgument);
  EXPECT_EQ(below.message(), "output folder " + file + "/a/b: " + file + " is a file: choose another folder");
  EXPECT_THAT(CheckWritableFolder("").message(), HasSubstr("expected the path of a folder"));
}

}  // namespace
}  // namespace depthfarm
