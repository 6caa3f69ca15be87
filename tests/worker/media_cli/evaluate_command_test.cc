#include "worker/media_cli/evaluate_command.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "tests/worker/media_cli/evaluated_scene.h"

namespace depthfarm {
namespace {

// One scene serves all tests: rendering is what costs.
class EvaluateCommandTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scene_ = std::make_unique<EvaluatedScene>();
    exact_ = scene_->WriteDepth("exact", [](DepthMap&) {});
    pair_ = scene_->WriteDepth("pair", [](DepthMap&) {}, {"cam1", "cam2"});
    nearer_ = scene_->WriteDepth("nearer", [](DepthMap& depth) {
      for (float& z : depth.values()) z *= 0.97F;
    });
    noisy_ = scene_->WriteDepth("noisy", [](DepthMap& depth) {
      std::mt19937 random(1);
      for (float& z : depth.values()) z *= 1.0F + 0.1F * (static_cast<float>(random() % 1000) / 1000.0F - 0.5F);
    });
    noisier_ = scene_->WriteDepth("noisier", [](DepthMap& depth) {
      std::mt19937 random(1);
      for (float& z : depth.values()) z *= 1.0F + 0.3F * (static_cast<float>(random() % 1000) / 1000.0F - 0.5F);
    });
  }
  static void TearDownTestSuite() { scene_.reset(); }

  static EvaluateCommandOptions Options(const std::string& depth_dir) {
    EvaluateCommandOptions options;
    options.sequence = scene_->sequence_file();
    options.depth_dir = depth_dir;
    options.json = true;
    return options;
  }
  static nlohmann::json Report(const EvaluateCommandOptions& options) {
    std::ostringstream out;
    const Status status = RunEvaluate(options, out);
    EXPECT_TRUE(status.ok()) << status.message();
    return nlohmann::json::parse(out.str());
  }
  static Status Failure(const EvaluateCommandOptions& options) {
    std::ostringstream out;
    return RunEvaluate(options, out);
  }

  static std::unique_ptr<EvaluatedScene> scene_;
  static std::string exact_;
  static std::string pair_;
  static std::string nearer_;
  static std::string noisy_;
  static std::string noisier_;
};

std::unique_ptr<EvaluatedScene> EvaluateCommandTest::scene_;
std::string EvaluateCommandTest::exact_;
std::string EvaluateCommandTest::pair_;
std::string EvaluateCommandTest::nearer_;
std::string EvaluateCommandTest::noisy_;
std::string EvaluateCommandTest::noisier_;

TEST_F(EvaluateCommandTest, ExactDepthReachesTheCeilingAndHasNoError) {
  const nlohmann::json report = Report(Options(exact_));
  ASSERT_EQ(report["virtualViews"].size(), 2U);  // cam1 and cam2 lie between others, the ends of the arc don't
  for (const nlohmann::json& view : report["virtualViews"]) {
    EXPECT_NEAR(view["difference"]["psnrY"].get<double>(), 0, 0.05);
    EXPECT_EQ(view["frames"].size(), 2U);
    EXPECT_GT(view["estimated"]["psnrY"].get<double>(), view["singlePlanePsnrY"].get<double>() + 5);
    // Of the railing, thinner than a pixel here, one view may show what falls between the pixels of the other.
    EXPECT_GT(view["agreement"]["nonOccludedPercent"].get<double>(), 99);
  }
  const nlohmann::json& all = report["depthError"]["allViews"]["all"];
  EXPECT_EQ(all["pixels"], 4 * 2 * 160 * 120);
  EXPECT_EQ(all["bad1LevelPercent"], 0);
  EXPECT_LT(all["meanPx"], 0.001);
  EXPECT_EQ(all["completenessPercent"], 100);
  EXPECT_TRUE(report["depthError"]["allViews"].contains("panel"));
}

// Like with like: a bias and a noise have no order between them that holds for every scene.
TEST_F(EvaluateCommandTest, WorseDepthScoresWorse) {
  const double exact = Report(Options(exact_))["mean"]["psnrY"];
  const double nearer = Report(Options(nearer_))["mean"]["psnrY"];
  const double noisy = Report(Options(noisy_))["mean"]["psnrY"];
  const double noisier = Report(Options(noisier_))["mean"]["psnrY"];
  EXPECT_GT(exact, nearer + 0.5);
  EXPECT_GT(exact, noisy + 0.5);
  EXPECT_GT(noisy, noisier + 0.5);
  EXPECT_GT(Report(Options(noisy_))["mean"]["ivPsnr"], Report(Options(noisier_))["mean"]["ivPsnr"]);
  EXPECT_GT(Report(Options(noisy_))["depthError"]["allViews"]["all"]["bad1LevelPercent"], 5);
}

TEST_F(EvaluateCommandTest, LevelsAreThoseTheJobRecorded) {  // not those of the sequence's range: --z-near may differ
  const std::string narrow = scene_->WriteDepth("narrow", [](DepthMap&) {});
  const std::string file = narrow + "/depth.json";
  nlohmann::json manifest = nlohmann::json::parse(std::ifstream(file));
  const nlohmann::json sequence = nlohmann::json::parse(std::ifstream(scene_->sequence_file()));
  const double z_near = sequence["zNear"];
  const double z_far = sequence["zFar"];
  manifest["parameters"]["zNear"] = 2 / (1 / z_near + 1 / z_far);  // half of the range of 1/z
  manifest["parameters"]["zFar"] = z_far;
  std::ofstream(file) << manifest.dump();
  const double whole_px = Report(Options(exact_))["levelPx"];
  EXPECT_NEAR(Report(Options(narrow))["levelPx"].get<double>(), whole_px / 2, 0.02 * whole_px);
}

TEST_F(EvaluateCommandTest, ANamedViewAndItsSourcesAreTaken) {
  EvaluateCommandOptions options = Options(exact_);
  options.view = "cam0";
  options.from = {"cam1", "cam3"};
  options.first_frame = 1;
  options.end_frame = 2;
  const nlohmann::json report = Report(options);
  ASSERT_EQ(report["virtualViews"].size(), 1U);
  EXPECT_EQ(report["virtualViews"][0]["view"], "cam0");
  EXPECT_EQ(report["virtualViews"][0]["from"], (nlohmann::json{"cam1", "cam3"}));
  EXPECT_EQ(report["virtualViews"][0]["frames"].size(), 1U);
}

TEST_F(EvaluateCommandTest, WithoutAViewBetweenOthersOnlyDepthIsMeasured) {
  const nlohmann::json report = Report(Options(pair_));
  EXPECT_TRUE(report["virtualViews"].empty());
  EXPECT_EQ(report["notes"].size(), 1U);
  EXPECT_EQ(report["depthError"]["views"].size(), 2U);
  EXPECT_TRUE(report["mean"]["psnrY"].is_null());
}

TEST_F(EvaluateCommandTest, ALeftOutViewIsSynthesised) {
  const std::string sides = scene_->WriteDepth("sides", [](DepthMap&) {}, {"cam0", "cam2"});
  const nlohmann::json report = Report(Options(sides));
  ASSERT_EQ(report["virtualViews"].size(), 1U);
  EXPECT_EQ(report["virtualViews"][0]["view"], "cam1");
}

// Noise that is the same in both frames is an error, not a flicker.
TEST_F(EvaluateCommandTest, ConfidenceIsMeasuredWhereThereIsAny) {
  EXPECT_FALSE(Report(Options(exact_)).contains("confidence"));
  const auto left_is_wrong = [](DepthMap& depth) {
    for (int y = 0; y < depth.height(); ++y)
      for (int x = 0; x < 20; ++x) depth(x, y) *= 0.8F;
  };
  const auto figures = [&](const std::string& name, const EvaluatedScene::Confidence& confidence) {
    return Report(Options(scene_->WriteDepth(name, left_is_wrong, {}, confidence)))["confidence"]["allViews"];
  };
  const nlohmann::json knows = figures("knows", [](int x) { return static_cast<std::uint16_t>(x < 20 ? 0 : 65535); });
  const nlohmann::json errs = figures("errs", [](int x) { return static_cast<std::uint16_t>(x < 20 ? 65535 : 0); });
  EXPECT_EQ(knows["pixels"], 4 * 2 * 160 * 120);
  EXPECT_NEAR(knows["auseBad1PxPercent"], 0, 0.05);
  EXPECT_GT(errs["auseBad1PxPercent"], 20);
  EXPECT_LT(knows["calibrationErrorPercent"], 1);
  EXPECT_GT(errs["calibrationErrorPercent"], 95);
  EXPECT_NEAR(knows["curve"][0]["bad1PxPercent"], 12.5, 1) << "20 of 160 columns are wrong";
  EXPECT_NEAR(knows["curve"][4]["bad1PxPercent"], 0, 0.05) << "of the 75 % most confident pixels";

  EvaluateCommandOptions table = Options(scene_->File("knows"));
  table.json = false;
  std::ostringstream out;
  ASSERT_TRUE(RunEvaluate(table, out).ok());
  EXPECT_NE(out.str().find("Confidence against exact depth"), std::string::npos);
}

TEST_F(EvaluateCommandTest, DepthThatFlickersIsLessStable) {
  int map = 0;
  const std::string flickering = scene_->WriteDepth("flickering", [&map](DepthMap& depth) {
    std::mt19937 random(static_cast<unsigned>(++map));
    for (float& z : depth.values()) z *= 1.0F + 0.1F * (static_cast<float>(random() % 1000) / 1000.0F - 0.5F);
  });
  const nlohmann::json exact = Report(Options(exact_))["stability"]["allViews"];
  const nlohmann::json noisy = Report(Options(noisy_))["stability"]["allViews"];
  const nlohmann::json flicker = Report(Options(flickering))["stability"]["allViews"];
  EXPECT_GT(exact["stillPixels"], 4 * 160 * 120 / 2);
  EXPECT_LT(exact["changedPercent"], 3);
  EXPECT_LT(noisy["changedPercent"], 3);
  EXPECT_GT(flicker["changedPercent"], 30);
}

TEST_F(EvaluateCommandTest, BitRatesAreThoseOfTheViewsAndTheirSourcesDepth) {
  EvaluateCommandOptions options = Options(noisy_);
  options.view = "cam1";
  options.against = exact_;
  const nlohmann::json report = Report(options);
  ASSERT_EQ(report["rates"]["virtualViews"].size(), 1U);
  ASSERT_EQ(report["rates"]["depth"].size(), 2U);
  const nlohmann::json& points = report["rates"]["virtualViews"]["cam1"];
  ASSERT_EQ(points.size(), 4U);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_GT(points[i]["qp"], points[i - 1]["qp"]);
    EXPECT_LT(points[i]["bitsPerPicture"], points[i - 1]["bitsPerPicture"]);
    EXPECT_LT(points[i]["psnrY"], points[i - 1]["psnrY"]);
  }
  EXPECT_GT(report["against"]["bdRateDepthPercent"]["cam0"], 50) << "noise is dear";
  EXPECT_GT(report["against"]["meanBdRateVirtualViewsPercent"], 0);
}

TEST_F(EvaluateCommandTest, AgainstItselfTheBitRateIsTheSame) {
  EvaluateCommandOptions options = Options(exact_);
  options.against = exact_;
  const nlohmann::json report = Report(options);
  EXPECT_EQ(report["rates"], report["against"]["rates"]);
  EXPECT_NEAR(report["against"]["meanBdRateVirtualViewsPercent"].get<double>(), 0, 1e-6);
  EXPECT_NEAR(report["against"]["meanBdRateDepthPercent"].get<double>(), 0, 1e-6);
}

TEST_F(EvaluateCommandTest, AgainstAFolderWithoutTheSourcesIsAnError) {
  EvaluateCommandOptions options = Options(exact_);
  options.against = pair_;
  EXPECT_NE(Failure(options).message().find("no depth of camera 'cam0' in " + pair_), std::string::npos)
      << Failure(options).message();
  options.against = scene_->File("nowhere");
  EXPECT_EQ(Failure(options).code(), ErrorCode::kInvalidArgument);
}

TEST_F(EvaluateCommandTest, TheTableNamesItsScale) {
  EvaluateCommandOptions options = Options(exact_);
  options.json = false;
  options.against = exact_;
  std::ostringstream out;
  ASSERT_TRUE(RunEvaluate(options, out).ok());
  EXPECT_NE(out.str().find("libx265"), std::string::npos);
  EXPECT_NE(out.str().find("BT.601"), std::string::npos) << out.str();
  EXPECT_NE(out.str().find("difference"), std::string::npos);
  EXPECT_EQ(out.str().find("nan"), std::string::npos) << out.str();
}

TEST_F(EvaluateCommandTest, BelowTheBoundItFailsAfterReporting) {
  EvaluateCommandOptions options = Options(noisy_);
  options.min_psnr = 60;
  std::ostringstream out;
  const Status status = RunEvaluate(options, out);
  EXPECT_EQ(status.code(), ErrorCode::kInternal);
  EXPECT_NE(status.message().find("60.00"), std::string::npos) << status.message();
  EXPECT_FALSE(out.str().empty());
  options.min_psnr = 5;
  EXPECT_TRUE(RunEvaluate(options, out).ok());
}

TEST_F(EvaluateCommandTest, EveryBoundCountsAndAllViolationsAreTold) {
  EvaluateCommandOptions options = Options(noisier_);
  options.min_iv_psnr = 90;
  options.min_agreement = 99.9;
  options.max_bad_px = 0.001;
  options.max_flicker = 100;
  const Status status = Failure(options);
  EXPECT_EQ(status.code(), ErrorCode::kInternal);
  for (const char* part : {"IV-PSNR", "90.00", "agree", "99.90", "more than 1 px"}) {
    EXPECT_NE(status.message().find(part), std::string::npos) << status.message();
  }
  EXPECT_EQ(status.message().find("still pixels"), std::string::npos) << status.message();

  options = Options(exact_);
  options.min_psnr = 20;
  options.min_iv_psnr = 20;
  options.min_agreement = 90;
  options.max_bad_px = 1;
  options.max_flicker = 10;
  EXPECT_TRUE(Failure(options).ok()) << Failure(options).message();
  options.end_frame = 1;  // a single frame does not flicker: what is not measured cannot be vouched for
  EXPECT_NE(Failure(options).message().find("not measured"), std::string::npos) << Failure(options).message();
}

TEST_F(EvaluateCommandTest, PicturesAreWritten) {
  EvaluateCommandOptions options = Options(exact_);
  options.view = "cam1";
  options.end_frame = 1;
  options.pictures_dir = scene_->File("pictures");
  ASSERT_EQ(Report(options)["virtualViews"].size(), 1U);
  for (const char* name : {"cam1/0000_synthesised.png", "cam1/0000_real.png", "cam1/0000_difference.png",
                           "cam1/0000_exact.png", "cam0/0000_depth.png", "cam2/0000_depth.png"}) {
    EXPECT_TRUE(std::filesystem::exists(options.pictures_dir + "/" + name)) << name;
  }
}

TEST_F(EvaluateCommandTest, BadInputIsNamed) {
  EvaluateCommandOptions options = Options(exact_);
  options.view = "cam9";
  EXPECT_EQ(Failure(options).code(), ErrorCode::kInvalidArgument);
  EXPECT_NE(Failure(options).message().find("cam0, cam1, cam2, cam3"), std::string::npos) << Failure(options).message();
  options.view = "cam0";  // an end of the arc
  EXPECT_NE(Failure(options).message().find("--from"), std::string::npos) << Failure(options).message();
  options.from = {"cam0"};
  EXPECT_EQ(Failure(options).code(), ErrorCode::kInvalidArgument);

  options = Options(pair_);
  options.view = "cam1";
  options.from = {"cam0", "cam2"};
  EXPECT_NE(Failure(options).message().find("no depth of camera 'cam0'"), std::string::npos);

  options = Options(exact_);
  options.from = {"cam0"};
  EXPECT_NE(Failure(options).message().find("--view"), std::string::npos);

  options = Options(exact_);
  options.end_frame = 3;
  EXPECT_NE(Failure(options).message().find("0:2"), std::string::npos) << Failure(options).message();

  options = Options(scene_->File("nowhere"));
  EXPECT_FALSE(Failure(options).ok());
}

}  // namespace
}  // namespace depthfarm
