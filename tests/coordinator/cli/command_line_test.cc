#include "coordinator/cli/command_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/cli/exit_codes.h"

namespace depthfarm {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

template <typename Arguments>
Arguments Parsed(const std::vector<std::string>& words) {
  auto outcome = ParseCommandLine(words);
  if (const auto* exit = std::get_if<CommandLineExit>(&outcome)) {
    ADD_FAILURE() << "not parsed: " << exit->output << exit->error;
    return {};
  }
  const auto* arguments = std::get_if<Arguments>(&std::get<CommandArguments>(outcome));
  if (arguments == nullptr) {
    ADD_FAILURE() << "parsed as another command";
    return {};
  }
  return *arguments;
}

CommandLineExit Exit(const std::vector<std::string>& words) {
  const auto outcome = ParseCommandLine(words);
  const auto* exit = std::get_if<CommandLineExit>(&outcome);
  if (exit == nullptr) {
    ADD_FAILURE() << "parsed as a command";
    return {};
  }
  return *exit;
}

TEST(CommandLine, RunKeepsEstimationOptionsInTheirWords) {
  const auto run = Parsed<RunArguments>({"run", "array.json", "-o", "out", "--workers", "3", "--levels", "auto",
                                         "--params", "p.json", "--preset", "paper", "--frames", "0:5", "--json"});
  EXPECT_EQ(run.job.sequence, "array.json");
  EXPECT_EQ(run.job.output_dir, "out");
  EXPECT_EQ(run.engine.workers, "3");
  EXPECT_EQ(run.farm.threads, 1);
  EXPECT_EQ(Parsed<RunArguments>({"run", "array.json", "-o", "out", "--threads", "4"}).farm.threads, 4);
  EXPECT_EQ(run.farm.slots, 0);
  const auto slots = Parsed<RunArguments>({"run", "array.json", "-o", "out", "--slots", "4"});
  EXPECT_EQ(slots.farm.slots, 4);
  EXPECT_EQ(slots.engine.options.slots, 4);
  EXPECT_TRUE(run.json);
  const EstimationArguments expected = {
      .preset = "paper", .params_file = "p.json", .values = {{"levels", "auto"}, {"frames", "0:5"}}};
  EXPECT_EQ(run.job.estimation.preset, expected.preset);
  EXPECT_EQ(run.job.estimation.params_file, expected.params_file);
  EXPECT_THAT(run.job.estimation.values, testing::UnorderedElementsAreArray(expected.values));
}

TEST(CommandLine, RunTakesEveryEstimationOption) {
  for (const EstimationOption& option : EstimationOptions()) {
    const std::string name(option.name);
    const auto run = Parsed<RunArguments>({"run", "s", "-o", "d", "--" + name, "-1"});
    ASSERT_EQ(run.job.estimation.values.size(), 1U) << name;
    EXPECT_EQ(run.job.estimation.values[0], (std::pair<std::string, std::string>(name, "-1")));
  }
}

TEST(CommandLine, PlanTakesTheOptionsOfAJobButNoOutput) {
  const auto plan = Parsed<PlanArguments>(
      {"plan", "array.json", "--allow-outside", "--preset", "fast", "--frames", "0:5", "--workers", "16", "--json"});
  EXPECT_EQ(plan.job.sequence, "array.json");
  EXPECT_TRUE(plan.job.allow_outside);
  EXPECT_EQ(plan.job.estimation.preset, "fast");
  EXPECT_EQ(plan.job.estimation.values.size(), 1U);
  EXPECT_EQ(plan.workers, 16);
  EXPECT_TRUE(plan.json);
  EXPECT_EQ(Parsed<PlanArguments>({"plan", "array.json"}).workers, 0);
  EXPECT_EQ(Exit({"plan", "array.json", "-o", "out"}).code, kExitBadInput);
  EXPECT_EQ(Exit({"plan"}).code, kExitBadInput);
  EXPECT_EQ(Exit({"plan", "array.json", "--workers", "0"}).code, kExitBadInput);
}

TEST(CommandLine, BenchNeedsNothingAndTakesASequenceOrAScene) {
  const auto plain = Parsed<BenchArguments>({"bench"});
  EXPECT_EQ(plain.sequence, "");
  EXPECT_EQ(plain.workers, 1);
  EXPECT_EQ(plain.threads, 1);
  EXPECT_EQ(plain.repeats, 1);
  const auto scene = Parsed<BenchArguments>({"bench", "--size", "64x48", "--cameras", "4", "--seed", "9", "--repeat",
                                             "3", "--preset", "default,paper", "--levels", "32"});
  EXPECT_EQ(scene.size, "64x48");
  EXPECT_EQ(scene.cameras, 4);
  EXPECT_EQ(scene.seed, 9U);
  EXPECT_EQ(scene.repeats, 3);
  EXPECT_EQ(scene.estimation.preset, "default,paper");
  EXPECT_EQ(scene.estimation.values.size(), 1U);
  EXPECT_EQ(Parsed<BenchArguments>({"bench", "array.json", "--workers", "2"}).sequence, "array.json");
}

TEST(CommandLine, SubmitKnowsItsFarm) {
  const auto submit = Parsed<SubmitArguments>({"submit", "s.json", "-o", "d", "--coordinator", "tcp://head:1", "--keys",
                                               "k", "--priority", "-5", "--name", "n", "--wait"});
  EXPECT_EQ(submit.farm.coordinator, "tcp://head:1");
  EXPECT_EQ(submit.farm.keys, "k");
  EXPECT_FALSE(submit.farm.insecure);
  EXPECT_EQ(submit.priority, -5);
  EXPECT_EQ(submit.name, "n");
  EXPECT_TRUE(submit.wait);
}

TEST(CommandLine, JobCommandsTakeAJobNumber) {
  EXPECT_EQ(Parsed<StatusArguments>({"status", "7"}).job, 7U);
  EXPECT_EQ(Parsed<WatchArguments>({"watch", "8", "--json"}).job, 8U);
  EXPECT_EQ(Parsed<CancelArguments>({"cancel", "9"}).job, 9U);
}

TEST(CommandLine, ListsNeedNothing) {
  EXPECT_EQ(Parsed<JobsArguments>({"jobs"}).farm.coordinator, "tcp://127.0.0.1:7700");
  EXPECT_EQ(Parsed<JobsArguments>({"jobs", "--timeout", "1.5"}).farm.timeout_seconds, 1.5);
  EXPECT_TRUE(Parsed<WorkersArguments>({"workers", "--json", "--insecure"}).farm.insecure);
  EXPECT_EQ(Parsed<DemoArguments>({"demo"}).output_dir, "depthfarm-demo");
  EXPECT_EQ(Parsed<KeygenArguments>({"keygen", "-o", "k"}).output_dir, "k");
}

class BadUsage : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(BadUsage, ExitsWithTwoAndSaysWhyOnStderr) {
  const CommandLineExit exit = Exit(GetParam());
  EXPECT_EQ(exit.code, kExitBadInput);
  EXPECT_FALSE(exit.error.empty());
  EXPECT_TRUE(exit.output.empty()) << exit.output;
}

INSTANTIATE_TEST_SUITE_P(All, BadUsage,
                         testing::ValuesIn(std::vector<std::vector<std::string>>{
                             {},
                             {"fly"},
                             {"run"},
                             {"run", "s.json"},
                             {"run", "-o", "d"},
                             {"run", "s.json", "-o", "d", "--workers", "0"},
                             {"run", "s.json", "-o", "d", "--workers", "many"},
                             {"run", "s.json", "-o", "d", "--workers", "4..2"},
                             {"run", "s.json", "-o", "d", "--worker-memory", "-1"},
                             {"run", "s.json", "-o", "d", "--port", "0"},
                             {"cluster"},
                             {"cluster", "sideways"},
                             {"cluster", "up", "--workers", "0"},
                             {"cluster", "up", "--batch", "--foreground"},
                             {"cluster", "status", "--partition", "p"},
                             {"cluster", "down", "now"},
                             {"run", "s.json", "-o", "d", "--threads", "0"},
                             {"run", "s.json", "-o", "d", "--threads", "257"},
                             {"bench", "--threads", "-1"},
                             {"run", "s.json", "-o", "d", "--level", "3"},
                             {"run", "s.json", "extra", "-o", "d"},
                             {"run", "s.json", "-o", "d", "--log-level", "loud"},
                             {"bench", "a.json", "--size", "64x48"},
                             {"bench", "a.json", "b.json"},
                             {"bench", "--cameras", "1"},
                             {"bench", "--repeat", "0"},
                             {"bench", "--seed", "-1"},
                             {"status"},
                             {"status", "x"},
                             {"status", "-1"},
                             {"submit", "s.json", "-o", "d", "--priority", "1001"},
                             {"jobs", "--timeout", "0"},
                             {"keygen"},
                         }));

TEST(CommandLine, ClustersGoUpAreLookedAtAndGoDown) {
  const auto up = Parsed<ClusterArguments>({"cluster",
                                            "up",
                                            "--engine",
                                            "slurm",
                                            "--workers",
                                            "4..64",
                                            "--partition",
                                            "render",
                                            "--time",
                                            "8:00:00",
                                            "--worker-memory",
                                            "8GB",
                                            "--engine-option=--constraint=avx2",
                                            "--engine-option=--exclusive",
                                            "--slots",
                                            "4",
                                            "--threads",
                                            "2",
                                            "--tags",
                                            "a,b",
                                            "--name",
                                            "night",
                                            "--state",
                                            "s",
                                            "--batch",
                                            "--path-map",
                                            "/a=/b"});
  EXPECT_EQ(up.action, ClusterArguments::Action::kUp);
  EXPECT_EQ(up.engine.engine, "slurm");
  EXPECT_EQ(up.engine.workers, "4..64");
  EXPECT_EQ(up.engine.state_dir, "s");
  const ClusterOptions& options = up.engine.options;
  EXPECT_EQ(options.name, "night");
  EXPECT_EQ(options.partition, "render");
  EXPECT_EQ(options.time, "8:00:00");
  EXPECT_EQ(options.worker_memory_bytes, std::uint64_t{8} << 30);
  EXPECT_THAT(options.engine_arguments, ElementsAre("--constraint=avx2", "--exclusive"));
  EXPECT_THAT(options.tags, ElementsAre("a", "b"));
  EXPECT_EQ(options.slots, 4);
  EXPECT_EQ(options.threads, 2);
  EXPECT_TRUE(options.manager_as_job);
  EXPECT_TRUE(Parsed<ClusterArguments>({"cluster", "up", "--foreground"}).foreground);

  const auto status = Parsed<ClusterArguments>({"cluster", "status", "--name", "night", "--json"});
  EXPECT_EQ(status.action, ClusterArguments::Action::kStatus);
  EXPECT_EQ(status.engine.options.name, "night");
  EXPECT_TRUE(status.json);
  EXPECT_EQ(Parsed<ClusterArguments>({"cluster", "down"}).action, ClusterArguments::Action::kDown);
  EXPECT_EQ(Parsed<ClusterArguments>({"cluster", "manage", "--state", "/s"}).action, ClusterArguments::Action::kManage);

  const auto run = Parsed<RunArguments>({"run", "s.json", "-o", "d", "--engine", "slurm", "--workers", "0..8",
                                         "--slurm-partition", "render", "--partition", "blocks"});
  EXPECT_EQ(run.engine.options.partition, "render");
}

TEST(CommandLine, HelpOfEachCommandHasAnExampleAndGoesToStdout) {
  for (const char* command :
       {"demo", "run", "bench", "submit", "status", "watch", "jobs", "cancel", "workers", "import", "keygen"}) {
    const CommandLineExit exit = Exit({command, "--help"});
    EXPECT_EQ(exit.code, kExitOk) << command;
    EXPECT_THAT(exit.output, HasSubstr("Example")) << command;
    EXPECT_TRUE(exit.error.empty()) << exit.error;
  }
}

TEST(CommandLine, ImportKeepsItsOptions) {
  const auto import = Parsed<ImportArguments>(
      {"import",   "--cameras",      "a,b",      "ftv",     "cam.txt",  "-o",     "s.json",
       "--images", "{camera}.yuv",   "--size",   "64x48",   "--z-near", "-3.5",   "--z-far",
       "1e3",      "--pixel-format", "yuv420p8", "--range", "full",     "--pose", "world-to-camera",
       "--z-axis", "backward",       "--json"});
  EXPECT_EQ(import.options.format, "ftv");
  EXPECT_EQ(import.options.calibration, "cam.txt");
  EXPECT_EQ(import.options.output, "s.json");
  EXPECT_THAT(import.options.cameras, ElementsAre("a", "b"));
  EXPECT_EQ(import.options.images, "{camera}.yuv");
  EXPECT_EQ(import.options.z_near, -3.5) << "what it means is for the command";
  EXPECT_EQ(import.options.z_far, 1000);
  EXPECT_EQ(import.options.pose, "world-to-camera");
  EXPECT_EQ(import.options.z_axis, "backward");
  EXPECT_TRUE(import.json);
  EXPECT_FALSE(Parsed<ImportArguments>({"import", "llff", "p.npy", "-o", "s.json"}).options.z_near.has_value());
  EXPECT_EQ(Exit({"import", "ftv", "cam.txt"}).code, kExitBadInput) << "no output";
  EXPECT_EQ(Exit({"import", "ftv", "cam.txt", "-o", "s.json", "--range", "half"}).code, kExitBadInput);
  EXPECT_EQ(
      Parsed<ImportArguments>({"import", "miv", "m.json", "-o", "s.json", "--videos", "v{number}.mp4"}).options.videos,
      "v{number}.mp4");
}

TEST(CommandLine, OverviewNamesEveryCommand) {
  const CommandLineExit exit = Exit({"--help"});
  EXPECT_EQ(exit.code, kExitOk);
  for (const char* command : {"demo", "run", "bench", "submit", "status", "watch", "jobs", "cancel", "workers",
                              "import", "keygen", "scene", "evaluate", "colour", "export"}) {
    EXPECT_THAT(exit.output, HasSubstr(command));
  }
}

TEST(CommandLine, HelpOfRunNamesEveryEstimationOption) {
  const std::string help = Exit({"run", "--help"}).output;
  for (const EstimationOption& option : EstimationOptions()) {
    EXPECT_THAT(help, HasSubstr("--" + std::string(option.name)));
  }
}

TEST(CommandLine, VersionIsPrinted) {
  const CommandLineExit exit = Exit({"--version"});
  EXPECT_EQ(exit.code, kExitOk);
  EXPECT_THAT(exit.output, testing::MatchesRegex("depthfarm [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST(CommandLine, PixelCommandsGoToTheMediaProgram) {
  EXPECT_TRUE(IsMediaCommand("scene"));
  EXPECT_TRUE(IsMediaCommand("evaluate"));
  EXPECT_TRUE(IsMediaCommand("colour"));
  EXPECT_TRUE(IsMediaCommand("export"));
  EXPECT_FALSE(IsMediaCommand("run"));
  EXPECT_FALSE(IsMediaCommand(""));
}

}  // namespace
}  // namespace depthfarm
