#include "worker/segmentation/snic.h"

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "worker/segmentation/seed_grid.h"
#include "worker/segmentation/snic_queue.h"

namespace depthfarm {
namespace {

constexpr double kMaxCompactness = 1000;
constexpr std::uint32_t kPopsBetweenStopChecks = 1U << 15;
constexpr int kFrame = 1;         // pixels around the picture
constexpr double kLabelled = -1;  // below every distance: a labelled pixel never waits again

// All that growing asks of a pixel, side by side: the queue jumps about the picture, so each pixel is a cache miss.
struct PixelState {
  double waiting = std::numeric_limits<double>::infinity();  // smallest distance it waits with, or kLabelled
  Ycbcr color = {};
  SegmentIndex label = 0;  // the segment it waits for with that distance, then its own
};

// Sums over a segment's pixels. Integers, so exact in double.
struct Cluster {
  double x = 0;
  double y = 0;
  double luma = 0;
  double cb = 0;
  double cr = 0;
  double matte = 0;
  double pixels = 0;

  void Add(int px, int py, const Ycbcr& color) {
    x += px;
    y += py;
    luma += color.y;
    cb += color.cb;
    cr += color.cr;
    matte += color.matte;
    pixels += 1;
  }
  [[nodiscard]] Cluster Mean() const {
    return {x / pixels, y / pixels, luma / pixels, cb / pixels, cr / pixels, matte / pixels, 1};
  }
};

// One segmentation in progress. The picture has a frame of labelled pixels around it, so that neighbours need no
// bounds.
class Growth {
 public:
  Growth(const YcbcrImage& picture, const SeedGrid& seeds, double spatial_weight)
      : spatial_weight_(spatial_weight),
        pixels_(picture.width() + 2 * kFrame, picture.height() + 2 * kFrame, PixelState{.waiting = kLabelled}),
        clusters_(static_cast<std::size_t>(seeds.num_segments())) {
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) pixels_(x + kFrame, y + kFrame) = PixelState{.color = picture(x, y)};
    }
    for (int index = 0; index < seeds.num_segments(); ++index) {
      const PixelPosition seed = seeds.Seed(index);
      Wait(seed.x + kFrame, seed.y + kFrame, 0, static_cast<SegmentIndex>(index));
    }
  }

  Status Run(const std::stop_token& stop) {
    // An element that its pixel no longer waits with was overtaken by a nearer one, or its pixel is labelled. What a
    // live one is going to touch is asked of memory meanwhile.
    const auto is_live = [this](const SnicElement& element) {
      const PixelState* pixel = &pixels_(element.x, element.y);
      __builtin_prefetch(pixel - pixels_.width());
      __builtin_prefetch(pixel + pixels_.width());
      if (pixel->waiting != element.distance) return false;
      __builtin_prefetch(&clusters_[pixel->label]);
      return true;
    };
    SnicElement element;
    for (std::uint32_t pops = 0; queue_.Pop(is_live, element); ++pops) {
      if (pops % kPopsBetweenStopChecks == 0 && stop.stop_requested()) return Cancelled();
      PixelState& pixel = pixels_(element.x, element.y);
      pixel.waiting = kLabelled;
      Cluster& cluster = clusters_[pixel.label];
      cluster.Add(element.x - kFrame, element.y - kFrame, pixel.color);
      OfferNeighbours(element.x, element.y, pixel.label, cluster.Mean());
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
  void OfferNeighbours(int center_x, int center_y, SegmentIndex label, const Cluster& mean) {
    for (int y = center_y - 1; y <= center_y + 1; ++y) {
      const PixelState* row = pixels_.row(y);
      const double dy = (y - kFrame) - mean.y;
      for (int x = center_x - 1; x <= center_x + 1; ++x) {
        const PixelState& pixel = row[x];
        if (pixel.waiting == kLabelled) continue;
        const double dx = (x - kFrame) - mean.x;
        const double dl = pixel.color.y - mean.luma;
        const double db = pixel.color.cb - mean.cb;
        const double dr = pixel.color.cr - mean.cr;
        const double dm = pixel.color.matte - mean.matte;
        const double distance = (dl * dl + db * db + dr * dr + dm * dm) + (dx * dx + dy * dy) * spatial_weight_;
        // Where it already waits with no larger a distance it is served before this element, which would find it
        // labelled.
        if (distance < pixel.waiting) Wait(x, y, distance, label);
      }
    }
  }

  void Wait(int x, int y, double distance, SegmentIndex label) {
    PixelState& pixel = pixels_(x, y);
    pixel.waiting = distance;
    pixel.label = label;
    queue_.Push({distance, next_sequence_++, static_cast<std::uint16_t>(x), static_cast<std::uint16_t>(y)});
  }

  double spatial_weight_;
  Grid<PixelState> pixels_;
  std::vector<Cluster> clusters_;
  SnicQueue queue_;
  std::uint32_t next_sequence_ = 0;
};

}  // namespace

Result<Grid<SegmentIndex>> SegmentSnic(const YcbcrImage& picture, int num_segments, double compactness,
                                       const std::stop_token& stop) {
  if (!(compactness > 0 && compactness <= kMaxCompactness)) {
    return InvalidArgument("SNIC compactness is " + std::to_string(compactness) + ", expected > 0 and <= 1000");
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const SeedGrid seeds, SeedGrid::Create(picture.width(), picture.height(), num_segments));
  const double cell_pixels = static_cast<double>(picture.size()) / seeds.num_segments();
  Growth growth(picture, seeds, compactness * compactness / cell_pixels);
  DEPTHFARM_RETURN_IF_ERROR(growth.Run(stop));
  return growth.Labels();
}

}  // namespace depthfarm
