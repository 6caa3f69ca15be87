#include "worker/segmentation/snic.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "worker/segmentation/seed_grid.h"
#include "worker/segmentation/snic_distance.h"
#include "worker/segmentation/snic_queue.h"

namespace depthfarm {
namespace {

constexpr double kMaxCompactness = 1000;
constexpr std::uint32_t kPopsBetweenStopChecks = 1U << 15;
constexpr int kFrame = 1;                // pixels around the picture
constexpr double kLabelled = -1;         // below every distance: a labelled pixel never waits again
constexpr std::size_t kPixelsAhead = 8;  // how many pops before their turn pixels are asked of memory,
constexpr std::size_t kSumsAhead = 4;    // and segments: by then their pixel is there and says which one

// All that growing asks of a pixel, side by side: the queue jumps about the picture, so each pixel is a cache miss.
struct PixelState {
  double waiting = std::numeric_limits<double>::infinity();  // smallest distance it waits with, or kLabelled
  Ycbcr color = {};
  SegmentIndex label = 0;  // the segment it waits for with that distance, then its own
};

// One segmentation in progress. The picture has a frame of labelled pixels around it, so that neighbours need no
// bounds.
class Growth {
 public:
  Growth(const YcbcrImage& picture, int num_segments, double spatial_weight)
      : spatial_weight_(spatial_weight),
        pixels_(picture.width() + 2 * kFrame, picture.height() + 2 * kFrame, PixelState{.waiting = kLabelled}),
        labelled_(pixels_.size(), false),
        clusters_(static_cast<std::size_t>(num_segments)) {
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) pixels_(x + kFrame, y + kFrame) = PixelState{.color = picture(x, y)};
    }
    for (std::size_t i = 0; i < kNeighbours; ++i) {
      neighbour_offsets_[i] = std::ptrdiff_t{kNeighbourSteps[i].y} * pixels_.width() + kNeighbourSteps[i].x;
    }
  }

  // Where a segment starts: a pixel that no other one has. In ascending order of the segments.
  void Plant(SegmentIndex segment, PixelPosition seed) {
    PixelState& pixel = pixels_(seed.x + kFrame, seed.y + kFrame);
    pixel.waiting = 0;
    pixel.label = segment;
    queue_.Push(0, seed.x + kFrame, seed.y + kFrame);
  }

  // A pixel that has its segment from the start; that segment does not grow.
  void Keep(int x, int y, SegmentIndex segment) {
    PixelState& pixel = pixels_(x + kFrame, y + kFrame);
    pixel.waiting = kLabelled;
    pixel.label = segment;
  }

  Status Run(const std::stop_token& stop) {
    const auto is_live = [this](const SnicElement& element) { return !labelled_[pixels_.Index(element.x, element.y)]; };
    SnicElement element;
    for (std::uint32_t pops = 0; queue_.Pop(is_live, element); ++pops) {
      if (pops % kPopsBetweenStopChecks == 0 && stop.stop_requested()) return Cancelled();
      FetchAhead();
      PixelState& pixel = pixels_(element.x, element.y);
      // Otherwise a nearer element has overtaken this one, or the pixel is labelled.
      if (pixel.waiting != element.distance) continue;
      pixel.waiting = kLabelled;
      labelled_[pixels_.Index(element.x, element.y)] = true;
      SnicCluster& cluster = clusters_[pixel.label];
      cluster.Add(element.x - kFrame, element.y - kFrame, pixel.color);
      OfferNeighbours(element.x, element.y, pixel.label, cluster);
    }
    return {};
  }

  [[nodiscard]] Grid<SegmentIndex> Labels() const {
    Grid<SegmentIndex> labels(pixels_.width() - 2 * kFrame, pixels_.height() - 2 * kFrame);
    for (int y = 0; y < labels.height(); ++y) {
      for (int x = 0; x < labels.width(); ++x) labels(x, y) = pixels_(x + kFrame, y + kFrame).label;
    }
    return labels;
  }

 private:
  // Asks memory for what elements soon to be served are going to touch. Inline because GCC 12 takes a function that
  // only prefetches for one without an effect, and leaves its calls out.
  [[gnu::always_inline]] void FetchAhead() const {
    const std::ptrdiff_t width = pixels_.width();
    if (const SnicElement* later = queue_.Upcoming(kPixelsAhead); later != nullptr) {
      const PixelState* center = &pixels_(later->x, later->y);
      for (const std::ptrdiff_t row : {-width, std::ptrdiff_t{0}, width}) {
        __builtin_prefetch(center + row - 1);
        __builtin_prefetch(center + row + 1);
      }
    }
    if (const SnicElement* soon = queue_.Upcoming(kSumsAhead); soon != nullptr) {
      __builtin_prefetch(&clusters_[pixels_(soon->x, soon->y).label]);
    }
  }

  void OfferNeighbours(int center_x, int center_y, SegmentIndex label, const SnicCluster& cluster) {
    PixelState* center = &pixels_(center_x, center_y);
    std::array<const Ycbcr*, kNeighbours> colors;
    for (std::size_t i = 0; i < kNeighbours; ++i) colors[i] = &center[neighbour_offsets_[i]].color;
    const std::array<double, kNeighbours> distances =
        NeighbourDistances(center_x - kFrame, center_y - kFrame, colors, cluster, spatial_weight_);
    // All are compared before the first branch: which ones are nearer is another coin toss. Where a pixel already waits
    // with no larger a distance it is served before this element, which would find it labelled.
    unsigned nearer = 0;
    for (std::size_t i = 0; i < kNeighbours; ++i) {
      nearer |= static_cast<unsigned>(distances[i] < center[neighbour_offsets_[i]].waiting) << i;
    }
    for (; nearer != 0; nearer &= nearer - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(nearer));
      PixelState& pixel = center[neighbour_offsets_[i]];
      pixel.waiting = distances[i];
      pixel.label = label;
      queue_.Push(distances[i], center_x + kNeighbourSteps[i].x, center_y + kNeighbourSteps[i].y);
    }
  }

  double spatial_weight_;
  Grid<PixelState> pixels_;
  std::vector<bool> labelled_;  // one bit a pixel: stays in the cache, so that the overtaken are cheap to drop
  std::array<std::ptrdiff_t, kNeighbours> neighbour_offsets_ = {};
  std::vector<SnicCluster> clusters_;
  SnicQueue queue_;
};

Status CheckCompactness(double compactness) {
  if (compactness > 0 && compactness <= kMaxCompactness) return {};
  return InvalidArgument("SNIC compactness is " + std::to_string(compactness) + ", expected > 0 and <= 1000");
}

}  // namespace

Result<Grid<SegmentIndex>> SegmentSnic(const YcbcrImage& picture, int num_segments, double compactness,
                                       const std::stop_token& stop) {
  DEPTHFARM_RETURN_IF_ERROR(CheckCompactness(compactness));
  DEPTHFARM_ASSIGN_OR_RETURN(const SeedGrid seeds, SeedGrid::Create(picture.width(), picture.height(), num_segments));
  const double cell_pixels = static_cast<double>(picture.size()) / seeds.num_segments();
  Growth growth(picture, seeds.num_segments(), compactness * compactness / cell_pixels);
  for (int index = 0; index < seeds.num_segments(); ++index)
    growth.Plant(static_cast<SegmentIndex>(index), seeds.Seed(index));
  DEPTHFARM_RETURN_IF_ERROR(growth.Run(stop));
  return growth.Labels();
}

Result<Grid<SegmentIndex>> RegrowSnic(const YcbcrImage& picture, const SegmentMap& before,
                                      const std::vector<std::uint8_t>& still, double compactness,
                                      const std::stop_token& stop) {
  DEPTHFARM_RETURN_IF_ERROR(CheckCompactness(compactness));
  const Grid<SegmentIndex>& labels = before.labels;
  if (picture.width() != labels.width() || picture.height() != labels.height()) {
    return InvalidArgument("the picture is " + std::to_string(picture.width()) + "x" +
                           std::to_string(picture.height()) + ", the frame before " + std::to_string(labels.width()) +
                           "x" + std::to_string(labels.height()));
  }
  const double cell_pixels = static_cast<double>(picture.size()) / before.num_segments();
  Growth growth(picture, before.num_segments(), compactness * compactness / cell_pixels);
  for (int y = 0; y < labels.height(); ++y)
    for (int x = 0; x < labels.width(); ++x)
      if (still[labels(x, y)] != 0) growth.Keep(x, y, labels(x, y));
  for (SegmentIndex s = 0; s < still.size(); ++s)
    if (still[s] == 0) growth.Plant(s, before.centers[s]);
  DEPTHFARM_RETURN_IF_ERROR(growth.Run(stop));
  return growth.Labels();
}

}  // namespace depthfarm
