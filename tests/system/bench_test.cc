// `depthfarm bench`: what it prints, what it refuses, and that it leaves nothing behind.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

// Its temporary folders are made in one of this test's, so that those that stay are seen.
class Bench : public testing::Test {
 protected:
  void SetUp() override { ::setenv("TMPDIR", temporary_root_.path().c_str(), 1); }
  void TearDown() override {
    EXPECT_TRUE(fs::is_empty(temporary_root_.path())) << "something was left behind";
    ::unsetenv("TMPDIR");
  }

  TemporaryFolder temporary_root_;
  TemporaryFolder folder_;
};

Words TinyScene() { return {"bench", "--size", "160x120", "--cameras", "3", "--seed", "7"}; }

TEST_F(Bench, MeasuresEveryPresetOnASceneOfItsOwn) {
  const Outcome bench =
      Depthfarm(TinyScene() + SmallJob() + Words{"--preset", "default,paper", "--repeat", "2", "--json"});
  ASSERT_EQ(bench.exit_code, 0) << bench.output;
  const nlohmann::json json = ParseJsonTail(bench.output);
  ASSERT_FALSE(json.is_discarded()) << bench.output;
  EXPECT_GT(json["machine"]["cores"].get<int>(), 0);
  EXPECT_FALSE(json["machine"]["cpu"].get<std::string>().empty());
  EXPECT_EQ(json["workers"], 1);
  ASSERT_THAT(json["presets"], SizeIs(2));
  EXPECT_EQ(json["presets"][0]["preset"], "default");
  EXPECT_EQ(json["presets"][1]["preset"], "paper");
  for (const nlohmann::json& preset : json["presets"]) {
    EXPECT_EQ(preset["views"], 3);
    EXPECT_EQ(preset["frames"], 1);
    EXPECT_EQ(preset["width"], 160);
    EXPECT_EQ(preset["levels"], 24);
    EXPECT_THAT(preset["runs"], SizeIs(2));
    EXPECT_GT(preset["cpuSecondsOfView"]["all"].get<double>(), 0);
    EXPECT_GT(preset["peakMemoryBytes"].get<double>(), 1e6);
    EXPECT_GT(preset["psnrY"].get<double>(), 15);
    EXPECT_LT(preset["bad1PxPercent"].get<double>(), 90);
  }
  EXPECT_GT(json["presets"][0]["cpuSecondsOfView"]["refine"].get<double>(), 0);
  EXPECT_EQ(json["presets"][1]["cpuSecondsOfView"]["refine"], 0);
}

TEST_F(Bench, PrintsATableForASequence) {
  const std::string sequence = RenderScene(folder_.path() / "scene", {.cameras = 3, .frames = 2});
  const Outcome bench = Depthfarm(Words{"bench", sequence, "--frames", "0:1"} + SmallJob());
  ASSERT_EQ(bench.exit_code, 0) << bench.output;
  EXPECT_THAT(bench.output, AllOf(HasSubstr("scene: " + sequence), HasSubstr("3 views 160x120"), HasSubstr("24 levels"),
                                  HasSubstr("\npreset   analyse  estimate"), HasSubstr("\ndefault  ")));
}

TEST_F(Bench, KeepsTheTimesWhereQualityCannotBeMeasured) {
  const std::string sequence = RenderScene(folder_.path() / "scene", {.cameras = 2, .frames = 1});
  fs::remove_all(folder_.path() / "scene" / "truth");
  const Outcome bench = Depthfarm(Words{"bench", sequence, "--json"} + SmallJob());
  ASSERT_EQ(bench.exit_code, 0) << bench.output;
  EXPECT_THAT(bench.output, HasSubstr("quality is not known"));
  const nlohmann::json json = ParseJsonTail(bench.output);
  ASSERT_FALSE(json.is_discarded()) << bench.output;
  EXPECT_TRUE(json["presets"][0]["psnrY"].is_null());
  EXPECT_GT(json["presets"][0]["cpuSecondsOfView"]["all"].get<double>(), 0);
}

TEST_F(Bench, RefusesWhatCannotWorkWithoutMeasuringFirst) {
  const auto expect_refused = [](const Words& words, const std::string& reason) {
    const Outcome outcome = Depthfarm(words);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.output;
    EXPECT_THAT(outcome.output, HasSubstr(reason));
    EXPECT_THAT(outcome.output, Not(HasSubstr("run 1 of")));
  };
  expect_refused({"bench", folder_ / "none.json"}, "none.json");
  expect_refused({"bench", "--preset", "default,nosuch"}, "preset is 'nosuch'");
  expect_refused({"bench", "--preset", "default,,paper"}, "preset is ''");
  expect_refused({"bench", "--levels", "1"}, "levels is 1");
  expect_refused({"bench", "--size", "large"}, "--size");
  expect_refused({"bench", "--size", "4x4"}, "width is 4");
  expect_refused({"bench", folder_ / "none.json", "--seed", "3"}, "excludes");
}

TEST_F(Bench, CleansUpWhenInterrupted) {
  const fs::path log = folder_.path() / "log";
  Result<ChildProcess> bench = ChildProcess::Start(
      Program("depthfarm"), TinyScene() + SmallJob() + Words{"--frames", "0:8", "--repeat", "100"}, log);
  ASSERT_TRUE(bench.ok()) << bench.status().message();
  ASSERT_TRUE(WaitUntil([&] { return ReadFile(log).find("run 2 of 100") != std::string::npos; })) << ReadFile(log);
  bench->Signal(SIGINT);
  const std::optional<ProcessEnd> end = bench->WaitFor(kDeadline);
  ASSERT_TRUE(end.has_value()) << ReadFile(log);
  EXPECT_EQ(end->exit_code, 130) << ReadFile(log);
}

}  // namespace
}  // namespace depthfarm::system_test
