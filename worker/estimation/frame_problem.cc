#include "worker/estimation/frame_problem.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "common/base/parallel.h"
#include "common/geometry/neighbours.h"
#include "worker/cost/smoothness.h"
#include "worker/cost/uniqueness.h"
#include "worker/segmentation/seed_grid.h"

namespace depthfarm {
FrameProblem::FrameProblem(const ResolvedJob& job, const FrameAnalysis& analysis, std::shared_ptr<RewardFloors> floors)
    : job_(job),
      analysis_(analysis),
      offsets_{0},
      floors_(floors != nullptr ? std::move(floors) : std::make_shared<RewardFloors>()),
      offset_steps_(MatchOffsetSteps(job.params.matching_offset)) {
  const DepthLevels levels = job.Levels();
  const SmoothnessCost cost(job.params.smoothing, job.params.levels);
  for (std::size_t view_index = 0; view_index < job.views.size(); ++view_index) {
    const SegmentMap& segments = analysis[view_index]->segments;
    const NodeIndex offset = offsets_.back();
    for (const SegmentMap::Adjacency& pair : segments.adjacency) {
      const std::int32_t beta = cost.Beta(segments.means[pair.first], segments.means[pair.second]);
      if (beta != 0) smoothness_.push_back({offset + pair.first, offset + pair.second, beta});
    }
    offsets_.push_back(offset + static_cast<NodeIndex>(segments.num_segments()));

    std::vector<Pair> pairs;
    for (const int neighbour : job.views[view_index].neighbours) {
      const Camera& other = job.views[static_cast<std::size_t>(neighbour)].camera;
      const Camera& camera = job.views[view_index].camera;
      MatchGeometry geometry(camera, other, levels);
      MatchGeometry::Planes floor_planes =
          geometry.PlanesAt(FloorPlanes(levels, DisparityRange(camera, other, levels)));
      pairs.push_back({neighbour, std::move(geometry), std::move(floor_planes)});
    }
    matches_per_node_ = std::max(matches_per_node_, static_cast<int>(pairs.size()));
    pairs_.push_back(std::move(pairs));
  }
  floors_->Resize(num_nodes() * static_cast<std::size_t>(matches_per_node_));
}

std::vector<SegmentGrid> FrameProblem::Grids() const {
  const SmoothnessCost cost(job_.params.smoothing, job_.params.levels);
  std::vector<SegmentGrid> grids;
  for (int view_index = 0; view_index < job_.num_views(); ++view_index) {
    const auto v = static_cast<std::size_t>(view_index);
    const JobView& view = job_.views[v];
    const std::vector<MeanColor>& means = analysis_[v]->segments.means;
    const Result<SeedGrid> seeds = SeedGrid::Create(view.camera.width, view.camera.height, view.segments);
    SegmentGrid grid{.first = offset(view_index), .columns = 0, .rows = 1, .beta_right = {}, .beta_down = {}};
    grid.columns = static_cast<int>(means.size());
    if (seeds.ok() && static_cast<std::size_t>(seeds.value().num_segments()) == means.size()) {
      grid.columns = seeds.value().columns();
      grid.rows = seeds.value().rows();
    }
    const auto columns = static_cast<std::size_t>(grid.columns);
    for (std::size_t s = 0; s < means.size(); ++s) {
      grid.beta_right.push_back(s + 1 < means.size() ? cost.Beta(means[s], means[s + 1]) : 0);
      grid.beta_down.push_back(s + columns < means.size() ? cost.Beta(means[s], means[s + columns]) : 0);
    }
    grids.push_back(std::move(grid));
  }
  return grids;
}

FrameProblem::Matcher FrameProblem::MatcherOf(int view_index, int slot, NodeIndex segment) const {
  const auto v = static_cast<std::size_t>(view_index);
  const auto s = static_cast<std::size_t>(slot);
  const std::size_t node = offset(view_index) + segment;
  return {view_index, pairs_[v][s], analysis_[v]->segments.centers[segment],
          node * static_cast<std::size_t>(matches_per_node_) + s};
}

NodeIndex FrameProblem::NodeAt(const Pair& pair, PixelPosition target) const {
  const auto neighbour = static_cast<std::size_t>(pair.neighbour);
  return offset(pair.neighbour) + analysis_[neighbour]->segments.labels(target.x, target.y);
}

std::uint16_t FrameProblem::FullReward(const Matcher& matcher, PixelPosition target) const {
  const ViewAnalysis& view = *analysis_[static_cast<std::size_t>(matcher.view_index)];
  const ViewAnalysis& neighbour = *analysis_[static_cast<std::size_t>(matcher.pair.neighbour)];
  const WindowDifference difference =
      WindowColorDifference(view.picture, neighbour.picture, matcher.center, target, job_.params.matching_window);
  return MatchReward(difference, offset_steps_);
}

MatchLink FrameProblem::MatchAt(const Matcher& matcher, PixelPosition target) const {
  std::uint16_t reward = FullReward(matcher, target);
  if (reward != 0 && job_.params.uniqueness != 0) {
    reward = static_cast<std::uint16_t>(reward - std::min(reward, Floor(matcher)));
  }
  return {NodeAt(matcher.pair, target), reward};
}

std::uint16_t FrameProblem::Floor(const Matcher& matcher) const {
  std::uint16_t& floor = (*floors_)[matcher.index];
  if (floor == RewardFloors::kNotMeasured) floor = MeasureFloor(matcher);
  return floor;
}

std::uint16_t FrameProblem::MeasureFloor(const Matcher& matcher) const {
  std::array<PixelPosition, kFloorPlanes> targets;
  std::array<std::uint16_t, kFloorPlanes> rewards{};
  matcher.pair.geometry.Targets(matcher.center, matcher.pair.floor_planes, targets);
  const auto end = std::remove(targets.begin(), targets.end(), kNoTarget);
  const auto count = static_cast<std::size_t>(end - targets.begin());
  if (count == 0) return 0;
  RewardsAt(matcher, {targets.data(), count}, {rewards.data(), count});
  return RewardFloor({rewards.data(), count}, job_.params.uniqueness);
}

void FrameProblem::RewardsAt(const Matcher& matcher, std::span<const PixelPosition> targets,
                             std::span<std::uint16_t> rewards) const {
  MatchRewards(analysis_[static_cast<std::size_t>(matcher.view_index)]->picture,
               analysis_[static_cast<std::size_t>(matcher.pair.neighbour)]->picture, matcher.center, targets,
               job_.params.matching_window, offset_steps_, rewards);
}

int FrameProblem::ViewOf(NodeIndex node) const {
  return static_cast<int>(std::upper_bound(offsets_.begin(), offsets_.end(), node) - offsets_.begin()) - 1;
}

// Fills a table node by node; keeps what the nodes share.
class FrameProblem::TableFiller {
 public:
  TableFiller(const FrameProblem& frame, const std::vector<Level>& levels, const std::vector<std::uint8_t>& fixed,
              const std::vector<Level>& labels)
      : frame_(frame), levels_(levels), fixed_(fixed), labels_(labels) {
    for (const std::vector<Pair>& pairs : frame.pairs_) {
      std::vector<MatchGeometry::Planes>& of_view = planes_.emplace_back();
      for (const Pair& pair : pairs) of_view.push_back(pair.geometry.PlanesOfLevels(levels));
    }
  }

  // The nodes [begin, end); of each free one the levels that are at most `reach` from its own.
  [[nodiscard]] MatchTable Fill(NodeIndex begin, NodeIndex end, std::size_t reach) const {
    MatchTableBuilder table(frame_.matches_per_node_);
    Row row(levels_.size(), static_cast<std::size_t>(frame_.matches_per_node_));
    for (NodeIndex node = begin; node < end; ++node) {
      if (fixed_[node] != 0) {
        AddFixed(node, table);
      } else {
        AddFree(node, Around(node, reach), row, table);
      }
      table.EndNode();
    }
    return std::move(table).Take();
  }

 private:
  struct Row {  // [slot][level]
    Row(std::size_t levels, std::size_t slots) : targets(levels * slots), rewards(levels * slots) {}
    std::vector<PixelPosition> targets;
    std::vector<std::uint16_t> rewards;
  };

  [[nodiscard]] int SlotsOf(int view_index) const {
    return static_cast<int>(frame_.pairs_[static_cast<std::size_t>(view_index)].size());
  }

  void AddFixed(NodeIndex node, MatchTableBuilder& table) const {
    const auto level = std::lower_bound(levels_.begin(), levels_.end(), labels_[node]);
    if (level == levels_.end() || *level != labels_[node]) return;
    const int view_index = frame_.ViewOf(node);
    for (int slot = 0; slot < SlotsOf(view_index); ++slot) {
      const Matcher matcher = frame_.MatcherOf(view_index, slot, node - frame_.offset(view_index));
      const std::optional<PixelPosition> target = matcher.pair.geometry.Target(matcher.center, *level);
      if (!target || fixed_[frame_.NodeAt(matcher.pair, *target)] != 0) continue;
      const MatchLink match = frame_.MatchAt(matcher, *target);
      table.Add(static_cast<std::size_t>(level - levels_.begin()), match.target, match.reward);
    }
  }

  struct Range {  // of levels, by their index
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  [[nodiscard]] Range Around(NodeIndex node, std::size_t reach) const {
    if (reach >= levels_.size()) return {0, levels_.size()};
    const auto found = std::lower_bound(levels_.begin(), levels_.end(), labels_[node]);
    const auto own = static_cast<std::size_t>(found - levels_.begin());
    return {own - std::min(own, reach), std::min(own + reach + 1, levels_.size())};
  }

  void AddFree(NodeIndex node, const Range& range, Row& row, MatchTableBuilder& table) const {
    const int view_index = frame_.ViewOf(node);
    const int slots = SlotsOf(view_index);
    const std::size_t width = range.end - range.begin;
    for (int slot = 0; slot < slots; ++slot) {
      const auto s = static_cast<std::size_t>(slot);
      const Matcher matcher = frame_.MatcherOf(view_index, slot, node - frame_.offset(view_index));
      const std::span<PixelPosition> targets(row.targets.data() + s * width, width);
      const std::span<std::uint16_t> rewards(row.rewards.data() + s * width, width);
      const std::span<const double> planes = planes_[static_cast<std::size_t>(view_index)][s];
      matcher.pair.geometry.Targets(matcher.center, planes.subspan(range.begin, width), targets);
      frame_.RewardsAt(matcher, targets, rewards);
      if (frame_.job_.params.uniqueness == 0 || std::all_of(rewards.begin(), rewards.end(), IsZero)) continue;
      const std::uint16_t floor = frame_.Floor(matcher);
      for (std::uint16_t& reward : rewards) reward = static_cast<std::uint16_t>(reward - std::min(reward, floor));
    }
    for (std::size_t level = range.begin; level < range.end; ++level) {
      for (int slot = 0; slot < slots; ++slot) {
        const std::size_t i = static_cast<std::size_t>(slot) * width + level - range.begin;
        if (row.rewards[i] == 0) continue;
        const Pair& pair = frame_.pairs_[static_cast<std::size_t>(view_index)][static_cast<std::size_t>(slot)];
        table.Add(level, frame_.NodeAt(pair, row.targets[i]), row.rewards[i]);
      }
    }
  }

  static bool IsZero(std::uint16_t reward) { return reward == 0; }

  const FrameProblem& frame_;
  const std::vector<Level>& levels_;
  const std::vector<std::uint8_t>& fixed_;
  const std::vector<Level>& labels_;
  std::vector<std::vector<MatchGeometry::Planes>> planes_;  // [view][slot]
};

MatchTable FrameProblem::MatchesOnLevels(const std::vector<Level>& levels, const std::stop_token& stop) const {
  return MatchesOnLevels(levels, std::vector<std::uint8_t>(num_nodes(), 0), std::vector<Level>(num_nodes()), stop);
}

MatchTable FrameProblem::MatchesOnLevels(const std::vector<Level>& levels, const std::vector<std::uint8_t>& fixed,
                                         const std::vector<Level>& labels, const std::stop_token& stop,
                                         int threads) const {
  return MatchesNear(levels, levels.size(), fixed, labels, stop, threads);
}

MatchTable FrameProblem::MatchesNear(const std::vector<Level>& levels, std::size_t reach,
                                     const std::vector<std::uint8_t>& fixed, const std::vector<Level>& labels,
                                     const std::stop_token& stop, int threads) const {
  const TableFiller filler(*this, levels, fixed, labels);
  std::vector<MatchTable> parts((num_nodes() + MatchTable::kChunkNodes - 1) / MatchTable::kChunkNodes);
  ParallelFor(parts.size(), threads, [&](std::size_t i) {
    if (stop.stop_requested()) return;
    const NodeIndex begin = static_cast<NodeIndex>(i) * MatchTable::kChunkNodes;
    parts[i] = filler.Fill(begin, std::min(begin + MatchTable::kChunkNodes, num_nodes()), reach);
  });
  MatchTable matches;
  if (stop.stop_requested()) return matches;
  for (MatchTable& part : parts) matches.Append(std::move(part));
  return matches;
}

std::vector<MatchLink> FrameProblem::MatchesOnOwnLevels(const std::vector<Level>& labels,
                                                        const std::vector<std::uint8_t>& fixed) const {
  const auto width = static_cast<std::size_t>(matches_per_node_);
  std::vector<MatchLink> matches(num_nodes() * width);
  for (int view_index = 0; view_index < job_.num_views(); ++view_index) {
    const NodeIndex segments = offset(view_index + 1) - offset(view_index);
    const int slots = static_cast<int>(pairs_[static_cast<std::size_t>(view_index)].size());
    for (NodeIndex segment = 0; segment < segments; ++segment) {
      const NodeIndex node = offset(view_index) + segment;
      for (int slot = 0; slot < slots; ++slot) {
        const Matcher matcher = MatcherOf(view_index, slot, segment);
        const std::optional<PixelPosition> target = matcher.pair.geometry.Target(matcher.center, labels[node]);
        if (!target || (fixed[node] != 0 && fixed[NodeAt(matcher.pair, *target)] != 0)) continue;
        matches[matcher.index] = MatchAt(matcher, *target);
      }
    }
  }
  return matches;
}

std::vector<Level> FrameProblem::ToNodes(const LabelField& field) const {
  std::vector<Level> labels;
  labels.reserve(num_nodes());
  for (const ViewLabels& view : field.views) labels.insert(labels.end(), view.levels.begin(), view.levels.end());
  return labels;
}

LabelField FrameProblem::FromNodes(const std::vector<Level>& labels, const std::vector<std::uint8_t>& unchanged) const {
  LabelField field;
  for (int view_index = 0; view_index < job_.num_views(); ++view_index) {
    const auto begin = static_cast<std::ptrdiff_t>(offset(view_index));
    const auto end = static_cast<std::ptrdiff_t>(offset(view_index + 1));
    field.views.push_back(
        {{labels.begin() + begin, labels.begin() + end}, {unchanged.begin() + begin, unchanged.begin() + end}});
  }
  return field;
}

Status CheckAnalysis(const ResolvedJob& job, const FrameAnalysis& analysis) {
  if (analysis.size() != job.views.size()) {
    return InvalidArgument("there are " + std::to_string(analysis.size()) + " analyses for " +
                           std::to_string(job.views.size()) + " views");
  }
  for (std::size_t i = 0; i < analysis.size(); ++i) {
    const Camera& camera = job.views[i].camera;
    const Grid<SegmentIndex>& labels = analysis[i]->segments.labels;
    if (labels.width() != camera.width || labels.height() != camera.height ||
        analysis[i]->picture.width() != camera.width || analysis[i]->picture.height() != camera.height) {
      return InvalidArgument("the analysis of camera '" + camera.name + "' is " + std::to_string(labels.width()) + "x" +
                             std::to_string(labels.height()) + ", expected " + std::to_string(camera.width) + "x" +
                             std::to_string(camera.height));
    }
  }
  return {};
}

Status CheckLabels(const ResolvedJob& job, const FrameAnalysis& analysis, const LabelField& field) {
  if (field.views.size() != job.views.size()) {
    return InvalidArgument("a label field has " + std::to_string(field.views.size()) + " views, expected " +
                           std::to_string(job.views.size()));
  }
  for (std::size_t i = 0; i < field.views.size(); ++i) {
    const auto segments = static_cast<std::size_t>(analysis[i]->segments.num_segments());
    const ViewLabels& view = field.views[i];
    const std::string camera = "the labels of camera '" + job.views[i].camera.name + "'";
    if (view.levels.size() != segments || view.unchanged.size() != segments) {
      return InvalidArgument(camera + " are " + std::to_string(view.levels.size()) + ", its segments " +
                             std::to_string(segments));
    }
    const auto beyond =
        std::find_if(view.levels.begin(), view.levels.end(), [&](Level level) { return level >= job.params.levels; });
    if (beyond != view.levels.end()) {
      return InvalidArgument(camera + " contain level " + std::to_string(*beyond) + " of " +
                             std::to_string(job.params.levels));
    }
  }
  return {};
}

}  // namespace depthfarm
