// Priors and masks, from the command line to the depth.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class GuidedRuns : public testing::Test {
 protected:
  void SetUp() override { sequence_ = RenderScene(folder_.path() / "scene", {.cameras = 3, .frames = 3}); }

  // A folder of the scene's exact depth.
  [[nodiscard]] std::string ExactPrior() const {
    const fs::path prior = folder_.path() / "prior";
    for (const char* camera : {"cam0", "cam1", "cam2"}) {
      fs::create_directories(prior / "depth" / camera);
      for (int frame = 0; frame < 3; ++frame) {
        const std::string name = "000" + std::to_string(frame) + ".pfm";
        fs::copy_file(folder_.path() / "scene" / "truth" / camera / name, prior / "depth" / camera / name);
      }
    }
    std::ofstream(prior / "prior.json") << R"({"holds": "depth"})";
    return prior.string();
  }
  [[nodiscard]] Outcome Run(const std::string& output, const Words& options) const {
    return Depthfarm(Words{"run", sequence_, "-o", folder_ / output} + SmallJob() + options);
  }
  [[nodiscard]] std::map<std::string, std::string> Depth(const std::string& output) const {
    return DepthOf(folder_.path() / output);
  }

  TemporaryFolder folder_;
  std::string sequence_;
};

TEST_F(GuidedRuns, APriorChangesDepthAndGivesTheSameBytesOnAnyNumberOfWorkers) {
  const std::string prior = ExactPrior();
  for (const auto& [output, options] :
       {std::pair{"without", Words{"--workers", "2"}}, std::pair{"one", Words{"--workers", "1", "--prior", prior}},
        std::pair{"two", Words{"--workers", "2", "--prior", prior}}}) {
    const Outcome run = Run(output, options);
    ASSERT_EQ(run.exit_code, 0) << run.output;
  }
  EXPECT_THAT(Differences(Depth("one"), Depth("two")), IsEmpty());
  EXPECT_THAT(Differences(Depth("one"), Depth("without")), Not(IsEmpty()));
  EXPECT_THAT(ReadFile(folder_.path() / "one" / "depth.json"), HasSubstr("\"prior/cam1\": \"depth\""));
  EXPECT_THAT(ReadFile(folder_.path() / "without" / "depth.json"), Not(HasSubstr("prior")));
}

// What contradicts the pictures changes nothing, and that is told.
TEST_F(GuidedRuns, AMaskAndAPriorThatAreLeftAsideAreReported) {
  const std::string prior = ExactPrior();
  std::string noise = "Pf\n160 120\n-1\n";
  for (int pixel = 0; pixel < 160 * 120; ++pixel) {
    const auto depth = static_cast<float>(2 + 0.4 * (pixel * 7 % 11));
    noise.append(reinterpret_cast<const char*>(&depth), sizeof depth);
  }
  std::string checks = "P5\n160 120\n255\n";
  for (int pixel = 0; pixel < 160 * 120; ++pixel) checks += pixel / 10 % 2 == pixel / 1600 % 2 ? '\0' : '\xff';
  for (const char* camera : {"cam0", "cam1", "cam2"}) {
    std::ofstream(fs::path(prior) / "depth" / camera / "0000.pfm") << noise;
    fs::create_directories(folder_.path() / "masks" / camera);
    std::ofstream(folder_.path() / "masks" / camera / "0000.png") << checks;
  }
  const Outcome exact = Run("exact", {"--prior", prior, "--frames", "1:2"});
  ASSERT_EQ(exact.exit_code, 0) << exact.output;
  EXPECT_THAT(exact.output, Not(HasSubstr("left aside")));
  const Outcome run = Run("out", {"--prior", prior, "--mask", folder_ / "masks", "--frames", "0:1"});
  ASSERT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output,
              AllOf(HasSubstr("left aside: the masks of "), HasSubstr(": their contours are not those of the pictures"),
                    HasSubstr("left aside: the priors of 3 pictures, the first at frame 0 refine")));
}

TEST_F(GuidedRuns, ARunBeforeIsAPrior) {
  ASSERT_EQ(Run("first", {"--confidence", "on"}).exit_code, 0);
  const Outcome run = Run("second", {"--prior", folder_ / "first"});
  EXPECT_EQ(run.exit_code, 0) << run.output;
}

TEST_F(GuidedRuns, AMaskIsFoundByCameraAndFrame) {
  fs::create_directories(folder_.path() / "masks" / "cam1");
  fs::copy_file(folder_.path() / "scene" / "cam1" / "0001.png", folder_.path() / "masks" / "cam1" / "0001.png");
  const Outcome coloured = Run("out", {"--mask", folder_ / "masks"});
  EXPECT_EQ(coloured.exit_code, 2) << coloured.output;
  EXPECT_THAT(coloured.output, AllOf(HasSubstr("camera 'cam1', frame 1"), HasSubstr("masks/cam1/0001.png"),
                                     HasSubstr("coloured, expected a grey picture")));
}

TEST_F(GuidedRuns, WrongFoldersAreBadInput) {
  const auto refused = [&](const Words& options, const std::string& reason) {
    const Outcome run = Run("out", options);
    EXPECT_EQ(run.exit_code, 2) << run.output;
    EXPECT_THAT(run.output, HasSubstr(reason));
    EXPECT_FALSE(fs::exists(folder_.path() / "out"));
  };
  refused({"--prior", folder_ / "nothing"}, "is no folder");
  refused({"--prior", folder_ / "scene"}, "neither depth.json (an output folder) nor prior.json");
  refused({"--mask", folder_ / "nothing"}, "is no folder");
  refused({"--mask", "sequence"}, "no camera has 'masks'");
  refused({"--prior", ExactPrior(), "--refine", "0"}, "prior needs refined depth");
}

TEST_F(GuidedRuns, ABrokenPriorFailsTheJobWithItsName) {
  const std::string prior = ExactPrior();
  std::ofstream(fs::path(prior) / "depth" / "cam2" / "0001.pfm") << "Pf\n4 4\n-1\nshort";
  const Outcome run = Run("out", {"--prior", prior});
  EXPECT_EQ(run.exit_code, 2) << run.output;
  EXPECT_THAT(run.output, AllOf(HasSubstr("camera 'cam2', frame 1"), HasSubstr("depth/cam2/0001.pfm")));
}

}  // namespace
}  // namespace depthfarm::system_test
