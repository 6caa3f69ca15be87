// Files that somebody removes or damages in the middle of a job.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/system/disturbed_job.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

class LostFiles : public DisturbedJob {
 protected:
  void SetUp() override {
    DisturbedJob::SetUp();
    expected_ = Undisturbed();
    ASSERT_TRUE(farm_.ok()) << farm_.problem();
  }

  std::map<std::string, std::string> expected_;
  Farm farm_;
};

// While its worker writes into it.
void RemoveFolder(const fs::path& folder) {
  ASSERT_TRUE(WaitUntil([&] {
    std::error_code error;
    fs::remove_all(folder, error);
    return !error;
  }));
}

TEST_F(LostFiles, OfAWorkersCacheAreMadeAgain) {
  const std::string cache = folder_ / "cache";
  farm_.AddWorker({"--cache-dir", cache});
  farm_.AddWorker();
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(farm_, output);
  for (const std::uint64_t tasks : {20, 60}) {
    ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm_, job, tasks));
    ASSERT_NO_FATAL_FAILURE(RemoveFolder(cache));
  }
  ExpectDone(farm_, job, output, expected_);
  ExpectNextJobIsRight(farm_, expected_);
}

TEST_F(LostFiles, OfTheOnlyCacheAreMadeAgain) {
  const std::string cache = folder_ / "cache";
  farm_.AddWorker({"--cache-dir", cache, "--memory", "1"});  // nothing decoded stands in for them
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm_, job, 40));
  ASSERT_NO_FATAL_FAILURE(RemoveFolder(cache));
  ExpectDone(farm_, job, output, expected_);
  ExpectNextJobIsRight(farm_, expected_);
}

// One byte of every artifact that is there, in its place: name, size and file stay what they were.
int DamageArtifacts(const fs::path& cache) {
  int damaged = 0;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(cache, error)) {
    constexpr std::uintmax_t kHeader = 48;
    constexpr std::size_t kKeyDigits = 64;
    if (entry.path().filename().string().size() != kKeyDigits) continue;
    const std::uintmax_t size = entry.file_size(error);
    if (error || size <= kHeader) continue;
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    const auto middle = static_cast<std::streamoff>((kHeader + size) / 2);
    file.seekg(middle);
    const auto byte = static_cast<char>(file.get() ^ 0x55);
    file.seekp(middle);
    file.put(byte);
    damaged += file.good() ? 1 : 0;
  }
  return damaged;
}

// With decoded artifacts in memory, which a worker believes without a look at the file, and without.
class DamagedCache : public LostFiles, public testing::WithParamInterface<const char*> {};
INSTANTIATE_TEST_SUITE_P(WithMemoryOf, DamagedCache, testing::Values("2GB", "1"),
                         [](const testing::TestParamInfo<const char*>& memory) { return std::string(memory.param); });

TEST_P(DamagedCache, IsNoticedAndMadeAgain) {
  const std::string cache = folder_ / "cache";
  farm_.AddWorker({"--cache-dir", cache, "--memory", GetParam()});
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm_, job, 40));
  EXPECT_GT(DamageArtifacts(cache), 0);
  // What it needs of them comes over the network.
  farm_.AddWorker();
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm_, job, 80));
  EXPECT_GT(DamageArtifacts(cache), 0);
  ExpectDone(farm_, job, output, expected_);
  ExpectNextJobIsRight(farm_, expected_);
}

// The next job has analyses in common with one that has ended, whose worker has them in memory, and gives others the
// damaged files.
TEST_F(LostFiles, ThatAJobLeftAreMadeAgainWhenTheyAreDamaged) {
  const std::string cache = folder_ / "cache";
  farm_.AddWorker({"--cache-dir", cache});
  ExpectDone(farm_, Submit(farm_, folder_ / "out"), folder_ / "out", expected_);
  EXPECT_GT(DamageArtifacts(cache), 0);
  farm_.AddWorker();
  job_ = {"--segments", "1500", "--levels", "32", "--gop", "2"};
  const std::string output = folder_ / "other-levels";
  const Outcome undisturbed = Depthfarm(Words{"run", sequence_, "-o", folder_ / "expected"} + job_);
  ASSERT_EQ(undisturbed.exit_code, 0) << undisturbed.output;
  ExpectDone(farm_, Submit(farm_, output), output, DepthOf(folder_ / "expected"));
}

TEST_F(LostFiles, OfACameraFailTheJobWhichGoesOnWhenTheyAreBack) {
  farm_.AddWorker();
  const std::string picture = folder_ / "scene/cam1/0007.png";
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForTasks(farm_, job, 1));
  fs::rename(picture, picture + ".away");
  EXPECT_THAT(ReasonOfFailure(farm_, job),
              AllOf(HasSubstr("camera 'cam1', frame 7"), HasSubstr(picture), HasSubstr("No such file or directory")));
  ExpectWholeFrames(output, expected_);
  fs::rename(picture + ".away", picture);
  ExpectNextJobIsRight(farm_, expected_);
  Retry(farm_, job);
  ExpectDone(farm_, job, output, expected_);
}

TEST_F(LostFiles, OfTheOutputAreNotTakenForDone) {
  farm_.AddWorker();
  const std::string output = folder_ / "out";
  const std::uint64_t job = Submit(farm_, output);
  ASSERT_NO_FATAL_FAILURE(WaitForFrames(farm_, job, 2));
  ASSERT_NO_FATAL_FAILURE(RemoveFolder(output));
  // Nobody knows any more whose folder it is: whoever made another one there would mix two results.
  EXPECT_THAT(ReasonOfFailure(farm_, job), AllOf(HasSubstr(output), HasSubstr("belongs to no job")));
  EXPECT_FALSE(fs::exists(fs::path(output) / "depth.json"));
  ExpectNextJobIsRight(farm_, expected_);
  const std::uint64_t again = Submit(farm_, output);
  ExpectDone(farm_, again, output, expected_);
}

}  // namespace
}  // namespace depthfarm::system_test
