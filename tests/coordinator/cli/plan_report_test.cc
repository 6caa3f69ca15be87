#include "coordinator/cli/plan_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "coordinator/planning/cost_model.h"

namespace depthfarm {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

ResolvedJob Job() {
  ResolvedJob job;
  job.params.levels = 54;
  job.num_frames = 25;
  for (const int segments : {39321, 30000}) {
    JobView& view = job.views.emplace_back();
    view.camera.width = segments == 39321 ? 1024 : 1000;
    view.camera.height = segments == 39321 ? 768 : 600;
    view.segments = segments;
  }
  return job;
}

PlanReport Report() {
  PlanReport report;
  report.sequence = "ballet";
  report.description = "2 views 64x48";
  report.choices = {{"levels", "54", "because"}};
  report.forecast.stages = {{.kind = TaskKind::kAnalyse,
                             .tasks = 50,
                             .seconds = 75,
                             .longest_seconds = 1.5,
                             .peak_memory_bytes = std::uint64_t{100} << 20,
                             .result_bytes = 2048,
                             .read_bytes = 0},
                            {.kind = TaskKind::kRefine,
                             .tasks = 1000,
                             .seconds = 45,
                             .longest_seconds = 2.5,
                             .peak_memory_bytes = std::uint64_t{80} << 20,
                             .result_bytes = 1024,
                             .read_bytes = 4096}};
  report.forecast.critical_path = {{JobId(1), 0, TaskKind::kAnalyse, 1, 0},
                                   {JobId(1), 0, TaskKind::kRefine, 0, 1},
                                   {JobId(1), 1, TaskKind::kRefine, 0, 1},
                                   {JobId(1), 0, TaskKind::kManifest, 0, 0}};
  report.forecast.critical_seconds = 12;
  report.forecast.farms = {{1, 125, 120, 0}, {2, 62.5, 122, 6 << 20}};
  report.forecast.more_do_not_help = true;
  report.forecast.frames = 25;
  report.forecast.played_frames = 25;
  return report;
}

std::vector<std::string> OptionsOf(const std::vector<Choice>& choices) {
  std::vector<std::string> options;
  for (const Choice& choice : choices) options.push_back(choice.option);
  return options;
}

TEST(ChoicesOf, SaysWhatWasLeftOpenAndHowFramesAreDivided) {
  const std::vector<Choice> choices = ChoicesOf({}, Job());
  ASSERT_THAT(OptionsOf(choices), ElementsAre("segments", "levels", "level-blocks", "GOPs"));
  EXPECT_EQ(choices[0].value, "30,000 to 39,321");
  EXPECT_EQ(choices[0].reason, "of a view; one for each 20 pixels");
  EXPECT_EQ(choices[1].value, "54");
  EXPECT_THAT(choices[1].reason, HasSubstr("a pixel apart"));
  EXPECT_EQ(choices[2].value, "1");
  EXPECT_EQ(choices[3].value, "3");
  EXPECT_THAT(choices[3].reason, HasSubstr("an I frame and up to 9 P frames"));
}

TEST(ChoicesOf, LeavesOutWhatWasAskedFor) {
  EstimationParams asked;
  asked.segments = 100;
  asked.levels = 54;
  asked.level_blocks = 1;
  EXPECT_THAT(OptionsOf(ChoicesOf(asked, Job())), ElementsAre("GOPs"));
}

TEST(ChoicesOf, KnowsTheReasonsOfOtherChoices) {
  ResolvedJob job = Job();
  job.level_blocks_i = 4;
  job.level_blocks_p = 2;
  job.params.refine_rounds = 0;
  const std::vector<Choice> choices = ChoicesOf({}, job);
  EXPECT_THAT(choices[1].reason, HasSubstr("quarter of a pixel"));
  EXPECT_EQ(choices[2].value, "4, P frames 2");
  EXPECT_THAT(choices[2].reason, HasSubstr("350 MB"));
  job.params.gop = 1;
  EXPECT_EQ(ChoicesOf({}, job)[2].value, "4");
  EXPECT_THAT(ChoicesOf({}, job)[3].reason, HasSubstr("every frame is an I frame"));
  job.params.levels = 250;
  EXPECT_THAT(ChoicesOf({}, job)[1].reason, HasSubstr("as many as"));
  job.views[0].segments = 10000;
  EXPECT_THAT(ChoicesOf({}, job)[0].reason, HasSubstr("20 to 79 pixels: larger"));
}

TEST(FormatPlan, HasStagesPathAndFarms) {
  const std::string text = FormatPlan(Report());
  EXPECT_THAT(text, AllOf(HasSubstr("plan of 'ballet': 2 views 64x48"), HasSubstr("because"), HasSubstr(kCostMachine)));
  EXPECT_THAT(text, HasSubstr("  analyse     50  1 min 15 s         1.5 s  100 MiB  2.0 KiB        -\n"));
  EXPECT_THAT(text, HasSubstr("  all      1,050  2 min 00 s         2.5 s  100 MiB  3.0 KiB  4.0 KiB\n"));
  EXPECT_THAT(text, HasSubstr("critical path: 12.0 s"));
  EXPECT_THAT(text, HasSubstr("  analyse, 2 refine, manifest; of frames 0 to 1\n"));
  EXPECT_THAT(text, HasSubstr("        2  1 min 03 s  98 %  6.0 MiB       2.0\n"));
  EXPECT_THAT(text, HasSubstr("More than 2 workers"));
  EXPECT_THAT(text, Not(HasSubstr("Extrapolated")));
}

TEST(FormatPlan, SaysWhenItIsExtrapolated) {
  PlanReport report = Report();
  report.forecast.frames = 123456;
  report.forecast.played_frames = 6000;
  EXPECT_THAT(FormatPlan(report), HasSubstr("of 123,456 frames the first 6,000 were played through"));
  EXPECT_EQ(PlanToJson(report)["playedFrames"], 6000);
}

TEST(PlanToJson, HoldsTheSame) {
  const nlohmann::ordered_json json = PlanToJson(Report());
  EXPECT_EQ(json["sequence"], "ballet");
  EXPECT_EQ(json["choices"][0]["option"], "levels");
  EXPECT_EQ(json["stages"][1]["stage"], "refine");
  EXPECT_EQ(json["stages"][1]["tasks"], 1000);
  EXPECT_EQ(json["stages"][1]["cpuSeconds"], 45);
  EXPECT_EQ(json["all"]["tasks"], 1050);
  EXPECT_EQ(json["criticalPath"]["seconds"], 12);
  EXPECT_THAT(json["criticalPath"]["tasks"].get<std::vector<std::string>>(),
              ElementsAre("frame 0 analyse view 1", "frame 0 refine round 0 view 1", "frame 1 refine round 0 view 1",
                          "manifest"));
  EXPECT_EQ(json["farms"][1]["workers"], 2);
  EXPECT_EQ(json["farms"][1]["movedBytes"], 6 << 20);
}

}  // namespace
}  // namespace depthfarm
