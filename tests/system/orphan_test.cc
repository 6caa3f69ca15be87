// Workers that stand still in the middle of a step that others can see, and go on when others have done it since, or
// when a newer job has the folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <iterator>
#include <ostream>

#include "tests/system/disturbed_job.h"
#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kFrames = 4;
constexpr int kCameras = 3;

// Where a worker of one slot, alone on the farm, stands still: when it has made one of these calls to the system with
// this path, for the n-th time. Every look at the marker opens it once: one for each file that is staged, one for each
// that is put in place.
struct Place {
  const char* name;
  const char* path;  // in the output folder
  const char* calls;
  int which;
  v1::TaskKind task;
};
// The file of camera 0 is in place, that of camera 1 is about to be; the marker was looked at.
constexpr Place kCommit = {"Commit", "depth/cam1", "%%stat", 1, v1::TASK_KIND_COMMIT};
// The file was opened and has not been read: what is read later is the marker of then.
constexpr Place kLookOfCommit = {"LookOfCommit", ".depthfarm-job", "openat", kCameras + 2, v1::TASK_KIND_COMMIT};
constexpr Place kLookOfManifest = {"LookOfManifest", ".depthfarm-job", "openat", 2 * kFrames* kCameras + 2,
                                   v1::TASK_KIND_MANIFEST};
// depth.json is there, the folder is not given up.
constexpr Place kManifest = {"Manifest", ".depthfarm-staging", "?rename,?renameat,?renameat2", 1,
                             v1::TASK_KIND_MANIFEST};

enum class GoesOn { kAfterTheJob, kInTheNextJob, kAfterTheNextJob };

struct Case {
  Place place;
  GoesOn when;
};

void PrintTo(const Case& orphan, std::ostream* out) { *out << orphan.place.name; }

std::string NameOf(const testing::TestParamInfo<Case>& info) {
  const GoesOn when = info.param.when;
  return std::string(info.param.place.name) + (when == GoesOn::kAfterTheJob    ? "GoesOnAfterTheJob"
                                               : when == GoesOn::kInTheNextJob ? "GoesOnInTheNextJob"
                                                                               : "GoesOnAfterTheNextJob");
}

class Orphan : public DisturbedJob, public testing::WithParamInterface<Case> {
 protected:
  void SetUp() override {
    const Outcome traced = RunProgram("/bin/sh", {"-c", "strace -f -e trace=rename true"});
    if (traced.exit_code != 0) GTEST_SKIP() << "strace is missing or may not trace here: " << traced.output;
    sequence_ = RenderScene(folder_.path() / "scene", {.cameras = kCameras, .frames = kFrames});
    job_ = LongerJob(2);
    expected_ = Undisturbed();
    const Outcome next = Depthfarm(Words{"run", sequence_, "-o", folder_ / "next-undisturbed"} + next_job_);
    ASSERT_EQ(next.exit_code, 0) << next.output;
    expected_of_next_ = DepthOf(folder_ / "next-undisturbed");
    ASSERT_TRUE(farm_.ok()) << farm_.problem();
  }

  // A worker that stops as a whole at this place of a job that writes into `output`.
  int AddStandingWorker(const Place& place, const std::string& output) {
    const std::string calls = place.calls;
    return farm_.AddWorker(
        {"--ahead", "0"}, "",
        {"/usr/bin/env", "strace", "-f", "-qq", "-o", Trace(), "-P", output + "/" + place.path, "-e", "trace=" + calls,
         "-e", "inject=" + calls + ":signal=SIGSTOP:when=" + std::to_string(place.which)});
  }
  [[nodiscard]] std::string Trace() const { return folder_ / "trace"; }

  std::vector<v1::TaskAttempt> AttemptsThat(v1::AttemptOutcome outcome, std::uint64_t job) {
    std::vector<v1::TaskAttempt> found;
    const v1::JobLogs logs = farm_.client().GetLogs(job, "").value();
    std::ranges::copy_if(logs.attempts(), std::back_inserter(found),
                         [&](const v1::TaskAttempt& attempt) { return attempt.outcome() == outcome; });
    return found;
  }
  // Of the tasks that were granted and have not ended.
  std::vector<v1::TaskKind> RunningTasks(std::uint64_t job) {
    std::vector<v1::TaskKind> kinds;
    for (const v1::TaskAttempt& attempt : AttemptsThat(v1::ATTEMPT_OUTCOME_RUNNING, job))
      kinds.push_back(attempt.task().kind());
    return kinds;
  }
  // What tasks that failed said of the folder.
  Words ComplaintsOf(const std::string& output, std::uint64_t job) {
    Words complaints;
    for (const v1::TaskAttempt& attempt : AttemptsThat(v1::ATTEMPT_OUTCOME_FAILED, job)) {
      if (attempt.error().message().find(output) != std::string::npos) complaints.push_back(attempt.error().message());
    }
    return complaints;
  }
  // It is over for the coordinator, and everything that it did after it went on has been done.
  void GoOn(int worker) {
    farm_.worker(worker).Signal(SIGCONT);
    ASSERT_TRUE(WaitUntil([&] { return farm_.LogOf(worker).find("result_dropped") != std::string::npos; }))
        << farm_.Logs();
  }

  const Words next_job_ = {"--segments", "1000", "--levels", "24", "--gop", "2", "--level-blocks", "2"};
  std::map<std::string, std::string> expected_;
  std::map<std::string, std::string> expected_of_next_;
  Farm farm_;
};

INSTANTIATE_TEST_SUITE_P(At, Orphan,
                         testing::Values(Case{kCommit, GoesOn::kAfterTheJob}, Case{kCommit, GoesOn::kInTheNextJob},
                                         Case{kLookOfCommit, GoesOn::kAfterTheNextJob},
                                         Case{kLookOfManifest, GoesOn::kAfterTheNextJob},
                                         Case{kManifest, GoesOn::kAfterTheJob}, Case{kManifest, GoesOn::kInTheNextJob}),
                         NameOf);

TEST_P(Orphan, ChangesNothingOfWhatOthersHaveMadeSince) {
  const GoesOn when = GetParam().when;
  const std::string output = folder_ / "out";
  const int orphan = AddStandingWorker(GetParam().place, output);
  const std::uint64_t job = Submit(farm_, output);
  ASSERT_TRUE(WaitUntil([&] { return ReadFile(Trace()).find("stopped by SIGSTOP") != std::string::npos; }))
      << ReadFile(Trace()) << farm_.Logs();
  ASSERT_THAT(RunningTasks(job), ElementsAre(GetParam().place.task));

  farm_.AddWorker();
  ExpectDone(farm_, job, output, expected_);
  if (when == GoesOn::kAfterTheJob) {
    ASSERT_NO_FATAL_FAILURE(GoOn(orphan));
    EXPECT_THAT(Differences(expected_, DepthOf(output)), IsEmpty()) << farm_.Logs();
    EXPECT_THAT(Leftovers(output), IsEmpty());
  }
  job_ = next_job_;
  const std::uint64_t next = Submit(farm_, output);
  if (when == GoesOn::kInTheNextJob) {
    ASSERT_NO_FATAL_FAILURE(WaitForFrames(farm_, next, 1));
    ASSERT_NO_FATAL_FAILURE(GoOn(orphan));
  }
  ExpectDone(farm_, next, output, expected_of_next_);
  // Nor was it in the way, so that something had to be done again.
  EXPECT_THAT(ComplaintsOf(output, next), IsEmpty()) << farm_.Logs();
  if (when == GoesOn::kAfterTheNextJob) {
    ASSERT_NO_FATAL_FAILURE(GoOn(orphan));
  }
  EXPECT_THAT(Differences(expected_of_next_, DepthOf(output)), IsEmpty()) << farm_.Logs();
  EXPECT_THAT(Leftovers(output), IsEmpty());
  // Both workers, the one that stood still too, do the next job right.
  ExpectNextJobIsRight(farm_, expected_of_next_);
}

}  // namespace
}  // namespace depthfarm::system_test
