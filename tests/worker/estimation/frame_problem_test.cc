#include "worker/estimation/frame_problem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/geometry/neighbours.h"
#include "tests/support/rendered_sequence.h"
#include "worker/cost/uniqueness.h"

namespace depthfarm {
namespace {

using test::RenderedSequence;

constexpr int kLevels = 80;  // more than the planes that floors are measured on

const RenderedSequence& Scene() {
  static const RenderedSequence rendered = test::Render(ArrayKind::kArc, 3, 96, 72, 1, 11, 1.5);
  return rendered;
}

ResolvedJob Job(int uniqueness) {
  EstimationParams params;
  params.segments = 200;
  params.levels = kLevels;
  params.uniqueness = uniqueness;
  return ResolveJob(Scene().sequence, params).value();
}

std::vector<Level> AllLevels() {
  std::vector<Level> levels;
  for (int level = 0; level < kLevels; ++level) levels.push_back(static_cast<Level>(level));
  return levels;
}

std::vector<std::uint8_t> NoneFixed(const FrameProblem& frame) {
  return std::vector<std::uint8_t>(frame.num_nodes(), 0);
}

std::vector<std::uint16_t> Rewards(const std::vector<MatchLink>& matches) {
  std::vector<std::uint16_t> rewards;
  for (const MatchLink& match : matches) rewards.push_back(match.reward);
  return rewards;
}

// The floor of a segment against one neighbour, put together from its parts.
int FloorPlainly(const ResolvedJob& job, const FrameAnalysis& analysis, int view_index, int neighbour,
                 NodeIndex segment) {
  const DepthLevels levels = job.Levels();
  const Camera& camera = job.views[static_cast<std::size_t>(view_index)].camera;
  const Camera& other = job.views[static_cast<std::size_t>(neighbour)].camera;
  const ViewAnalysis& own = *analysis[static_cast<std::size_t>(view_index)];
  const MatchGeometry geometry(camera, other, levels);
  const PixelPosition center = own.segments.centers[segment];
  std::vector<int> rewards;
  for (const double plane : FloorPlanes(levels, DisparityRange(camera, other, levels))) {
    const std::optional<PixelPosition> target = geometry.TargetOnPlane(center, plane);
    if (!target) continue;
    const WindowDifference difference =
        WindowColorDifference(own.picture, analysis[static_cast<std::size_t>(neighbour)]->picture, center, *target,
                              job.params.matching_window);
    rewards.push_back(MatchReward(difference, MatchOffsetSteps(job.params.matching_offset)));
  }
  if (rewards.empty()) return 0;
  std::sort(rewards.begin(), rewards.end());
  return rewards[(rewards.size() - 1) * static_cast<std::size_t>(job.params.uniqueness) / 100];
}

TEST(FrameProblem, AMatchCountsByHowMuchItBeatsItsFloor) {
  const ResolvedJob plain_job = Job(0);
  const ResolvedJob job = Job(60);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const FrameProblem plain(plain_job, analysis);
  const FrameProblem frame(job, analysis);
  const std::vector<MatchLink> full = plain.MatchesOnLevels(AllLevels(), {});
  const std::vector<MatchLink> unique = frame.MatchesOnLevels(AllLevels(), {});
  ASSERT_EQ(full.size(), unique.size());
  const auto width = static_cast<std::size_t>(frame.matches_per_node());
  int rewarded = 0;
  int reduced = 0;
  for (int view = 0; view < job.num_views(); ++view) {
    const std::vector<int>& neighbours = job.views[static_cast<std::size_t>(view)].neighbours;
    for (NodeIndex node = frame.offset(view); node < frame.offset(view + 1); ++node) {
      for (std::size_t slot = 0; slot < neighbours.size(); ++slot) {
        const int floor = FloorPlainly(job, analysis, view, neighbours[slot], node - frame.offset(view));
        for (std::size_t level = 0; level < kLevels; ++level) {
          const std::size_t i = (level * frame.num_nodes() + node) * width + slot;
          EXPECT_EQ(unique[i].target, full[i].target);
          EXPECT_EQ(unique[i].reward, std::max(0, full[i].reward - floor));
          rewarded += unique[i].reward != 0 ? 1 : 0;
          reduced += unique[i].reward < full[i].reward ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(rewarded, 0);
  EXPECT_GT(reduced, 0);
}

TEST(FrameProblem, MatchesAreTheSameWhateverLevelsAPartHas) {
  const ResolvedJob job = Job(75);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const FrameProblem frame(job, analysis);
  const std::vector<MatchLink> all = frame.MatchesOnLevels(AllLevels(), {});
  const std::size_t row = all.size() / kLevels;
  for (const Level level : {Level{0}, Level{33}, Level{79}}) {
    const std::vector<MatchLink> part = frame.MatchesOnLevels({level}, {});
    const std::vector<MatchLink> own =
        frame.MatchesOnOwnLevels(std::vector<Level>(frame.num_nodes(), level), NoneFixed(frame));
    for (std::size_t i = 0; i < row; ++i) {
      const MatchLink& expected = all[level * row + i];
      EXPECT_EQ(part[i].reward, expected.reward);
      EXPECT_EQ(part[i].target, expected.target);
      EXPECT_EQ(own[i].reward, expected.reward);
      EXPECT_EQ(own[i].target, expected.target);
    }
  }
}

TEST(FrameProblem, MatchesAreTheSameWithFloorsThatAnotherPartMeasured) {
  const ResolvedJob job = Job(75);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const auto floors = std::make_shared<RewardFloors>();
  (void)FrameProblem(job, analysis, floors).MatchesOnLevels({10, 40}, {});
  EXPECT_EQ(Rewards(FrameProblem(job, analysis, floors).MatchesOnLevels(AllLevels(), {})),
            Rewards(FrameProblem(job, analysis).MatchesOnLevels(AllLevels(), {})));
  // They are indeed used: other floors, other rewards.
  (*floors)[0] = 0;
  EXPECT_NE(Rewards(FrameProblem(job, analysis, floors).MatchesOnLevels(AllLevels(), {})),
            Rewards(FrameProblem(job, analysis).MatchesOnLevels(AllLevels(), {})));
}

TEST(FrameProblem, MatchesBetweenFixedNodesAreLeftOut) {
  const ResolvedJob job = Job(75);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const FrameProblem frame(job, analysis);
  const std::vector<Level> labels(frame.num_nodes(), 30);
  std::vector<std::uint8_t> fixed = NoneFixed(frame);
  for (NodeIndex node = 0; node < frame.num_nodes(); node += 2) fixed[node] = 1;
  const std::vector<MatchLink> all = frame.MatchesOnOwnLevels(labels, NoneFixed(frame));
  const std::vector<MatchLink> own = frame.MatchesOnOwnLevels(labels, fixed);
  const std::vector<MatchLink> tile = frame.MatchesOnLevels({30}, fixed, labels, {});
  const auto width = static_cast<std::size_t>(frame.matches_per_node());
  int left_out = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool constant = fixed[i / width] != 0 && fixed[all[i].target] != 0;
    EXPECT_EQ(own[i].reward, constant ? 0 : all[i].reward);
    EXPECT_EQ(tile[i].reward, own[i].reward);
    left_out += constant && all[i].reward != 0 ? 1 : 0;
  }
  EXPECT_GT(left_out, 0);
}

// What the floor is for: a surface without texture matches everywhere, which is no reason to believe any depth.
TEST(FrameProblem, ASurfaceWithoutTextureIsNotRewarded) {
  const auto rewards = [](int uniqueness) {
    const ResolvedJob job = Job(uniqueness);
    FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
    for (std::shared_ptr<const ViewAnalysis>& view : analysis) {
      auto plain = std::make_shared<ViewAnalysis>(*view);
      for (int y = 0; y < plain->picture.height(); ++y) {
        std::fill_n(plain->picture.row(y), plain->picture.width(), Ycbcr{90, 120, 130});
      }
      view = plain;
    }
    const FrameProblem frame(job, analysis);
    std::int64_t sum = 0;
    for (const MatchLink& match : frame.MatchesOnLevels(AllLevels(), {})) sum += match.reward;
    return sum;
  };
  EXPECT_GT(rewards(0), 0);
  EXPECT_EQ(rewards(1), 0);
}

}  // namespace
}  // namespace depthfarm
