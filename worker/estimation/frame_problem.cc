#include "worker/estimation/frame_problem.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "common/geometry/neighbours.h"
#include "worker/cost/smoothness.h"
#include "worker/cost/uniqueness.h"

namespace depthfarm {
namespace {

constexpr NodeIndex kTileNodes = 64;  // nodes x levels x 8 bytes of a tile stay in the cache while they are transposed

}  // namespace

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
      pairs.push_back({neighbour, MatchGeometry(camera, other, levels),
                       FloorPlanes(levels, DisparityRange(camera, other, levels))});
    }
    matches_per_node_ = std::max(matches_per_node_, static_cast<int>(pairs.size()));
    pairs_.push_back(std::move(pairs));
  }
  floors_->Resize(num_nodes() * static_cast<std::size_t>(matches_per_node_));
}

FrameProblem::Matcher FrameProblem::MatcherOf(int view_index, int slot, NodeIndex segment) const {
  const auto v = static_cast<std::size_t>(view_index);
  const auto s = static_cast<std::size_t>(slot);
  const std::size_t node = offset(view_index) + segment;
  return {view_index, pairs_[v][s], analysis_[v]->segments.centers[segment],
          node * static_cast<std::size_t>(matches_per_node_) + s};
}

NodeIndex FrameProblem::NodeAt(const Matcher& matcher, PixelPosition target) const {
  const auto neighbour = static_cast<std::size_t>(matcher.pair.neighbour);
  return offset(matcher.pair.neighbour) + analysis_[neighbour]->segments.labels(target.x, target.y);
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
  return {NodeAt(matcher, target), reward};
}

std::uint16_t FrameProblem::Floor(const Matcher& matcher) const {
  std::uint16_t& floor = (*floors_)[matcher.index];
  if (floor == RewardFloors::kNotMeasured) floor = MeasureFloor(matcher);
  return floor;
}

std::uint16_t FrameProblem::MeasureFloor(const Matcher& matcher) const {
  std::array<std::uint16_t, kFloorPlanes> rewards{};
  std::size_t count = 0;
  for (const double plane : matcher.pair.floor_planes) {
    const std::optional<PixelPosition> target = matcher.pair.geometry.TargetOnPlane(matcher.center, plane);
    if (target) rewards[count++] = FullReward(matcher, *target);
  }
  return count == 0 ? std::uint16_t{0} : RewardFloor({rewards.data(), count}, job_.params.uniqueness);
}

// tile: [level index][node - begin]
void FrameProblem::FillTile(int view_index, int slot, NodeIndex begin, NodeIndex end, const Choices& choices,
                            std::vector<MatchLink>& tile) const {
  const std::vector<Level>& levels = choices.levels;
  for (NodeIndex segment = begin; segment < end; ++segment) {
    const Matcher matcher = MatcherOf(view_index, slot, segment);
    const MatchGeometry& geometry = matcher.pair.geometry;
    const NodeIndex node = offset(view_index) + segment;
    if (choices.fixed[node] != 0) {
      for (std::size_t level_index = 0; level_index < levels.size(); ++level_index) {
        MatchLink& match = tile[level_index * kTileNodes + (segment - begin)];
        match = {};
        if (levels[level_index] != choices.labels[node]) continue;
        const std::optional<PixelPosition> target = geometry.Target(matcher.center, levels[level_index]);
        if (target && choices.fixed[NodeAt(matcher, *target)] == 0) match = MatchAt(matcher, *target);
      }
      continue;
    }
    std::optional<PixelPosition> last;
    MatchLink match;
    for (std::size_t level_index = 0; level_index < levels.size(); ++level_index) {
      const std::optional<PixelPosition> target = geometry.Target(matcher.center, levels[level_index]);
      if (!target) {
        match = {};
      } else if (target != last) {
        match = MatchAt(matcher, *target);
      }
      last = target;
      tile[level_index * kTileNodes + (segment - begin)] = match;
    }
  }
}

std::vector<MatchLink> FrameProblem::MatchesOnLevels(const std::vector<Level>& levels,
                                                     const std::stop_token& stop) const {
  return MatchesOnLevels(levels, std::vector<std::uint8_t>(num_nodes(), 0), std::vector<Level>(num_nodes()), stop);
}

std::vector<MatchLink> FrameProblem::MatchesOnLevels(const std::vector<Level>& levels,
                                                     const std::vector<std::uint8_t>& fixed,
                                                     const std::vector<Level>& labels,
                                                     const std::stop_token& stop) const {
  const auto width = static_cast<std::size_t>(matches_per_node_);
  std::vector<MatchLink> matches(levels.size() * num_nodes() * width);
  std::vector<MatchLink> tile(levels.size() * kTileNodes);
  for (int view_index = 0; view_index < job_.num_views(); ++view_index) {
    const NodeIndex segments = offset(view_index + 1) - offset(view_index);
    const int slots = static_cast<int>(pairs_[static_cast<std::size_t>(view_index)].size());
    for (int slot = 0; slot < slots; ++slot) {
      for (NodeIndex begin = 0; begin < segments; begin += kTileNodes) {
        if (stop.stop_requested()) return {};
        const NodeIndex end = std::min(begin + kTileNodes, segments);
        FillTile(view_index, slot, begin, end, {levels, fixed, labels}, tile);
        for (std::size_t level_index = 0; level_index < levels.size(); ++level_index) {
          MatchLink* row = matches.data() + (level_index * num_nodes() + offset(view_index) + begin) * width;
          const MatchLink* from = tile.data() + level_index * kTileNodes;
          for (NodeIndex i = 0; i < end - begin; ++i) row[i * width + static_cast<std::size_t>(slot)] = from[i];
        }
      }
    }
  }
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
        if (!target || (fixed[node] != 0 && fixed[NodeAt(matcher, *target)] != 0)) continue;
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
