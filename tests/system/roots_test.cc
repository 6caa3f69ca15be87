// Workers that open files of jobs below some folders only.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/landlock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <csignal>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

// A scene and its depth, as a worker without bounds makes it. Jobs may read below in/ and write below out/.
class Roots : public testing::Test {
 protected:
  void SetUp() override {
    if (syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) < 2)
      GTEST_SKIP() << "this kernel has no Landlock";
    sequence_ = RenderScene(folder_.path() / "in/scene");
    fs::create_directories(folder_ / "out");
    const Outcome run = Depthfarm(Words{"run", sequence_, "-o", folder_ / "expected", "--workers", "2"} + SmallJob());
    ASSERT_EQ(run.exit_code, 0) << run.output;
    expected_ = DepthOf(folder_ / "expected");
  }
  [[nodiscard]] Words RootOptions() const { return {"--read-root", folder_ / "in", "--write-root", folder_ / "out"}; }
  [[nodiscard]] std::string Allowed() const {
    return "(--read-root " + (folder_ / "in") + ", --write-root " + (folder_ / "out") + ")";
  }
  [[nodiscard]] static Outcome Submit(const Farm& farm, const std::string& sequence, const std::string& output) {
    return Depthfarm(Words{"submit", sequence, "-o", output, "--wait", "--allow-outside"} + SmallJob() +
                     farm.Options());
  }
  // Views between cameras 0 and 1, from the depth of out/next.
  [[nodiscard]] Outcome Synthesize(const Farm& farm, const std::string& sequence, const std::string& output) const {
    const Outcome submitted = Depthfarm(Words{"synthesize", sequence, folder_ / "out/next", "-o", output, "--path",
                                              "cam0,cam1", "--steps", "4", "--submit"} +
                                        farm.Options());
    EXPECT_EQ(submitted.exit_code, 0) << submitted.output;
    return Depthfarm(Words{"watch", std::to_string(std::stoull("0" + submitted.output))} + farm.Options());
  }
  void ExpectTheNextJobRight(const Farm& farm) const {
    const Outcome done = Submit(farm, sequence_, folder_ / "out/next");
    ASSERT_EQ(done.exit_code, 0) << done.output << farm.Logs();
    EXPECT_THAT(Differences(DepthOf(folder_ / "out/next"), expected_), IsEmpty());
  }

  TemporaryFolder folder_;
  std::string sequence_;
  std::map<std::string, std::string> expected_;
};

TEST_F(Roots, AJobBelowThemIsDoneAsEver) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  for (int i = 0; i < 2; ++i) farm.AddWorker(RootOptions());  // they fetch from each other, too
  ExpectTheNextJobRight(farm);
  const Outcome rendered = Synthesize(farm, sequence_, folder_ / "out/views");
  EXPECT_EQ(rendered.exit_code, 0) << rendered.output << farm.Logs();
  EXPECT_TRUE(fs::exists(folder_ / "out/views/views/0003.png"));
}

TEST_F(Roots, WhatAJobNamesElsewhereIsNeitherReadNorWritten) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker(RootOptions());

  fs::copy(folder_ / "in/scene", folder_ / "elsewhere", fs::copy_options::recursive);
  const Outcome read = Submit(farm, folder_ / "elsewhere/sequence.json", folder_ / "out/a");
  EXPECT_EQ(read.exit_code, 2) << read.output;
  EXPECT_THAT(read.output, AllOf(HasSubstr("camera 'cam"), HasSubstr(folder_ / "elsewhere/"),
                                 HasSubstr("is outside of what jobs may read on this worker " + Allowed())));
  EXPECT_FALSE(fs::exists(folder_ / "out/a/depth.json"));

  const Outcome written = Submit(farm, sequence_, folder_ / "in/results");
  EXPECT_EQ(written.exit_code, 2) << written.output;
  EXPECT_THAT(written.output,
              HasSubstr((folder_ / "in/results") + ": is outside of what jobs may write on this worker " + Allowed()));
  EXPECT_FALSE(fs::exists(folder_ / "in/results"));
  ExpectTheNextJobRight(farm);
}

TEST_F(Roots, LinksDoNotLeadOut) {
  Farm farm;
  ASSERT_TRUE(farm.ok()) << farm.problem();
  farm.AddWorker(RootOptions());
  ExpectTheNextJobRight(farm);

  fs::copy(folder_ / "in/scene", folder_ / "in/linked", fs::copy_options::recursive);
  const fs::path picture = folder_ / "in/linked/cam1/0000.png";
  fs::rename(picture, folder_ / "secret.png");
  fs::create_symlink(folder_ / "secret.png", picture);
  const Outcome read = Submit(farm, folder_ / "in/linked/sequence.json", folder_ / "out/b");
  EXPECT_EQ(read.exit_code, 2) << read.output;
  EXPECT_THAT(read.output,
              AllOf(HasSubstr("camera 'cam1'"), HasSubstr(picture.string() + ": leads to " + (folder_ / "secret.png") +
                                                          ", which is outside of what jobs may read")));
  // The same of the pictures of virtual views, which the worker finds by itself.
  const Outcome rendered = Synthesize(farm, folder_ / "in/linked/sequence.json", folder_ / "out/c");
  EXPECT_EQ(rendered.exit_code, 2) << rendered.output;
  EXPECT_THAT(rendered.output, HasSubstr("leads to " + (folder_ / "secret.png")));

  fs::create_directories(folder_ / "victim");
  fs::create_directory_symlink(folder_ / "victim", folder_ / "out/link");
  const Outcome written = Submit(farm, sequence_, folder_ / "out/link/results");
  EXPECT_EQ(written.exit_code, 2) << written.output;
  EXPECT_THAT(written.output, HasSubstr((folder_ / "out/link/results") + ": leads to " + (folder_ / "victim/results")));
  EXPECT_TRUE(fs::is_empty(folder_ / "victim"));
  ExpectTheNextJobRight(farm);
}

TEST_F(Roots, KeysAreStillReadAgain) {
  const std::string keys = folder_ / "keys";
  ASSERT_EQ(Depthfarm({"keygen", "-o", keys}).exit_code, 0);
  Farm farm("tcp://127.0.0.1:*", keys);
  ASSERT_TRUE(farm.ok()) << farm.problem();
  const int worker = farm.AddWorker(RootOptions());
  ExpectTheNextJobRight(farm);
  farm.worker(worker).Signal(SIGHUP);
  EXPECT_TRUE(WaitUntil([&] { return farm.LogOf(worker).find("keys_reread") != std::string::npos; })) << farm.Logs();
}

TEST_F(Roots, WrongOnesAreErrorsAtTheStart) {
  const auto start = [&](const Words& options) {
    return RunProgram("depthfarm-worker",
                      Words{"--coordinator", "ipc://" + (folder_ / "none"), "--give-up-seconds", "0.1"} + options);
  };
  const Outcome no_cache = start({"--read-root", folder_ / "in"});
  EXPECT_EQ(no_cache.exit_code, 2) << no_cache.output;
  EXPECT_THAT(no_cache.output, HasSubstr("--cache-dir"));
  const Outcome missing = start({"--read-root", folder_ / "none", "--cache-dir", folder_ / "cache"});
  EXPECT_EQ(missing.exit_code, 2) << missing.output;
  EXPECT_THAT(missing.output, HasSubstr("--read-root '" + (folder_ / "none") + "': No such file or directory"));
}

}  // namespace
}  // namespace depthfarm::system_test
