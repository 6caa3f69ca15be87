// What the commands print and how they exit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

// Of the tasks that make an artifact, how many ran although it was there.
int MadeAnew(const nlohmann::json& job) {
  int made = 0;
  for (const auto& stage : job["stages"]) {
    const std::string name = stage["stage"];
    if (name == "analyse" || name == "estimate" || name == "merge" || name == "refine")
      made += stage["tasksDone"].get<int>() - stage["reused"].get<int>();
  }
  return made;
}

TEST(Commands, TheSameJobAgainComputesNothingAndALongerOneOnlyWhatIsNew) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.frames = 6});
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  for (int i = 0; i < 3; ++i) farm.AddWorker();
  const auto submit = [&](const std::string& output, const std::string& frames) {
    const Outcome outcome =
        Depthfarm(Words{"submit", sequence, "-o", folder / output, "--wait", "--json", "--frames", frames} +
                  SmallJob() + farm.Options());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.output << farm.Logs();
    return ParseJsonTail(outcome.output);
  };
  EXPECT_GT(MadeAnew(submit("first", "0:4")), 0);
  EXPECT_EQ(MadeAnew(submit("second", "0:4")), 0);
  EXPECT_THAT(Differences(DepthOf(folder / "first"), DepthOf(folder / "second")), IsEmpty());
  const nlohmann::json longer = submit("longer", "0:6");
  for (const auto& stage : longer["stages"]) {
    if (stage["stage"] == "analyse") {
      EXPECT_EQ(stage["reused"], 3 * 4);
    }
  }
}

TEST(Commands, ADrainedWorkerEndsWhenItsTasksAreDoneAndTheJobGoesOn) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene");
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker({"--name", "first"});
  farm.AddWorker({"--name", "second", "--slots", "2"});
  ASSERT_TRUE(WaitUntil([&] {
    const auto workers = farm.client().ListWorkers();
    return workers.ok() && workers->size() == 2;
  })) << farm.Logs();
  const Outcome nobody = Depthfarm(Words{"drain", "third"} + farm.Options());
  EXPECT_EQ(nobody.exit_code, 2);
  EXPECT_THAT(nobody.output, HasSubstr("there is no worker 'third'"));
  const Outcome submitted = Depthfarm(Words{"submit", sequence, "-o", folder / "out"} + SmallJob() + farm.Options());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output;
  EXPECT_EQ(Depthfarm(Words{"drain", "first"} + farm.Options()).exit_code, 0);
  EXPECT_EQ(Depthfarm(Words{"watch", "1"} + farm.Options()).exit_code, 0) << farm.Logs();
  EXPECT_TRUE(WaitUntil([&] {
    const auto workers = farm.client().ListWorkers();
    return workers.ok() && workers->size() == 1 && workers->front().name() == "second";
  })) << farm.Logs();
}

TEST(Commands, AJobThatRequiresTagsWaitsForAWorkerThatHasThem) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene");
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker({"--name", "plain"});
  const Outcome submitted = Depthfarm(Words{"submit", sequence, "-o", folder / "out", "--require", "fast,room2"} +
                                      SmallJob() + farm.Options());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output;
  EXPECT_THAT(Depthfarm(Words{"status", "1"} + farm.Options()).output,
              HasSubstr("waits for a worker with the tags fast,room2"));
  farm.AddWorker({"--name", "tagged", "--tags", "room2,large,fast"});
  EXPECT_EQ(Depthfarm(Words{"watch", "1"} + farm.Options()).exit_code, 0) << farm.Logs();
  const nlohmann::json workers = ParseJsonTail(Depthfarm(Words{"workers", "--json"} + farm.Options()).output);
  for (const auto& worker : workers) EXPECT_EQ(worker["tasksDone"] == 0, worker["name"] == "plain");
  EXPECT_EQ(Depthfarm(Words{"submit", sequence, "-o", folder / "out", "--require", "a b"} + farm.Options()).exit_code,
            2);
}

TEST(Commands, ThoseOfPixelsSpeakOfTheProgramThatWasCalled) {
  const TemporaryFolder folder;
  const Outcome help = Depthfarm({"colour", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.output, AllOf(HasSubstr("depthfarm colour"), Not(HasSubstr("depthfarm-media"))));
  const Outcome failed = Depthfarm({"colour", folder / "nowhere", "-o", folder / "pictures"});
  EXPECT_EQ(failed.exit_code, 2);
  EXPECT_THAT(failed.output, AllOf(HasSubstr("depthfarm: "), Not(HasSubstr("depthfarm-media"))));
}

TEST(Commands, ExportSaysWhereItTakesTheSequence) {
  const Outcome refused = Depthfarm({"export", "ply", "sequence.json", "depth", "-o", "points"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.output, AllOf(HasSubstr("depth"), HasSubstr("--sequence SEQUENCE")));
}

TEST(Commands, VerifyFindsWhatIsNotAsTheJobLeftIt) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene");
  const std::string output = folder / "out";
  EXPECT_EQ(Depthfarm({"verify", output}).exit_code, 2);
  ASSERT_EQ(Depthfarm(Words{"run", sequence, "-o", output, "--workers", "2"} + SmallJob()).exit_code, 0);
  const Outcome good = Depthfarm({"verify", output});
  EXPECT_EQ(good.exit_code, 0) << good.output;
  EXPECT_THAT(good.output, HasSubstr("12 of 12 files of depth.json are right"));
  fs::remove(fs::path(output) / "depth/cam1/0002.png");
  std::ofstream(fs::path(output) / "depth/cam0/0000.png", std::ios::app) << "x";
  std::ofstream(fs::path(output) / "depth/cam0/0099.png") << "old";
  const Outcome bad = Depthfarm({"verify", output});
  EXPECT_EQ(bad.exit_code, 1);
  EXPECT_THAT(bad.output,
              AllOf(HasSubstr("missing     depth/cam1/0002.png"), HasSubstr("changed     depth/cam0/0000.png"),
                    HasSubstr("unlisted    depth/cam0/0099.png"), HasSubstr("10 of 12 files")));
  EXPECT_EQ(ParseJsonTail(Depthfarm({"verify", output, "--json"}).output)["good"], false);
}

TEST(Commands, SubmitStatusWatchJobsAndWorkersTellOfAJob) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene");
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const std::string output = folder / "out";

  const Outcome submitted = Depthfarm(Words{"submit", sequence, "-o", output, "--name", "little", "--priority", "3"} +
                                      SmallJob() + farm.Options());
  ASSERT_EQ(submitted.exit_code, 0) << submitted.output << farm.Logs();
  const std::string job = submitted.output.substr(submitted.output.rfind('\n', submitted.output.size() - 2) + 1);
  const std::string job_id = job.substr(0, job.size() - 1);
  ASSERT_THAT(job_id, testing::MatchesRegex("[0-9]+")) << submitted.output;

  const Outcome watched = Depthfarm(Words{"watch", job_id, "--json"} + farm.Options());
  EXPECT_EQ(watched.exit_code, 0) << watched.output << farm.Logs();
  const nlohmann::json last = ParseJsonTail(watched.output);
  ASSERT_FALSE(last.is_discarded()) << watched.output;
  EXPECT_EQ(last["state"], "done");
  EXPECT_EQ(last["framesDone"], 4);
  EXPECT_EQ(last["framesTotal"], 4);
  EXPECT_EQ(last["name"], "little");
  EXPECT_EQ(last["priority"], 3);
  EXPECT_EQ(last["determinismViolations"], 0);
  EXPECT_EQ(last["outputDir"], output);
  EXPECT_FALSE(last["stages"].empty());

  const Outcome status = Depthfarm(Words{"status", job_id} + farm.Options());
  EXPECT_EQ(status.exit_code, 0) << status.output;
  EXPECT_THAT(status.output, AllOf(HasSubstr("'little'"), HasSubstr("done"), HasSubstr("4/4"), HasSubstr("estimate")));

  const nlohmann::json jobs = ParseJsonTail(Depthfarm(Words{"jobs", "--json"} + farm.Options()).output);
  ASSERT_THAT(jobs, SizeIs(1));
  EXPECT_EQ(std::to_string(jobs[0]["job"].get<int>()), job_id);

  const nlohmann::json workers = ParseJsonTail(Depthfarm(Words{"workers", "--json"} + farm.Options()).output);
  ASSERT_THAT(workers, SizeIs(1));
  EXPECT_GT(workers[0]["tasksDone"].get<int>(), 0);

  EXPECT_EQ(DepthOf(output).size(), 3U * 4 + 1);
}

TEST(Commands, SubmitWithWaitEndsWithTheJob) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 1});
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker();
  const Outcome waited =
      Depthfarm(Words{"submit", sequence, "-o", folder / "out", "--wait", "--json"} + SmallJob() + farm.Options());
  EXPECT_EQ(waited.exit_code, 0) << waited.output << farm.Logs();
  const nlohmann::json last = ParseJsonTail(waited.output);
  ASSERT_FALSE(last.is_discarded()) << waited.output;
  EXPECT_EQ(last["state"], "done");
  EXPECT_THAT(DepthOf(folder / "out"), SizeIs(3 + 1));
}

TEST(Commands, AnUnknownJobIsBadInput) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  for (const char* command : {"status", "watch", "cancel"}) {
    const Outcome outcome = Depthfarm(Words{command, "77"} + farm.Options());
    EXPECT_EQ(outcome.exit_code, 2) << command << ": " << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr("77")) << command;
  }
}

TEST(Commands, RunWritesRunJsonAndPrintsASummary) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 2});
  const std::string output = folder / "out";
  const Outcome run = Depthfarm(Words{"run", sequence, "-o", output, "--workers", "1", "--json"} + SmallJob());
  ASSERT_EQ(run.exit_code, 0) << run.output;
  const nlohmann::json printed = ParseJsonTail(run.output);
  const nlohmann::json written = nlohmann::json::parse(ReadFile(fs::path(output) / "run.json"), nullptr, false);
  ASSERT_FALSE(written.is_discarded());
  EXPECT_EQ(printed, written);
  EXPECT_EQ(written["state"], "done");
  EXPECT_EQ(written["workers"], 1);
  EXPECT_GT(written["wallSeconds"].get<double>(), 0);
}

TEST(Commands, PlanPrintsTheTasksThatRunDoes) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 3});
  const std::string output = folder / "out";
  const Outcome planned = Depthfarm(Words{"plan", sequence, "--json"} + SmallJob());
  ASSERT_EQ(planned.exit_code, 0) << planned.output;
  const nlohmann::json plan = ParseJsonTail(planned.output);
  const Outcome ran = Depthfarm(Words{"run", sequence, "-o", output, "--workers", "1", "--json"} + SmallJob());
  ASSERT_EQ(ran.exit_code, 0) << ran.output;
  std::map<std::string, std::uint64_t> tasks_of_plan;
  for (const nlohmann::json& stage : plan["stages"]) tasks_of_plan[stage["stage"]] = stage["tasks"];
  std::map<std::string, std::uint64_t> tasks_of_run;
  const nlohmann::json run = ParseJsonTail(ran.output);
  for (const nlohmann::json& stage : run["stages"]) {
    if (stage["tasksTotal"] > 0) tasks_of_run[stage["stage"]] = stage["tasksTotal"];
  }
  EXPECT_EQ(tasks_of_plan, tasks_of_run);
  EXPECT_GT(plan["criticalPath"]["seconds"].get<double>(), 0);
  EXPECT_GE(plan["farms"][0]["wallSeconds"].get<double>(), plan["criticalPath"]["seconds"].get<double>());

  const Outcome text = Depthfarm(Words{"plan", sequence, "--workers", "3"} + SmallJob());
  EXPECT_EQ(text.exit_code, 0) << text.output;
  EXPECT_THAT(text.output, AllOf(HasSubstr("estimate"), HasSubstr("critical path"), HasSubstr("wall time")));
}

TEST(ExitCodes, PlanRefusesWhatRunRefuses) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 1});
  const auto expect_refused = [&](const Words& words, const std::string& reason) {
    const Outcome outcome = Depthfarm(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr(reason));
  };
  expect_refused({"plan", folder / "none.json"}, "none.json");
  expect_refused({"plan", sequence, "--levels", "1"}, "levels is 1");
  expect_refused({"plan", sequence, "--frames", "0:9"}, "frames");
  expect_refused({"plan", sequence, "-o", folder / "out"}, "-o");
}

TEST(ExitCodes, BadInputIsTwoBeforeAnythingIsStarted) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 2});
  const std::string output = folder / "out";
  const Words run = {"run", sequence, "-o", output};
  const auto expect_refused = [&](const Words& words, const std::string& reason) {
    const Outcome outcome = Depthfarm(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr(reason));
    EXPECT_FALSE(fs::exists(output)) << "a job was started";
  };
  expect_refused({"run", folder / "none.json", "-o", output}, "none.json");
  expect_refused(run + Words{"--levels", "1"}, "levels is 1");
  expect_refused(run + Words{"--frames", "0:9"}, "frames");
  expect_refused(run + Words{"--views", "nobody"}, "nobody");
  expect_refused(run + Words{"--levels", "4", "--level-blocks", "5"}, "level-blocks");
  expect_refused(run + Words{"--params", folder / "none.params"}, "none.params");
}

TEST(ExitCodes, AMissingPictureIsNamedWithCameraAndFrame) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 2});
  const nlohmann::json json = nlohmann::json::parse(ReadFile(sequence), nullptr, false);
  ASSERT_FALSE(json.is_discarded());
  const std::string camera = json["cameras"][1]["name"];
  const std::string picture = json["cameras"][1]["images"][1];
  fs::remove(folder.path() / "scene" / picture);
  const Outcome run = Depthfarm({"run", sequence, "-o", folder / "out"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.output, AllOf(HasSubstr("camera '" + camera + "'"), HasSubstr("frame 1"), HasSubstr(picture)));
  EXPECT_FALSE(fs::exists(folder / "out"));
  const Outcome without = Depthfarm(Words{"run", sequence, "-o", folder / "out", "--frames", ":1"} + SmallJob());
  EXPECT_EQ(without.exit_code, 0) << "frame 0 needs no picture of frame 1\n" << without.output;
}

TEST(ExitCodes, ADamagedPictureFailsTheJobWithItsNameAndNoLogs) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 1});
  std::ofstream(folder.path() / "scene" / "cam1" / "0000.png", std::ios::trunc) << "\x89PNG\r\n";
  const Outcome run = Depthfarm(Words{"run", sequence, "-o", folder / "out"} + SmallJob());
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_THAT(run.output, AllOf(HasSubstr("camera 'cam1', frame 0"), HasSubstr("cam1/0000.png")));
  EXPECT_THAT(run.output, Not(HasSubstr("coordinator.log")));
}

TEST(ExitCodes, SomebodyElsesDepthFolderIsLeftAlone) {
  const TemporaryFolder folder;
  const std::string sequence = RenderScene(folder.path() / "scene", {.cameras = 3, .frames = 1});
  fs::create_directories(folder.path() / "out" / "depth");
  std::ofstream(folder.path() / "out" / "depth" / "precious") << "x";
  const Outcome run = Depthfarm({"run", sequence, "-o", folder / "out"});
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_EQ(ReadFile(folder.path() / "out" / "depth" / "precious"), "x");
}

TEST(ExitCodes, NoCoordinatorIsThree) {
  const TemporaryFolder folder;
  const Outcome jobs = Depthfarm({"jobs", "--coordinator", "ipc://" + (folder / "nobody"), "--timeout", "1"});
  EXPECT_EQ(jobs.exit_code, 3) << jobs.output;
  EXPECT_THAT(jobs.output, HasSubstr("no answer"));
}

TEST(ExitCodes, TcpWithoutKeysIsBadUsage) {
  const Outcome jobs = Depthfarm({"jobs", "--coordinator", "tcp://127.0.0.1:1"});
  EXPECT_EQ(jobs.exit_code, 2) << jobs.output;
  EXPECT_THAT(jobs.output, HasSubstr("keys"));
}

TEST(ExitCodes, InsecureTcpIsForLoopbackOnly) {
  const Outcome jobs = Depthfarm({"jobs", "--coordinator", "tcp://192.0.2.1:7700", "--insecure"});
  EXPECT_EQ(jobs.exit_code, 2) << jobs.output;
}

TEST(Media, PixelCommandsAreReachedThroughDepthfarm) {
  const Outcome help = Depthfarm({"scene", "--help"});
  EXPECT_EQ(help.exit_code, 0) << help.output;
  EXPECT_THAT(help.output, HasSubstr("--cameras"));
  EXPECT_EQ(Depthfarm({"scene"}).exit_code, 2);
}

}  // namespace
}  // namespace depthfarm::system_test
