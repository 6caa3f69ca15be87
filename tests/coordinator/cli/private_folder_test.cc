#include "coordinator/cli/private_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <optional>

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

TEST(PrivateFolder, IsForThisUserAloneAndGoesWithAllThatIsInIt) {
  fs::path path;
  {
    Result<PrivateFolder> made = PrivateFolder::Make();
    ASSERT_TRUE(made.ok()) << made.status().message();
    const PrivateFolder folder = std::move(made).value();
    path = folder.path();
    EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_all);
    fs::create_directory(path / "sub");
    std::ofstream(path / "sub" / "file") << "x";
  }
  EXPECT_FALSE(path.empty());
  EXPECT_FALSE(fs::exists(path));
}

TEST(PrivateFolder, IsWhereItIsAskedFor) {
  const PrivateFolder outer = PrivateFolder::Make().value();
  {
    const PrivateFolder inner = PrivateFolder::Make(outer.path()).value();
    EXPECT_EQ(inner.path().parent_path(), outer.path());
  }
  EXPECT_TRUE(fs::is_empty(outer.path()));
  EXPECT_EQ(PrivateFolder::Make(outer.path() / "missing").status().code(), ErrorCode::kUnavailable);
}

TEST(PrivateFolder, MovesWithoutBeingRemoved) {
  PrivateFolder first = PrivateFolder::Make().value();
  const fs::path path = first.path();
  {
    const PrivateFolder second(std::move(first));
    EXPECT_EQ(second.path(), path);
    EXPECT_TRUE(fs::is_directory(path));
  }
  EXPECT_FALSE(fs::exists(path));
}

}  // namespace
}  // namespace depthfarm
