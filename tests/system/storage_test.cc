// Farms whose machines do not all see the same folders.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
    const std::string rendered = RenderScene(folder_.path() / "here");
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

TEST(PathMapOption, RefusesWhatIsNoMap) {
  const Outcome outcome = RunProgram("depthfarm-worker", {"--coordinator", "ipc:///tmp/x", "--path-map", "/a/..=/b"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.output, HasSubstr("is not an absolute path without '..'"));
}

}  // namespace
}  // namespace depthfarm::system_test
