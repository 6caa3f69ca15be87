#include "coordinator/cli/estimation_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

namespace depthfarm {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Result<EstimationParams> Build(std::vector<std::pair<std::string, std::string>> values, std::string preset = "") {
  return BuildEstimationParams({.preset = std::move(preset), .params_file = "", .values = std::move(values)});
}

TEST(EstimationOptions, WithoutAnyAreTheDefaults) {
  const Result<EstimationParams> params = Build({});
  ASSERT_TRUE(params.ok()) << params.status().message();
  EXPECT_EQ(*params, EstimationParams());
}

struct AcceptedCase {
  std::string option;
  std::string text;
  void (*expect)(EstimationParams& params);  // turns the defaults into what is expected
};
class AcceptedOption : public testing::TestWithParam<AcceptedCase> {};

TEST_P(AcceptedOption, SetsItsFieldAndNoOther) {
  EstimationParams expected;
  GetParam().expect(expected);
  const Result<EstimationParams> params = Build({{GetParam().option, GetParam().text}});
  ASSERT_TRUE(params.ok()) << params.status().message();
  EXPECT_EQ(*params, expected) << GetParam().option << " " << GetParam().text;
}

INSTANTIATE_TEST_SUITE_P(All, AcceptedOption,
                         testing::ValuesIn(std::vector<AcceptedCase>{
                             {"segments", "600", [](EstimationParams& p) { p.segments = 600; }},
                             {"segments", "auto", [](EstimationParams&) {}},
                             {"levels", "24", [](EstimationParams& p) { p.levels = 24; }},
                             {"levels", "auto", [](EstimationParams&) {}},
                             {"z-near", "0.5", [](EstimationParams& p) { p.z_near = 0.5; }},
                             {"z-far", "1e3", [](EstimationParams& p) { p.z_far = 1000; }},
                             {"smoothing", "0", [](EstimationParams& p) { p.smoothing = 0; }},
                             {"smoothing", "2.25", [](EstimationParams& p) { p.smoothing = 2.25; }},
                             {"matching-window", "5", [](EstimationParams& p) { p.matching_window = 5; }},
                             {"matching-offset", "15.5", [](EstimationParams& p) { p.matching_offset = 15.5; }},
                             {"uniqueness", "0", [](EstimationParams& p) { p.uniqueness = 0; }},
                             {"uniqueness", "60", [](EstimationParams& p) { p.uniqueness = 60; }},
                             {"snic-compactness", "10", [](EstimationParams& p) { p.snic_compactness = 10; }},
                             {"gop", "1", [](EstimationParams& p) { p.gop = 1; }},
                             {"anchor", "shared", [](EstimationParams& p) { p.anchor = Anchor::kShared; }},
                             {"gop", "all", [](EstimationParams& p) { p.gop = 0; }},
                             {"p-threshold", "0", [](EstimationParams& p) { p.p_threshold = 0; }},
                             {"i-threshold", "7", [](EstimationParams& p) { p.i_threshold = 7; }},
                             {"level-blocks", "4", [](EstimationParams& p) { p.level_blocks = 4; }},
                             {"level-blocks", "auto", [](EstimationParams&) {}},
                             {"partition", "blocks", [](EstimationParams& p) { p.partition = Partition::kContiguous; }},
                             {"partition", "interleaved", [](EstimationParams&) {}},
                             {"views", "cam0,cam 2,c",
                              [](EstimationParams& p) {
                                p.views = {"cam0", "cam 2", "c"};
                              }},
                             {"frames", "2:7",
                              [](EstimationParams& p) {
                                p.first_frame = 2;
                                p.end_frame = 7;
                              }},
                             {"frames", ":7", [](EstimationParams& p) { p.end_frame = 7; }},
                             {"frames", "2:", [](EstimationParams& p) { p.first_frame = 2; }},
                             {"frames", ":", [](EstimationParams&) {}},
                             {"downscale", "4", [](EstimationParams& p) { p.downscale = 4; }},
                             {"neighbors", "3", [](EstimationParams& p) { p.neighbours = 3; }},
                             {"refine", "0", [](EstimationParams& p) { p.refine_rounds = 0; }},
                             {"confidence", "on", [](EstimationParams& p) { p.confidence = true; }},
                             {"confidence", "off", [](EstimationParams&) {}},
                             {"output-format", "exr", [](EstimationParams& p) { p.output_format = DepthFormat::kExr; }},
                             {"output-format", "png16", [](EstimationParams&) {}},
                             {"holes", "0.25", [](EstimationParams& p) { p.holes = 0.25; }},
                             {"segment-pixels", "25", [](EstimationParams& p) { p.segment_pixels = 25; }},
                             {"choice-rounds", "3", [](EstimationParams& p) { p.choice_rounds = 3; }},
                             {"compared", "2", [](EstimationParams& p) { p.compared = 2; }},
                             {"sweeps", "sparse", [](EstimationParams&) {}},
                             {"sweeps", "2",
                              [](EstimationParams& p) {
                                p.search = Search::kFull;
                                p.max_sweeps = 2;
                              }},
                             {"sweeps", "auto",
                              [](EstimationParams& p) {
                                p.search = Search::kFull;
                                p.max_sweeps = 0;
                              }},
                         }));

class RefusedOption : public testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(RefusedOption, NamesOptionAndValue) {
  const auto& [option, text] = GetParam();
  const Result<EstimationParams> params = Build({{option, text}});
  ASSERT_FALSE(params.ok()) << option << " " << text;
  EXPECT_EQ(params.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(params.status().message(), AllOf(HasSubstr(option), HasSubstr("expected"))) << text;
}

INSTANTIATE_TEST_SUITE_P(All, RefusedOption,
                         testing::ValuesIn(std::vector<std::pair<std::string, std::string>>{
                             {"segments", "0"},         {"segments", "many"},
                             {"segments", "10x"},       {"segments", ""},
                             {"segments", "1e9"},       {"segments", "99999999999"},
                             {"levels", "1"},           {"levels", "-3"},
                             {"levels", "2.5"},         {"z-near", "0"},
                             {"z-near", "-1"},          {"z-near", "nan"},
                             {"z-far", "inf"},          {"smoothing", "-0.1"},
                             {"smoothing", "nan"},      {"smoothing", "1,5"},
                             {"matching-window", "4"},  {"matching-window", "17"},
                             {"matching-offset", "0"},  {"matching-offset", "766"},
                             {"uniqueness", "-1"},      {"uniqueness", "100"},
                             {"uniqueness", "7.5"},     {"uniqueness", "auto"},
                             {"output-format", "png"},  {"output-format", ""},
                             {"confidence", "yes"},     {"confidence", ""},
                             {"holes", "half"},         {"holes", "1"},
                             {"snic-compactness", "0"}, {"gop", "0"},
                             {"p-threshold", "-1"},     {"i-threshold", "256"},
                             {"level-blocks", "0"},     {"level-blocks", "5000"},
                             {"partition", "stripes"},  {"views", ""},
                             {"views", "a,,b"},         {"views", "a,"},
                             {"frames", "5"},           {"frames", "5:5"},
                             {"frames", "-1:5"},        {"frames", "1:2:3"},
                             {"frames", "a:b"},         {"downscale", "3"},
                             {"neighbors", "0"},        {"sweeps", "0"},
                             {"sweeps", "1001"},
                         }));

TEST(EstimationOptions, HaveDistinctNamesAndHelp) {
  std::set<std::string_view> names;
  for (const EstimationOption& option : EstimationOptions()) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    EXPECT_FALSE(option.help.empty()) << option.name;
    EXPECT_FALSE(option.value.empty()) << option.name;
  }
}

TEST(EstimationOptions, ExplicitValuesOverrideThePreset) {
  const Result<EstimationParams> params = Build({{"level-blocks", "4"}}, "paper");
  ASSERT_TRUE(params.ok());
  EXPECT_EQ(params->levels, 250);
  EXPECT_EQ(params->level_blocks, 4);
}

TEST(EstimationOptions, AnUnknownPresetIsRefusedWithTheKnownOnes) {
  const Result<EstimationParams> params = Build({}, "fastest");
  ASSERT_FALSE(params.ok());
  EXPECT_THAT(params.status().message(), AllOf(HasSubstr("fastest"), HasSubstr("paper")));
}

TEST(EstimationOptions, BoundsBetweenTwoOptionsAreChecked) {
  EXPECT_FALSE(Build({{"levels", "4"}, {"level-blocks", "5"}}).ok());
  EXPECT_FALSE(Build({{"z-near", "4"}, {"z-far", "3"}}).ok());
}

TEST(ParamsFile, SaysTheSameAsTheCommandLine) {
  const Result<EstimationParams> file = ParseParamsJson(
      R"({"preset": "paper", "segments": "auto", "levels": 64, "smoothing": 0.5, "partition": "blocks",
          "frames": "1:4", "views": ["left", "right"], "z-near": 2})",
      "p.json", "");
  ASSERT_TRUE(file.ok()) << file.status().message();
  const Result<EstimationParams> line = Build({{"levels", "64"},
                                               {"smoothing", "0.5"},
                                               {"partition", "blocks"},
                                               {"frames", "1:4"},
                                               {"views", "left,right"},
                                               {"z-near", "2"}},
                                              "paper");
  ASSERT_TRUE(line.ok());
  EXPECT_EQ(*file, *line);
}

TEST(ParamsFile, ThePresetOfTheCommandLineWins) {
  const Result<EstimationParams> params = ParseParamsJson(R"({"preset": "paper"})", "p.json", "default");
  ASSERT_TRUE(params.ok());
  EXPECT_EQ(*params, EstimationParams());
}

TEST(ParamsFile, ErrorsNameFileAndKey) {
  const auto message = [](std::string_view text) {
    const Result<EstimationParams> params = ParseParamsJson(text, "p.json", "");
    return params.ok() ? std::string("accepted") : params.status().message();
  };
  EXPECT_THAT(message(R"({"level": 3})"), AllOf(HasSubstr("p.json"), HasSubstr("'level'"), HasSubstr("levels")));
  EXPECT_THAT(message(R"({"levels": 3, "levels": 4})"), AllOf(HasSubstr("p.json"), HasSubstr("levels")));
  EXPECT_THAT(message(R"({"levels": null})"), AllOf(HasSubstr("p.json"), HasSubstr("levels"), HasSubstr("null")));
  EXPECT_THAT(message(R"({"levels": 2.5})"), AllOf(HasSubstr("p.json"), HasSubstr("levels"), HasSubstr("2.5")));
  EXPECT_THAT(message(R"({"views": [1]})"), AllOf(HasSubstr("p.json"), HasSubstr("views")));
  EXPECT_THAT(message(R"({"views": []})"), AllOf(HasSubstr("p.json"), HasSubstr("views")));
  EXPECT_THAT(message(R"({"preset": 1})"), AllOf(HasSubstr("p.json"), HasSubstr("preset")));
  EXPECT_THAT(message("[1]"), AllOf(HasSubstr("p.json"), HasSubstr("object")));
  EXPECT_THAT(message("{"), HasSubstr("p.json"));
}

TEST(ParamsFile, AFileThatIsNotThereIsBadInput) {
  const Result<EstimationParams> params =
      BuildEstimationParams({.preset = "", .params_file = "/nonexistent/p.json", .values = {}});
  ASSERT_FALSE(params.ok());
  EXPECT_EQ(params.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(params.status().message(), HasSubstr("/nonexistent/p.json"));
}

TEST(ParamsFile, IsOverriddenByExplicitOptions) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "override_params.json";
  std::ofstream(file) << R"({"levels": 64, "gop": 3})";
  const Result<EstimationParams> params =
      BuildEstimationParams({.preset = "", .params_file = file.string(), .values = {{"levels", "32"}}});
  std::filesystem::remove(file);
  ASSERT_TRUE(params.ok()) << params.status().message();
  EXPECT_EQ(params->levels, 32);
  EXPECT_EQ(params->gop, 3);
}

}  // namespace
}  // namespace depthfarm
