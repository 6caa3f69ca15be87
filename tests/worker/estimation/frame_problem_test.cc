#include "worker/estimation/frame_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "common/geometry/neighbours.h"
#include "tests/support/match_lists.h"
#include "tests/support/rendered_sequence.h"
#include "worker/cost/uniqueness.h"

namespace depthfarm {
namespace {

using test::RenderedSequence;
using testing::ElementsAreArray;

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

// The matches of every node on one level, [node][slot], one by one.
std::vector<MatchLink> OnLevel(const FrameProblem& frame, Level level) {
  return frame.MatchesOnOwnLevels(std::vector<Level>(frame.num_nodes(), level), NoneFixed(frame));
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
  std::vector<std::vector<MatchLink>> full;
  std::vector<std::vector<MatchLink>> unique;
  for (const Level level : AllLevels()) {
    full.push_back(OnLevel(plain, level));
    unique.push_back(OnLevel(frame, level));
  }
  const auto width = static_cast<std::size_t>(frame.matches_per_node());
  int rewarded = 0;
  int reduced = 0;
  for (int view = 0; view < job.num_views(); ++view) {
    const std::vector<int>& neighbours = job.views[static_cast<std::size_t>(view)].neighbours;
    for (NodeIndex node = frame.offset(view); node < frame.offset(view + 1); ++node) {
      for (std::size_t slot = 0; slot < neighbours.size(); ++slot) {
        const int floor = FloorPlainly(job, analysis, view, neighbours[slot], node - frame.offset(view));
        for (std::size_t level = 0; level < kLevels; ++level) {
          const MatchLink& in_full = full[level][node * width + slot];
          const MatchLink& match = unique[level][node * width + slot];
          EXPECT_EQ(match.target, in_full.target);
          EXPECT_EQ(match.reward, std::max(0, in_full.reward - floor));
          rewarded += match.reward != 0 ? 1 : 0;
          reduced += match.reward < in_full.reward ? 1 : 0;
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
  const MatchTable all = frame.MatchesOnLevels(AllLevels(), {});
  const auto width = static_cast<std::size_t>(frame.matches_per_node());
  for (const Level level : AllLevels()) {
    const MatchTable part = frame.MatchesOnLevels({level}, {});
    const std::vector<MatchLink> own = OnLevel(frame, level);
    for (NodeIndex node = 0; node < frame.num_nodes(); ++node) {
      std::vector<MatchTable::Match> expected;  // the vectors of MatchesOnLevels against one at a time
      for (std::size_t slot = 0; slot < width; ++slot) {
        const MatchLink& match = own[node * width + slot];
        if (match.reward != 0) expected.push_back({match.target, match.reward, level});
      }
      EXPECT_THAT(all.At(node, level), ElementsAreArray(expected));
      for (MatchTable::Match& match : expected) match.level = 0;
      EXPECT_THAT(test::MatchesOf(part, node), ElementsAreArray(expected));
    }
  }
}

TEST(FrameProblem, MatchesAreTheSameWithFloorsThatAnotherPartMeasured) {
  const ResolvedJob job = Job(75);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const auto floors = std::make_shared<RewardFloors>();
  (void)FrameProblem(job, analysis, floors).MatchesOnLevels({10, 40}, {});
  EXPECT_EQ(FrameProblem(job, analysis, floors).MatchesOnLevels(AllLevels(), {}),
            FrameProblem(job, analysis).MatchesOnLevels(AllLevels(), {}));
  // They are indeed used: other floors, other rewards.
  (*floors)[0] = 0;
  EXPECT_NE(FrameProblem(job, analysis, floors).MatchesOnLevels(AllLevels(), {}),
            FrameProblem(job, analysis).MatchesOnLevels(AllLevels(), {}));
}

TEST(FrameProblem, MatchesAreTheSameOnAnyNumberOfThreads) {
  const ResolvedJob job = Job(75);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const FrameProblem frame(job, analysis);
  const std::vector<std::uint8_t> fixed(frame.num_nodes(), 0);
  const std::vector<Level> labels(frame.num_nodes(), 0);
  const MatchTable one = frame.MatchesOnLevels(AllLevels(), {});
  for (const int threads : {2, 3, 5}) {
    EXPECT_EQ(FrameProblem(job, analysis).MatchesOnLevels(AllLevels(), fixed, labels, {}, threads), one) << threads;
  }
}

TEST(FrameProblem, MatchesBetweenFixedNodesAreLeftOut) {
  const ResolvedJob job = Job(75);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const FrameProblem frame(job, analysis);
  const std::vector<Level> labels(frame.num_nodes(), 30);
  std::vector<std::uint8_t> fixed = NoneFixed(frame);
  for (NodeIndex node = 0; node < frame.num_nodes(); node += 2) fixed[node] = 1;
  const std::vector<MatchLink> all = OnLevel(frame, 30);
  const std::vector<MatchLink> own = frame.MatchesOnOwnLevels(labels, fixed);
  const MatchTable table = frame.MatchesOnLevels({30}, fixed, labels, {});
  const auto width = static_cast<std::size_t>(frame.matches_per_node());
  int left_out = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool constant = fixed[i / width] != 0 && fixed[all[i].target] != 0;
    EXPECT_EQ(own[i].reward, constant ? 0 : all[i].reward);
    left_out += constant && all[i].reward != 0 ? 1 : 0;
  }
  EXPECT_GT(left_out, 0);
  for (NodeIndex node = 0; node < frame.num_nodes(); ++node) {
    std::vector<MatchTable::Match> expected;
    for (std::size_t slot = 0; slot < width; ++slot) {
      const MatchLink& match = own[node * width + slot];
      if (match.reward != 0) expected.push_back({match.target, match.reward, 0});
    }
    EXPECT_THAT(test::MatchesOf(table, node), ElementsAreArray(expected));
  }
}

TEST(FrameProblem, MatchesNearAreThoseOnLevelsWithinReach) {
  const ResolvedJob job = Job(75);
  const FrameAnalysis analysis = test::Analyse(Scene(), job, 0);
  const FrameProblem frame(job, analysis);
  const MatchTable all = frame.MatchesOnLevels(AllLevels(), {});
  std::vector<Level> labels;
  for (NodeIndex node = 0; node < frame.num_nodes(); ++node) labels.push_back(static_cast<Level>(node % kLevels));
  for (const std::size_t reach : {std::size_t{0}, std::size_t{3}, std::size_t{kLevels}}) {
    const MatchTable near = frame.MatchesNear(AllLevels(), reach, NoneFixed(frame), labels, {});
    for (NodeIndex node = 0; node < frame.num_nodes(); ++node) {
      std::vector<MatchTable::Match> expected;
      for (const MatchTable::Match& match : test::MatchesOf(all, node)) {
        const int apart = std::abs(int{match.level} - int{labels[node]});
        if (static_cast<std::size_t>(apart) <= reach) expected.push_back(match);
      }
      ASSERT_THAT(test::MatchesOf(near, node), ElementsAreArray(expected));
    }
  }
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
    return frame.MatchesOnLevels(AllLevels(), {}).size();
  };
  EXPECT_GT(rewards(0), 0U);
  EXPECT_EQ(rewards(1), 0U);
}

}  // namespace
}  // namespace depthfarm
