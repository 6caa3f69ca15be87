// Farms whose machines do not all see the same folders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

// A scene and its depth, as a local run makes it. The submitter knows the scene as here/, the workers do not.
class Storage : public testing::Test {
 protected:
  void SetUp() override {
    const std::string rendered = RenderScene(folder_.path() / "here", {.frames = 8});
    fs::copy(folder_ / "here", folder_ / "there", fs::copy_options::recursive);
    sequence_ = rendered;
    const Outcome run = Depthfarm(Words{"run", sequence_, "-o", folder_ / "expected", "--workers", "2"} + SmallJob());
    ASSERT_EQ(run.exit_code, 0) << run.output;
    expected_ = DepthOf(folder_ / "expected");
  }

  TemporaryFolder folder_;
  std::string sequence_;
  std::map<std::string, std::string> expected_;
};

TEST_F(Storage, AWorkerSeesTheFoldersOfAJobUnderOtherNames) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  const Outcome submitted =
      Depthfarm(Words{"submit", sequence_, "-o", folder_ / "results/out"} + SmallJob() + farm.Options());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output;
  fs::rename(folder_ / "here", folder_ / "gone");
  for (int i = 0; i < 2; ++i) {
    farm.AddWorker({"--path-map", (folder_ / "here=") + (folder_ / "there"), "--path-map",
                    (folder_ / "results=") + (folder_ / "mounted")});
  }
  const Outcome watched = Depthfarm(Words{"watch", "1"} + farm.Options());
  ASSERT_EQ(watched.exit_code, 0) << watched.output << farm.Logs();
  EXPECT_THAT(Differences(DepthOf(folder_ / "mounted/out"), expected_), IsEmpty());
  EXPECT_FALSE(fs::exists(folder_ / "results"));
}

TEST_F(Storage, AFailureNamesThePathsOfTheWorkerAndOfTheJob) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker({"--path-map", (folder_ / "here=") + (folder_ / "nowhere")});
  const Outcome submitted =
      Depthfarm(Words{"submit", sequence_, "-o", folder_ / "out", "--wait"} + SmallJob() + farm.Options());
  EXPECT_EQ(submitted.exit_code, 1) << submitted.output;
  EXPECT_THAT(submitted.output, HasSubstr(folder_ / "nowhere/cam"));
  EXPECT_THAT(submitted.output,
              HasSubstr("(" + (folder_ / "nowhere") + " is " + (folder_ / "here") + " of the job: --path-map)"));
}

// A job whose results stay on the workers.
class Results : public Storage {
 protected:
  void SetUp() override {
    Storage::SetUp();
    ASSERT_TRUE(farm_.ok()) << farm_.problem();
  }
  void Submit(const Words& options = {}) {
    const Outcome submitted = Depthfarm(Words{"submit", sequence_} + SmallJob() + farm_.Options() + options);
    ASSERT_EQ(submitted.exit_code, 0) << submitted.output << farm_.Logs();
  }
  [[nodiscard]] Outcome Fetch(std::uint64_t job, const std::string& name, const Words& options = {}) const {
    return Depthfarm(Words{"fetch", std::to_string(job), "-o", folder_ / name} + farm_.Options() + options);
  }
  // What the fetch says when it must end with this code.
  [[nodiscard]] nlohmann::json Report(std::uint64_t job, const std::string& name, int exit_code) const {
    const Outcome fetched = Fetch(job, name, {"--json"});
    EXPECT_EQ(fetched.exit_code, exit_code) << fetched.output << farm_.Logs();
    return ParseJsonTail(fetched.output);
  }
  void ExpectWhole(const std::string& name) const {
    EXPECT_THAT(Differences(DepthOf(folder_ / name), expected_), IsEmpty());
    EXPECT_THAT(Leftovers(folder_ / name), IsEmpty());
    const Outcome verified = Depthfarm({"verify", folder_ / name});
    EXPECT_EQ(verified.exit_code, 0) << verified.output;
  }

  Farm farm_;
};

TEST_F(Results, AreFetchedAsTheJobWouldHaveWrittenThem) {
  for (int i = 0; i < 2; ++i) farm_.AddWorker();
  Submit({"--wait"});
  const nlohmann::json first = Report(1, "out", 0);
  EXPECT_EQ(first["framesFetched"], 8);
  EXPECT_EQ(first["complete"], true);
  ExpectWhole("out");

  EXPECT_EQ(Report(1, "out", 0)["framesFetched"], 0);
  std::ofstream(folder_ / "out/depth/cam1/0002.png") << "damaged";
  fs::remove(folder_ / "out/depth/cam0/0003.png");
  EXPECT_EQ(Report(1, "out", 0)["framesFetched"], 2);
  ExpectWhole("out");
}

TEST_F(Results, OfAJobThatRunsAreFetchedAsFarAsTheyAreDone) {
  Submit();
  const Outcome nothing = Fetch(1, "out");
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.output, HasSubstr("not done: frames 0 to 7; job 1 is running"));
  EXPECT_FALSE(fs::exists(folder_ / "out/depth.json"));
  const int victim = farm_.AddWorker();
  farm_.AddWorker();
  ASSERT_TRUE(WaitUntil([&] {
    const Result<v1::JobStatus> status = farm_.client().GetStatus(1);
    return status.ok() && status->frames_done() > 0;
  })) << farm_.Logs();
  farm_.worker(victim).Signal(SIGKILL);  // what it made is made again
  const Outcome waited = Fetch(1, "out", {"--wait"});
  EXPECT_EQ(waited.exit_code, 0) << waited.output << farm_.Logs();
  ExpectWhole("out");
}

TEST_F(Results, OutliveTheCoordinatorWhileTheJobRunsAndAfter) {
  for (int i = 0; i < 2; ++i) farm_.AddWorker();
  Submit();
  ASSERT_TRUE(WaitUntil([&] { return farm_.client().GetStatus(1).value().frames_done() >= 2; })) << farm_.Logs();
  ASSERT_TRUE(farm_.RestartCoordinator(SIGKILL)) << farm_.problem();
  ASSERT_EQ(Fetch(1, "running", {"--wait"}).exit_code, 0) << farm_.Logs();
  ExpectWhole("running");
  ASSERT_TRUE(farm_.RestartCoordinator(SIGKILL)) << farm_.problem();
  ASSERT_TRUE(WaitUntil([&] {
    const auto workers = farm_.client().ListWorkers();
    return workers.ok() && workers->size() == 2;
  })) << farm_.Logs();
  ASSERT_EQ(Fetch(1, "after").exit_code, 0) << farm_.Logs();
  ExpectWhole("after");
}

TEST_F(Results, ThatAreLostAreNamedAndComeFromTheSameJobSubmittedAgain) {
  const int worker = farm_.AddWorker();
  Submit({"--wait"});
  farm_.worker(worker).Signal(SIGKILL);
  ASSERT_TRUE(WaitUntil([&] {
    const auto workers = farm_.client().ListWorkers();
    return workers.ok() && workers->empty();
  })) << farm_.Logs();
  const nlohmann::json lost = Report(1, "out", 1);
  EXPECT_EQ(lost["complete"], false);
  ASSERT_EQ(lost["framesLost"].size(), 8U) << lost;
  EXPECT_EQ(lost["framesLost"][0]["reason"], "no worker holds it any more");
  EXPECT_THAT(Fetch(1, "out").output, HasSubstr("lost: frames 0 to 7"));

  farm_.AddWorker();
  Submit({"--wait"});
  EXPECT_EQ(Report(2, "out", 0)["framesFetched"], 8);
  ExpectWhole("out");
}

TEST_F(Results, AreFetchedOverCurveWithAKeyThatSubmits) {
  ASSERT_EQ(Depthfarm({"keygen", "-o", folder_ / "keys"}).exit_code, 0);
  Farm farm("tcp://127.0.0.1:*", folder_ / "keys");
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const Outcome submitted = Depthfarm(Words{"submit", sequence_, "--wait"} + SmallJob() + farm.Options());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output << farm.Logs();
  EXPECT_THAT(submitted.output, HasSubstr("depthfarm fetch 1 -o DIR"));
  const Outcome fetched = Depthfarm(Words{"fetch", "1", "-o", folder_ / "out"} + farm.Options());
  EXPECT_EQ(fetched.exit_code, 0) << fetched.output << farm.Logs();
  ExpectWhole("out");
}

TEST_F(Results, FetchSaysWhatIsWrong) {
  const auto failure = [&](std::uint64_t job, const std::string& name) {
    const Outcome outcome = Fetch(job, name);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    return outcome.output;
  };
  farm_.AddWorker();
  Submit({"--wait"});
  Submit({"-o", folder_ / "written", "--wait"});
  Submit({"--frames", "0:2", "--wait"});
  EXPECT_THAT(failure(9, "out"), HasSubstr("there is no job 9"));
  EXPECT_THAT(failure(2, "out"), HasSubstr("job 2 writes to " + (folder_ / "written")));
  fs::create_directories(folder_ / "foreign/depth");
  EXPECT_THAT(failure(1, "foreign"), HasSubstr("no job of depthfarm made it"));
  EXPECT_THAT(failure(3, "written"), HasSubstr("holds the depth of another job"));
  EXPECT_EQ(Report(1, "written", 0)["framesFetched"], 0) << "the same depth";
  const Outcome nobody = Depthfarm(
      {"fetch", "1", "-o", folder_ / "out", "--insecure", "--coordinator", "tcp://127.0.0.1:1", "--timeout", "0.2"});
  EXPECT_EQ(nobody.exit_code, 3) << nobody.output;
}

// Workers for which the folder of the scene is empty.
class Uploads : public Results {
 protected:
  void SetUp() override {
    Results::SetUp();
    fs::create_directories(folder_ / "empty");
  }
  [[nodiscard]] Words Blind() const { return {"--path-map", (folder_ / "here=") + (folder_ / "empty")}; }
};

TEST_F(Uploads, GiveTheDepthOfPicturesThatWorkersCannotSee) {
  for (int i = 0; i < 2; ++i) farm_.AddWorker(Blind());
  const Outcome submitted =
      Depthfarm(Words{"submit", sequence_, "--upload", "-o", folder_ / "out", "--json"} + SmallJob() + farm_.Options());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output << farm_.Logs();
  const nlohmann::json report = ParseJsonTail(submitted.output);
  EXPECT_EQ(report["state"], "done");
  EXPECT_EQ(report["fetch"]["framesFetched"], 8);
  ExpectWhole("out");
}

TEST_F(Uploads, AreTheSameWorkAsPicturesThatWorkersSee) {
  farm_.AddWorker();
  Submit({"-o", folder_ / "read", "--wait"});
  const Outcome submitted = Depthfarm(Words{"submit", sequence_, "--upload", "--json"} + SmallJob() + farm_.Options());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output << farm_.Logs();
  const nlohmann::json report = ParseJsonTail(submitted.output);
  for (const auto& stage : report["stages"]) {
    if (stage["stage"] == "emit") continue;  // files before, a bundle now
    EXPECT_EQ(stage["reused"], stage["tasksDone"]) << stage;
  }
  EXPECT_EQ(report["keepsResults"], true);
  EXPECT_EQ(Report(2, "out", 0)["framesFetched"], 8);
  ExpectWhole("out");
}

TEST_F(Uploads, GoOverCurve) {
  ASSERT_EQ(Depthfarm({"keygen", "-o", folder_ / "keys"}).exit_code, 0);
  Farm farm("tcp://127.0.0.1:*", folder_ / "keys");
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker(Blind());
  const Outcome submitted =
      Depthfarm(Words{"submit", sequence_, "--upload", "-o", folder_ / "out"} + SmallJob() + farm.Options());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output << farm.Logs();
  ExpectWhole("out");
}

TEST_F(Uploads, EndWithTheirSubmitter) {
  const Words words = Words{"submit", sequence_, "--upload"} + SmallJob() + farm_.Options();
  Result<ChildProcess> submitter = ChildProcess::Start(Program("depthfarm"), words, folder_ / "log");
  ASSERT_TRUE(submitter.ok()) << submitter.status().message();
  ASSERT_TRUE(WaitUntil([&] { return farm_.client().GetStatus(1).ok(); })) << ReadFile(folder_ / "log");
  submitter->Signal(SIGINT);
  const std::optional<ProcessEnd> end = submitter->WaitFor(kDeadline);
  ASSERT_TRUE(end.has_value());
  EXPECT_EQ(end->exit_code, 130) << ReadFile(folder_ / "log");
  EXPECT_THAT(ReadFile(folder_ / "log"), HasSubstr("job 1 was cancelled"));
  EXPECT_EQ(farm_.client().GetStatus(1)->state(), v1::JOB_STATE_CANCELLED);
}

TEST(PathMapOption, RefusesWhatIsNoMap) {
  const Outcome outcome = RunProgram("depthfarm-worker", {"--coordinator", "ipc:///tmp/x", "--path-map", "/a/..=/b"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, HasSubstr("is not an absolute path without '..'"));
}

}  // namespace
}  // namespace depthfarm::system_test
