#include "coordinator/cli/bench_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace depthfarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

void AddStage(BenchRun& run, v1::TaskKind kind, double cpu_seconds, std::uint64_t mebibytes) {
  v1::StageStatus& stage = *run.job.add_stages();
  stage.set_kind(kind);
  stage.set_tasks_done(1);
  stage.set_tasks_total(1);
  stage.set_cpu_seconds(cpu_seconds);
  stage.set_peak_memory_bytes(mebibytes << 20);
}

// Four views of two frames.
BenchRun MakeRun(double analyse_seconds, double wall_seconds) {
  BenchRun run;
  run.wall_seconds = wall_seconds;
  AddStage(run, v1::TASK_KIND_PREPARE, 0.8, 20);
  AddStage(run, v1::TASK_KIND_ANALYSE, analyse_seconds, 300);
  AddStage(run, v1::TASK_KIND_ESTIMATE, 16, 512);
  return run;
}

BenchReport Report() {
  BenchReport report;
  report.machine = {.cpu = "Abacus 9", .cores = 3};
  report.scene = "arc of seed 1";
  report.presets.push_back({.name = "default",
                            .description = "4 views 64x48",
                            .views = 4,
                            .frames = 2,
                            .width = 64,
                            .height = 48,
                            .segments = 1200,
                            .levels = 24,
                            .runs = {MakeRun(9.6, 31), MakeRun(8, 20), MakeRun(32, 40)},
                            .quality = {}});
  return report;
}

TEST(BenchRun, SumsEveryStageAndTakesTheLargestWorker) {
  const BenchRun run = MakeRun(8, 20);
  EXPECT_DOUBLE_EQ(run.CpuSeconds(), 24.8);
  EXPECT_EQ(run.PeakMemoryBytes(), std::uint64_t{512} << 20);
}

TEST(FormatBench, HasMediansOfAViewByStage) {
  const std::string text = FormatBench(Report());
  EXPECT_THAT(text, AllOf(HasSubstr("Abacus 9, 3 cores"), HasSubstr("arc of seed 1"), HasSubstr("4 views 64x48"),
                          HasSubstr("medians of 3 runs")));
  EXPECT_THAT(text, HasSubstr("preset   analyse  estimate   all    wall   memory  PSNR  bad\n"
                              "default     1.20      2.00  3.30  31.0 s  512 MiB     -    -\n"));
}

TEST(FormatBench, ShowsConfidenceOnlyWhereItWasAskedFor) {
  BenchReport report = Report();
  EXPECT_THAT(FormatBench(report), Not(HasSubstr("assess")));
  AddStage(report.presets[0].runs[0], v1::TASK_KIND_ASSESS, 1, 1);
  EXPECT_THAT(FormatBench(report), HasSubstr("assess"));
}

TEST(BenchToJson, HoldsWhatTheTableSaysAndEveryRun) {
  BenchReport report = Report();
  report.presets[0].quality.psnr_db = 34.5;
  const nlohmann::json json = nlohmann::json::parse(BenchToJson(report).dump());
  EXPECT_EQ(json["machine"]["cores"], 3);
  const nlohmann::json& preset = json["presets"][0];
  EXPECT_EQ(preset["preset"], "default");
  EXPECT_EQ(preset["segments"], 1200);
  EXPECT_DOUBLE_EQ(preset["cpuSecondsOfView"]["analyse"].get<double>(), 1.2);
  EXPECT_DOUBLE_EQ(preset["cpuSecondsOfView"]["all"].get<double>(), 3.3);
  EXPECT_EQ(preset["psnrY"], 34.5);
  EXPECT_TRUE(preset["bad1PxPercent"].is_null());
  ASSERT_EQ(preset["runs"].size(), 3U);
  EXPECT_EQ(preset["runs"][1]["wallSeconds"], 20);
  EXPECT_EQ(preset["runs"][1]["stages"][1]["stage"], "analyse");
}

TEST(QualityOf, KnowsOnlyWhatWasMeasured) {
  const auto quality = [](const char* text) { return QualityOf(nlohmann::json::parse(text, nullptr, false)); };
  const BenchQuality all =
      quality(R"({"mean": {"psnrY": 36.5}, "depthError": {"allViews": {"all": {"bad1PxPercent": 2.5}}}})");
  EXPECT_EQ(all.psnr_db, 36.5);
  EXPECT_EQ(all.bad_px_percent, 2.5);
  EXPECT_TRUE(std::isnan(quality(R"({"mean": {"psnrY": null}})").psnr_db));
  EXPECT_TRUE(std::isnan(quality(R"({"mean": {"psnrY": 36.5}})").bad_px_percent));
  EXPECT_TRUE(std::isnan(quality("no JSON").psnr_db));
}

TEST(CpuName, IsThatOfTheFirstCpu) {
  std::istringstream info("processor\t: 0\nmodel name\t: Abacus 9 @ 1 Hz\nflags\t\t: x\nmodel name\t: other\n");
  EXPECT_EQ(CpuName(info), "Abacus 9 @ 1 Hz");
  std::istringstream without("processor\t: 0\nmodel name\n");
  EXPECT_EQ(CpuName(without), "");
}

}  // namespace
}  // namespace depthfarm
