#ifndef DEPTHFARM_TESTS_SYSTEM_DISTURBED_JOB_H_
#define DEPTHFARM_TESTS_SYSTEM_DISTURBED_JOB_H_

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>

#include "tests/system/support.h"

namespace depthfarm::system_test {

inline std::uint64_t TasksDone(const v1::JobStatus& job) {
  std::uint64_t done = 0;
  for (const v1::StageStatus& stage : job.stages()) done += stage.tasks_done();
  return done;
}

// Long enough that something can happen in the middle: 4 GOPs, finer segments.
inline Words LongerJob(int blocks = 4, const char* partition = "interleaved") {
  return {"--segments",           "1500",        "--levels", "48", "--gop", "2", "--level-blocks",
          std::to_string(blocks), "--partition", partition};
}

// A job of which the depth is known, and a farm that a test disturbs.
class DisturbedJob : public testing::Test {
 protected:
  void SetUp() override { sequence_ = RenderScene(folder_.path() / "scene", {.cameras = 3, .frames = 8}); }

  // What the longer job gives when nothing goes wrong.
  std::map<std::string, std::string> Undisturbed() {
    const std::string output = folder_ / "undisturbed";
    const Outcome run = Depthfarm(Words{"run", sequence_, "-o", output, "--workers", "2"} + job_);
    EXPECT_EQ(run.exit_code, 0) << run.output;
    return DepthOf(output);
  }

  std::uint64_t Submit(Farm& farm, const std::string& output) {
    const Outcome submitted = Depthfarm(Words{"submit", sequence_, "-o", output, "--json"} + job_ + farm.Options());
    EXPECT_EQ(submitted.exit_code, 0) << submitted.output << farm.Logs();
    const nlohmann::json json = ParseJsonTail(submitted.output);
    return json.contains("job") ? json["job"].get<std::uint64_t>() : 0;
  }

  // Waits for `tasks` tasks of a job to be done; the job must still be running then.
  void WaitForTasks(Farm& farm, std::uint64_t job_id, std::uint64_t tasks) {
    bool running = false;
    ASSERT_TRUE(WaitUntil([&] {
      const Result<v1::JobStatus> job = farm.client().GetStatus(job_id);
      if (!job.ok()) return true;
      running = job->state() == v1::JOB_STATE_RUNNING;
      return !running || TasksDone(*job) >= tasks;
    })) << farm.Logs();
    ASSERT_TRUE(running) << "the job ended before it could be disturbed: make it longer\n" << farm.Logs();
  }

  v1::JobStatus WaitForTheEnd(Farm& farm, std::uint64_t job_id) {
    v1::JobStatus last;
    EXPECT_TRUE(WaitUntil([&] {
      const Result<v1::JobStatus> job = farm.client().GetStatus(job_id);
      if (!job.ok()) return false;
      last = *job;
      return last.state() != v1::JOB_STATE_RUNNING;
    })) << farm.Logs();
    return last;
  }

  void WaitForFrames(Farm& farm, std::uint64_t job_id, std::uint64_t frames) {
    ASSERT_TRUE(WaitUntil([&] {
      const Result<v1::JobStatus> job = farm.client().GetStatus(job_id);
      return job.ok() && (job->frames_done() >= frames || job->state() != v1::JOB_STATE_RUNNING);
    })) << farm.Logs();
    ASSERT_EQ(farm.client().GetStatus(job_id).value().state(), v1::JOB_STATE_RUNNING)
        << "the job ended before it could be disturbed: make it longer\n"
        << farm.Logs();
  }

  // That it ends well, with these bytes and nothing else in its folder.
  void ExpectDone(Farm& farm, std::uint64_t job_id, const std::string& output,
                  const std::map<std::string, std::string>& expected) {
    const v1::JobStatus last = WaitForTheEnd(farm, job_id);
    EXPECT_EQ(last.state(), v1::JOB_STATE_DONE) << last.error().message() << "\n" << farm.Logs();
    EXPECT_EQ(last.determinism_violations(), 0U);
    EXPECT_THAT(Differences(expected, DepthOf(output)), testing::IsEmpty()) << farm.Logs();
    EXPECT_THAT(Leftovers(output), testing::IsEmpty());
  }
  // That it fails, and what it says then.
  std::string ReasonOfFailure(Farm& farm, std::uint64_t job_id) {
    const v1::JobStatus last = WaitForTheEnd(farm, job_id);
    EXPECT_EQ(last.state(), v1::JOB_STATE_FAILED) << farm.Logs();
    return last.error().message();
  }
  // What is in the folder of a job that failed: whole frames, as they should be, and no sign of a finished job.
  static void ExpectWholeFrames(const std::string& output, const std::map<std::string, std::string>& expected) {
    const std::map<std::string, std::string> there = DepthOf(output);
    EXPECT_LT(there.size(), expected.size());
    EXPECT_FALSE(there.contains("depth.json"));
    for (const auto& [name, content] : there) EXPECT_EQ(content, expected.at(name)) << name;
    EXPECT_THAT(Leftovers(output), testing::IsEmpty());
  }
  void Retry(Farm& farm, std::uint64_t job_id) {
    const Status again = farm.client().Retry(job_id);
    EXPECT_TRUE(again.ok()) << again.message();
  }
  // That the farm does the next job right, in spite of what happened to this one.
  void ExpectNextJobIsRight(Farm& farm, const std::map<std::string, std::string>& expected) {
    const std::string output = folder_ / "next";
    ExpectDone(farm, Submit(farm, output), output, expected);
  }

  TemporaryFolder folder_;
  std::string sequence_;
  Words job_ = LongerJob();
};

}  // namespace depthfarm::system_test

#endif  // DEPTHFARM_TESTS_SYSTEM_DISTURBED_JOB_H_
