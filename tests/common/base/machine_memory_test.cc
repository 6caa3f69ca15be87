#include "common/base/machine_memory.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

void Write(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

TEST(MachineMemory, IsThatOfTheMachineWithoutAGroup) {
  const testing_support::TemporaryFolder folder;
  EXPECT_GT(MachineMemory(folder.path().string(), (folder.path() / "none").string()), std::uint64_t{1} << 26);
}

TEST(MachineMemory, IsTheLeastOfTheGroupsAboveTheProcess) {
  const testing_support::TemporaryFolder folder;
  Write(folder.path() / "proc", "1:name=x:/other\n0::/farm/worker\n");
  Write(folder.path() / "farm/memory.max", "2097152\n");
  Write(folder.path() / "farm/worker/memory.max", "max\n");
  EXPECT_EQ(MachineMemory(folder.path().string(), (folder.path() / "proc").string()), 2097152U);
  Write(folder.path() / "farm/worker/memory.max", "1048576\n");
  EXPECT_EQ(MachineMemory(folder.path().string(), (folder.path() / "proc").string()), 1048576U);
}

TEST(TaskMemory, LeavesTheCacheItsShareUpToHalf) {
  EXPECT_EQ(TaskMemory(100, 30), 70U);
  EXPECT_EQ(TaskMemory(100, 80), 50U);
  EXPECT_EQ(TaskMemory(0, 80), 0U);
}

TEST(TaskMemory, IsOneShareWhereWorkersShareTheMachine) {
  EXPECT_EQ(TaskMemory(1000, 30, 4), 220U);
  EXPECT_EQ(TaskMemory(1000, 200, 4), 125U);
  EXPECT_LE(3 * (TaskMemory(1000, 30, 3) + 30), 1000U) << "all of them fit";
  EXPECT_EQ(TaskMemory(0, 80, 4), 0U);
}

}  // namespace
}  // namespace depthfarm
