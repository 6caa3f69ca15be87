#ifndef DEPTHFARM_WORKER_ESTIMATION_FRAME_PROBLEM_H_
#define DEPTHFARM_WORKER_ESTIMATION_FRAME_PROBLEM_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <vector>

#include "worker/cost/matching.h"
#include "worker/estimation/estimation.h"
#include "worker/estimation/reward_floors.h"
#include "worker/merging/fusion.h"
#include "worker/optimization/belief_start.h"
#include "worker/optimization/labelling_problem.h"

namespace depthfarm {

// Turns the analyses of one frame into the numbers of eq. (1): one node numbering over all views, V links within views,
// M links between them.
class FrameProblem {
 public:
  // `job` and `analysis` must outlive this. Sizes must have been checked (CheckAnalysis). `floors`: those of the same
  // job and analyses, measured here as they are needed; null: measured for this object alone.
  FrameProblem(const ResolvedJob& job, const FrameAnalysis& analysis, std::shared_ptr<RewardFloors> floors = nullptr);

  [[nodiscard]] NodeIndex num_nodes() const { return offsets_.back(); }
  // First node of a view; view num_views: the end.
  [[nodiscard]] NodeIndex offset(int view_index) const { return offsets_[static_cast<std::size_t>(view_index)]; }
  // Of each view.
  [[nodiscard]] std::vector<NodeIndex> FirstNodes() const { return {offsets_.begin(), offsets_.end() - 1}; }
  [[nodiscard]] const std::vector<SmoothnessLink>& smoothness() const { return smoothness_; }
  [[nodiscard]] int matches_per_node() const { return matches_per_node_; }
  // Each view's segments as the grid of their seeds; as one row where there are not as many as the job's seeds, so that
  // only the start of the search suffers.
  [[nodiscard]] std::vector<SegmentGrid> Grids() const;

  // The matches of every node on every level of `levels`; of a node that is fixed (per node: not 0) only those with
  // free nodes on the level it holds: the others it never takes, or they are constants. Work: levels x free nodes x D
  // windows, less those of levels that fall on the same pixel as the one before. Not whole when cancelled.
  [[nodiscard]] MatchTable MatchesOnLevels(const std::vector<Level>& levels, const std::vector<std::uint8_t>& fixed,
                                           const std::vector<Level>& labels, const std::stop_token& stop,
                                           int threads = 1) const;
  // The same, but of each free node only on levels that are at most `reach`, by their index, from the one in `labels`.
  [[nodiscard]] MatchTable MatchesNear(const std::vector<Level>& levels, std::size_t reach,
                                       const std::vector<std::uint8_t>& fixed, const std::vector<Level>& labels,
                                       const std::stop_token& stop, int threads = 1) const;
  // MatchesOnLevels with nothing fixed.
  [[nodiscard]] MatchTable MatchesOnLevels(const std::vector<Level>& levels, const std::stop_token& stop) const;

  // The matches of every node on the level it holds ([node][slot]), less those between fixed ones.
  [[nodiscard]] std::vector<MatchLink> MatchesOnOwnLevels(const std::vector<Level>& labels,
                                                          const std::vector<std::uint8_t>& fixed) const;

  // Label fields by view <-> labels by node.
  [[nodiscard]] std::vector<Level> ToNodes(const LabelField& field) const;
  [[nodiscard]] LabelField FromNodes(const std::vector<Level>& labels,
                                     const std::vector<std::uint8_t>& unchanged) const;

 private:
  struct Pair {  // one view matched against one of its neighbours
    int neighbour = 0;
    MatchGeometry geometry;
    MatchGeometry::Planes floor_planes;  // where floors are measured
  };
  // One segment matched against one neighbour.
  struct Matcher {
    int view_index = 0;
    const Pair& pair;
    PixelPosition center;
    std::size_t index = 0;  // of its floor: node x D + slot
  };
  [[nodiscard]] Matcher MatcherOf(int view_index, int slot, NodeIndex segment) const;
  [[nodiscard]] NodeIndex NodeAt(const Pair& pair, PixelPosition target) const;
  [[nodiscard]] int ViewOf(NodeIndex node) const;
  // Against what the neighbour shows at `target`.
  [[nodiscard]] MatchLink MatchAt(const Matcher& matcher, PixelPosition target) const;
  [[nodiscard]] std::uint16_t FullReward(const Matcher& matcher, PixelPosition target) const;  // eq. (5)
  // Asked for only where there is a reward: many matches never are measured.
  [[nodiscard]] std::uint16_t Floor(const Matcher& matcher) const;
  [[nodiscard]] std::uint16_t MeasureFloor(const Matcher& matcher) const;
  // Against what the neighbour shows at many targets.
  void RewardsAt(const Matcher& matcher, std::span<const PixelPosition> targets,
                 std::span<std::uint16_t> rewards) const;
  class TableFiller;

  const ResolvedJob& job_;
  const FrameAnalysis& analysis_;
  std::vector<NodeIndex> offsets_;
  std::vector<std::vector<Pair>> pairs_;  // [view][slot]
  std::vector<SmoothnessLink> smoothness_;
  std::shared_ptr<RewardFloors> floors_;
  int matches_per_node_ = 0;
  std::int32_t offset_steps_ = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_ESTIMATION_FRAME_PROBLEM_H_
