#include "common/files/open_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using testing_support::TemporaryFolder;

// What ReadUpTo reads with room for `count` bytes.
std::string Read(const std::string& path, std::uint64_t offset, std::size_t count) {
  const OpenFile file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  std::string bytes(count, '?');
  const Result<std::size_t> have = ReadUpTo(path, file, offset, bytes);
  EXPECT_TRUE(have.ok()) << have.status().message();
  bytes.resize(have.value());
  return bytes;
}

TEST(ReadUpTo, ReadsWhatThereIsFromTheOffsetOn) {
  const TemporaryFolder folder;
  const std::string path = folder.Write("f", "0123456789");
  EXPECT_EQ(Read(path, 0, 10), "0123456789");
  EXPECT_EQ(Read(path, 3, 4), "3456");
  EXPECT_EQ(Read(path, 8, 5), "89");
  EXPECT_EQ(Read(path, 10, 5), "");
  EXPECT_EQ(Read(path, 99, 5), "");
  EXPECT_EQ(Read(path, 0, 0), "");
}

TEST(ReadUpTo, NamesAFileThatCannotBeRead) {
  const TemporaryFolder folder;
  const OpenFile file(::open(folder.path().c_str(), O_RDONLY | O_CLOEXEC | O_DIRECTORY));
  ASSERT_TRUE(file.ok());
  std::string bytes(5, '?');
  const Result<std::size_t> have = ReadUpTo("some/path", file, 0, bytes);
  ASSERT_FALSE(have.ok());
  EXPECT_EQ(have.status().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(have.status().message(), "some/path: cannot read the file: Is a directory");
}

}  // namespace
}  // namespace depthfarm
