#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "worker/segmentation/describe.h"

namespace depthfarm {
namespace {

std::string At(int x, int y) { return "(" + std::to_string(x) + ", " + std::to_string(y) + ")"; }

// Marks the 8-connected part of equal labels around a pixel.
class PartMarker {
 public:
  explicit PartMarker(const Grid<SegmentIndex>& labels)
      : labels_(labels), marked_(labels.width(), labels.height(), 0) {}

  [[nodiscard]] bool Marked(int x, int y) const { return marked_(x, y) != 0; }

  void Mark(int x, int y) {
    const SegmentIndex label = labels_(x, y);
    Reach(x, y, label);
    while (!reached_.empty()) {
      const PixelPosition pixel = reached_.back();
      reached_.pop_back();
      for (int near_y = pixel.y - 1; near_y <= pixel.y + 1; ++near_y) {
        for (int near_x = pixel.x - 1; near_x <= pixel.x + 1; ++near_x) Reach(near_x, near_y, label);
      }
    }
  }

 private:
  void Reach(int x, int y, SegmentIndex label) {
    if (!labels_.Contains(x, y) || labels_(x, y) != label || Marked(x, y)) return;
    marked_(x, y) = 1;
    reached_.push_back({x, y});
  }

  const Grid<SegmentIndex>& labels_;
  Grid<std::uint8_t> marked_;
  std::vector<PixelPosition> reached_;
};

// Runs of equal labels in rows, joined to parts where they touch runs of the row above.
class JoinedRuns {
 public:
  explicit JoinedRuns(const Grid<SegmentIndex>& labels, SegmentIndex last)
      : labels_(labels),
        parts_(static_cast<std::size_t>(last) + 1, 0),
        above_(static_cast<std::size_t>(labels.width())),
        here_(above_.size()) {
    for (int y = 0; y < labels.height(); ++y) {
      AddRow(y);
      std::swap(above_, here_);
    }
  }

  // Whether each label 0 ... last has one 8-connected part.
  [[nodiscard]] bool AreOnePartEach() const {
    return std::ranges::all_of(parts_, [](std::int32_t parts) { return parts == 1; });
  }

 private:
  using Run = std::uint32_t;

  void AddRow(int y) {
    const int width = labels_.width();
    const SegmentIndex* const row = labels_.row(y);
    const SegmentIndex* const row_above = y > 0 ? labels_.row(y - 1) : nullptr;
    for (int x = 0; x < width; ++x) {
      const SegmentIndex label = row[x];
      if (x == 0 || row[x - 1] != label) {
        here_[static_cast<std::size_t>(x)] = static_cast<Run>(parents_.size());
        parents_.push_back(static_cast<Run>(parents_.size()));
        ++parts_[label];
      } else {
        here_[static_cast<std::size_t>(x)] = here_[static_cast<std::size_t>(x - 1)];
      }
      if (row_above == nullptr) continue;
      for (int near = std::max(0, x - 1); near <= std::min(width - 1, x + 1); ++near) {
        if (row_above[near] == label)
          Join(here_[static_cast<std::size_t>(x)], above_[static_cast<std::size_t>(near)], label);
      }
    }
  }

  void Join(Run a, Run b, SegmentIndex label) {
    const Run root_a = RootOf(a);
    const Run root_b = RootOf(b);
    if (root_a == root_b) return;
    parents_[std::max(root_a, root_b)] = std::min(root_a, root_b);
    --parts_[label];
  }

  [[nodiscard]] Run RootOf(Run run) {
    while (parents_[run] != run) run = parents_[run] = parents_[parents_[run]];
    return run;
  }

  const Grid<SegmentIndex>& labels_;
  std::vector<std::int32_t> parts_;  // of each label
  std::vector<Run> parents_;         // the first run of a part is its own
  std::vector<Run> above_;           // run of each pixel
  std::vector<Run> here_;
};

}  // namespace

Status ValidateLabels(const Grid<SegmentIndex>& labels) {
  if (labels.empty()) return Corrupt("label map is empty, expected at least one pixel");
  const SegmentIndex last = *std::max_element(labels.values().begin(), labels.values().end());
  if (last >= labels.size()) {
    return Corrupt("label map of " + std::to_string(labels.size()) + " pixels holds label " + std::to_string(last) +
                   ", expected less than the number of pixels");
  }
  if (JoinedRuns(labels, last).AreOnePartEach()) return {};
  // What is wrong, and where.
  std::vector<std::uint8_t> seen(static_cast<std::size_t>(last) + 1, 0);
  PartMarker parts(labels);
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      if (parts.Marked(x, y)) continue;
      const SegmentIndex label = labels(x, y);
      if (seen[label] != 0) {
        return Corrupt("segment " + std::to_string(label) + " has a second part at " + At(x, y) +
                       ", expected one 8-connected segment a label");
      }
      seen[label] = 1;
      parts.Mark(x, y);
    }
  }
  const auto unused = std::find(seen.begin(), seen.end(), std::uint8_t{0});
  if (unused != seen.end()) {
    return Corrupt("label " + std::to_string(unused - seen.begin()) + " has no pixel, expected labels 0 to " +
                   std::to_string(last) + " to be used");
  }
  return {};
}

}  // namespace depthfarm
