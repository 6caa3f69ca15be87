// The same job gives the same bytes, whatever farm it runs on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/system/support.h"

namespace depthfarm::system_test {
namespace {

using testing::IsEmpty;
using testing::SizeIs;

class Determinism : public testing::Test {
 protected:
  void SetUp() override { sequence_ = RenderScene(folder_.path() / "scene"); }

  // Runs the scene on `workers` workers and returns its depth.
  std::map<std::string, std::string> Run(int workers, const Words& options, const Words& job = SmallJob()) {
    const std::string output = folder_ / ("out-" + std::to_string(++runs_));
    const Outcome run =
        Depthfarm(Words{"run", sequence_, "-o", output, "--workers", std::to_string(workers)} + job + options);
    EXPECT_EQ(run.exit_code, 0) << run.output;
    EXPECT_THAT(Leftovers(output), IsEmpty());
    return DepthOf(output);
  }

  TemporaryFolder folder_;
  std::string sequence_;
  int runs_ = 0;
};

TEST_F(Determinism, DepthOfFramesDiffersFromEachOther) {  // guards the others: constant output would pass them
  const auto depth = Run(2, {});
  ASSERT_TRUE(depth.contains("depth.json"));
  std::set<std::string> distinct;
  for (const auto& [name, content] : depth) distinct.insert(content);
  EXPECT_EQ(distinct.size(), depth.size());
}

struct Split {
  int blocks;
  const char* partition;
};
class DeterminismOfSplit : public Determinism, public testing::WithParamInterface<Split> {};

TEST_P(DeterminismOfSplit, OneToFourWorkersGiveTheSameBytes) {
  const Words options = {"--level-blocks", std::to_string(GetParam().blocks), "--partition", GetParam().partition};
  const auto one = Run(1, options);
  EXPECT_THAT(one, SizeIs(3 * 4 + 1)) << "3 cameras x 4 frames and depth.json";
  for (const int workers : {2, 3, 4}) EXPECT_THAT(Differences(one, Run(workers, options)), IsEmpty()) << workers;
}

INSTANTIATE_TEST_SUITE_P(All, DeterminismOfSplit,
                         testing::Values(Split{1, "interleaved"}, Split{2, "interleaved"}, Split{3, "interleaved"},
                                         Split{4, "interleaved"}, Split{5, "interleaved"}, Split{6, "interleaved"},
                                         Split{8, "interleaved"}, Split{1, "blocks"}, Split{2, "blocks"},
                                         Split{3, "blocks"}, Split{4, "blocks"}, Split{5, "blocks"}, Split{6, "blocks"},
                                         Split{8, "blocks"}),
                         [](const testing::TestParamInfo<Split>& split) {
                           return std::string(split.param.partition) + std::to_string(split.param.blocks);
                         });

TEST_F(Determinism, LevelsAloneAreTheSameBytesTooAndOthersThanRefinedDepth) {
  const auto levels = Run(1, {"--refine", "0"});
  EXPECT_THAT(Differences(levels, Run(3, {"--refine", "0"})), IsEmpty());
  EXPECT_THAT(Differences(levels, Run(2, {"--refine", "1"})), SizeIs(3 * 4 + 1));
}

TEST_F(Determinism, ConfidenceIsTheSameBytesTooAndChangesNoDepth) {
  auto one = Run(1, {"--confidence", "on"});
  EXPECT_THAT(one, SizeIs(2 * 3 * 4 + 1)) << "depth and confidence of 3 cameras x 4 frames, depth.json";
  EXPECT_THAT(Differences(one, Run(3, {"--confidence", "on"})), IsEmpty());
  auto plain = Run(2, {});
  std::erase_if(one, [](const auto& file) { return file.first.starts_with("confidence"); });
  one.erase("depth.json");
  plain.erase("depth.json");
  EXPECT_THAT(Differences(one, plain), IsEmpty());
}

TEST_F(Determinism, ASharedAnchorIsTheSameBytesTooAndRefersToTheFirstFrame) {
  const Words job = {"--segments", "600", "--levels", "24"};
  const Words every_frame = {"--gop", "1", "--anchor", "shared"};
  const auto one = Run(1, every_frame, job);
  EXPECT_THAT(Differences(one, Run(4, every_frame, job)), IsEmpty());
  // The first two frames are those of one GOP, the third is another one: it does not know the second.
  const auto chain = Run(2, {"--gop", "all"}, job);
  for (const auto& [name, content] : one) {
    if (name == "depth.json") continue;
    const bool same = name.ends_with("0000.png") || name.ends_with("0001.png");
    EXPECT_EQ(content == chain.at(name), same) << name;
  }
  const Words pairs = {"--anchor", "shared"};
  EXPECT_THAT(Differences(Run(2, pairs), Run(1, pairs)), IsEmpty());
}

TEST_F(Determinism, AnyNumberOfThreadsGivesTheSameBytes) {
  // 3 x 4500 nodes of an I frame: enough that a cut, too, is spread over three threads (level_search.cc).
  const Words job = {"--segments", "4500", "--levels", "24", "--gop", "2"};
  const auto one = Run(1, {"--threads", "1"}, job);
  EXPECT_THAT(Differences(one, Run(1, {"--threads", "3"}, job)), IsEmpty());
  EXPECT_THAT(Differences(one, Run(2, {"--threads", "2"}, job)), IsEmpty());
  EXPECT_THAT(Differences(one, Run(1, {"--slots", "2"}, job)), IsEmpty());
  EXPECT_THAT(Differences(one, Run(1, {"--slots", "2", "--threads", "5"}, job)), IsEmpty());
}

TEST_F(Determinism, OneBlockIsOneBlockInEitherPartition) {
  auto blocks = Run(2, {"--level-blocks", "1", "--partition", "blocks"});
  auto interleaved = Run(2, {"--level-blocks", "1", "--partition", "interleaved"});
  blocks.erase("depth.json");  // names the partition
  interleaved.erase("depth.json");
  EXPECT_THAT(Differences(blocks, interleaved), IsEmpty());
}

}  // namespace
}  // namespace depthfarm::system_test
