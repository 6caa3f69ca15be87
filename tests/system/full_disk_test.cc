// Disks that are full, or cannot be written any more, in the middle of a job.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "tests/system/disturbed_job.h"
#include "tests/system/small_disk.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

// The disk is mounted before the farm is started: its processes would not see it else.
class FullDisk : public DisturbedJob {
 protected:
  void SetUp() override {
    DisturbedJob::SetUp();
    disk_.emplace(folder_.path() / "disk", "16m");
    if (!disk_->problem().empty()) GTEST_SKIP() << disk_->problem();
    expected_ = Undisturbed();
    farm_.emplace();
    ASSERT_TRUE(farm_->ok()) << farm_->problem();
  }

  std::optional<SmallDisk> disk_;
  std::map<std::string, std::string> expected_;
  std::optional<Farm> farm_;
};

TEST_F(FullDisk, OfTheOutputFailsTheJobWhichGoesOnWhenThereIsRoom) {
  farm_->AddWorker();
  const std::string output = *disk_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForFrames(*farm_, job, 1));
  disk_->Fill();
  EXPECT_THAT(ReasonOfFailure(*farm_, job),
              AllOf(HasSubstr(output), ContainsRegex("frame [0-9]: .*/cam[0-9]/[0-9]+.png"),
                    HasSubstr("No space left on device")));
  ExpectWholeFrames(output, expected_);
  ExpectNextJobIsRight(*farm_, expected_);
  disk_->MakeRoom();
  Retry(*farm_, job);
  ExpectDone(*farm_, job, output, expected_);
}

TEST_F(FullDisk, ThatHasRoomAgainBeforeItsTaskIsGivenUpCostsNothingButAttempts) {
  farm_->AddWorker();
  const std::string output = *disk_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForFrames(*farm_, job, 1));
  disk_->Fill();
  ASSERT_TRUE(WaitUntil([&] { return farm_->client().GetStatus(job).value().retries() > 0; })) << farm_->Logs();
  disk_->MakeRoom();
  ExpectDone(*farm_, job, output, expected_);
}

TEST_F(FullDisk, ThatCannotBeWrittenAnyMoreFailsTheJobWhichGoesOnWhenItCan) {
  farm_->AddWorker();
  const std::string output = *disk_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForFrames(*farm_, job, 1));
  ASSERT_TRUE(WaitUntil([&] { return disk_->MakeReadOnly(); }));
  EXPECT_THAT(ReasonOfFailure(*farm_, job),
              AllOf(HasSubstr(output), ContainsRegex("frame [0-9]: "), HasSubstr("Read-only file system")));
  ExpectNextJobIsRight(*farm_, expected_);
  ASSERT_TRUE(disk_->MakeWritable());
  Retry(*farm_, job);
  ExpectDone(*farm_, job, output, expected_);
}

TEST_F(FullDisk, OfAWorkersCacheLeavesTheJobToOthers) {
  farm_->AddWorker({"--cache-dir", *disk_ / "cache"});
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 20));
  disk_->Fill();
  farm_->AddWorker();
  ExpectDone(*farm_, job, output, expected_);
  ExpectNextJobIsRight(*farm_, expected_);
}

TEST_F(FullDisk, OfTheOnlyCacheFailsTheJobWhichGoesOnWhenThereIsRoom) {
  farm_->AddWorker({"--cache-dir", *disk_ / "cache"});
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(*farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(*farm_, job, 20));
  disk_->Fill();
  EXPECT_THAT(ReasonOfFailure(*farm_, job),
              AllOf(HasSubstr(*disk_ / "cache"), ContainsRegex("frame [0-9]"), HasSubstr("No space left on device")));
  ExpectWholeFrames(output, expected_);
  disk_->MakeRoom();
  Retry(*farm_, job);
  ExpectDone(*farm_, job, output, expected_);
  ExpectNextJobIsRight(*farm_, expected_);
}

}  // namespace
}  // namespace depthfarm::system_test
