#include "common/files/user_folders.h"

#include <gtest/gtest.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): setenv is POSIX

#include <optional>
#include <string>

namespace depthfarm {
namespace {

// A variable of the environment as long as the object lives.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    const char* before = getenv(name);  // NOLINT(concurrency-mt-unsafe): one thread
    if (before != nullptr) before_ = before;
    Set(value);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;
  ~Variable() { Set(before_ ? before_->c_str() : nullptr); }

 private:
  void Set(const char* value) {
    // NOLINTBEGIN(concurrency-mt-unsafe): one thread
    if (value != nullptr) {
      setenv(name_, value, 1);
    } else {
      unsetenv(name_);
    }
    // NOLINTEND(concurrency-mt-unsafe)
  }
  const char* name_;
  std::optional<std::string> before_;
};

struct Row {
  const char* variable;
  Result<std::string> (*folder)();
  const char* below_home;
};
const Row kRows[] = {{"XDG_STATE_HOME", StateFolder, "/home/anna/.local/state/depthfarm"},
                     {"XDG_CACHE_HOME", CacheFolder, "/home/anna/.cache/depthfarm"}};

TEST(UserFolders, AreWhereTheUserHasThem) {
  const Variable home("HOME", "/home/anna");
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.variable);
    {
      const Variable named(row.variable, "/named");
      EXPECT_EQ(row.folder().value(), "/named/depthfarm");
    }
    for (const char* nothing : {"", static_cast<const char*>(nullptr)}) {
      const Variable named(row.variable, nothing);
      EXPECT_EQ(row.folder().value(), row.below_home);
    }
  }
}

TEST(UserFolders, NobodyKnowsThemWithoutTheVariablesOrWithARelativePath) {
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.variable);
    {
      const Variable named(row.variable, nullptr);
      const Variable home("HOME", nullptr);
      EXPECT_EQ(row.folder().status().code(), ErrorCode::kInvalidArgument);
      EXPECT_EQ(row.folder().status().message(), std::string("neither ") + row.variable + " nor HOME is set");
    }
    const Variable named(row.variable, "relative");
    EXPECT_EQ(row.folder().status().code(), ErrorCode::kInvalidArgument);
  }
}

}  // namespace
}  // namespace depthfarm
