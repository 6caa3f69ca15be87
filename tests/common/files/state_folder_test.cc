#include "common/files/state_folder.h"

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

TEST(StateFolder, IsWhereTheUserKeepsState) {
  const Variable home("HOME", "/home/anna");
  {
    const Variable state("XDG_STATE_HOME", "/state");
    EXPECT_EQ(StateFolder().value(), "/state/depthfarm");
  }
  for (const char* nothing : {"", static_cast<const char*>(nullptr)}) {
    const Variable state("XDG_STATE_HOME", nothing);
    EXPECT_EQ(StateFolder().value(), "/home/anna/.local/state/depthfarm");
  }
}

TEST(StateFolder, NobodyKnowsItWithoutTheVariablesOrWithARelativePath) {
  {
    const Variable state("XDG_STATE_HOME", nullptr);
    const Variable home("HOME", nullptr);
    EXPECT_EQ(StateFolder().status().code(), ErrorCode::kInvalidArgument);
  }
  const Variable state("XDG_STATE_HOME", "state");
  EXPECT_EQ(StateFolder().status().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
