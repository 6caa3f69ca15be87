#include "worker/refinement/start_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "worker/temporal/unchanged.h"

namespace depthfarm {
namespace {

constexpr PlaneIndex kNotYet = std::numeric_limits<PlaneIndex>::max();
constexpr double kOtherSurface = 0.5;  // pixels of u
constexpr int kAround = 2;             // steps to either side: where a surface may have been in the frame before
constexpr int kAroundStep = 4;         // pixels, about a segment
constexpr int kSamePixel = 4;          // grey levels, of the mean of 3 x 3 pixels: less is noise

// Whether the mean of each component over the 3 x 3 pixels around changed by less than `bound` grey levels.
bool LooksTheSame(const YcbcrImage& a, const YcbcrImage& b, int x0, int y0, int bound) {
  std::array<int, 3> change{};
  int count = 0;
  for (int y = std::max(0, y0 - 1); y <= std::min(a.height() - 1, y0 + 1); ++y) {
    for (int x = std::max(0, x0 - 1); x <= std::min(a.width() - 1, x0 + 1); ++x) {
      change[0] += a(x, y).y - b(x, y).y;
      change[1] += a(x, y).cb - b(x, y).cb;
      change[2] += a(x, y).cr - b(x, y).cr;
      ++count;
    }
  }
  return std::all_of(change.begin(), change.end(), [&](int sum) { return std::abs(sum) < bound * count; });
}

// What the unchanged segments of a view take over from one of its references.
class Adoption {
 public:
  Adoption(const RefinedReference& reference, int threshold, const YcbcrImage& picture, RefinedView& to)
      : reference_(reference),
        bound_(std::max(threshold, kSamePixel)),
        picture_(picture),
        to_(to),
        copies_(reference.refined->planes.size(), kNotYet) {}

  void AdoptSegment(SegmentIndex s, PixelPosition center) {
    const RefinedView& from = *reference_.refined;
    to_.kept[s] = 1;
    to_.planes[s] = from.planes[from.plane_of_pixel(center.x, center.y)];
  }

  // After AdoptSegment. A pixel that was on another surface than its segment and looks otherwise now was uncovered by
  // what moved away: it has the plane of its segment.
  void AdoptPixel(SegmentIndex s, int x, int y) {
    const RefinedView& from = *reference_.refined;
    const bool jump = std::abs(from.At(x, y) - to_.planes[s].At(x, y)) > kOtherSurface;
    if (jump && !LooksTheSame(picture_, reference_.analysis->picture, x, y, bound_)) return;
    to_.plane_of_pixel(x, y) = CopyOf(from.plane_of_pixel(x, y));
  }

 private:
  // Copies each plane behind the view's own, at most once.
  PlaneIndex CopyOf(PlaneIndex plane) {
    PlaneIndex& copy = copies_[plane];
    if (copy == kNotYet) {
      copy = static_cast<PlaneIndex>(to_.planes.size());
      to_.planes.push_back(reference_.refined->planes[plane]);
    }
    return copy;
  }

  const RefinedReference& reference_;
  int bound_;
  const YcbcrImage& picture_;
  RefinedView& to_;
  std::vector<PlaneIndex> copies_;
};

// The plane that a segment starts from, see StartFromAround.
SlantedPlane PlaneFromAround(const SegmentMap& segments, SegmentIndex s, const RefinedReference& previous, double reach,
                             const SlantedPlane& own) {
  const SegmentMap& before = previous.analysis->segments;
  const RefinedView& refined = *previous.refined;
  const PixelPosition center = segments.centers[s];
  const double u = own.At(center.x, center.y);
  SlantedPlane best = own;
  std::int32_t least = std::numeric_limits<std::int32_t>::max();
  for (int row = -kAround; row <= kAround; ++row) {
    for (int column = -kAround; column <= kAround; ++column) {
      const int x = center.x + column * kAroundStep;
      const int y = center.y + row * kAroundStep;
      if (!before.labels.Contains(x, y)) continue;
      const SlantedPlane& plane = refined.planes[refined.plane_of_pixel(x, y)];
      if (std::abs(plane.At(center.x, center.y) - u) > reach) continue;
      const std::int32_t distance = L1Distance(before.means[before.labels(x, y)], segments.means[s]);
      if (distance >= least) continue;
      least = distance;
      best = plane;
    }
  }
  return best;
}

}  // namespace

RefinedView StartView(const SegmentMap& segments, std::span<const SlantedPlane> plane_of_segment) {
  return {.planes = {plane_of_segment.begin(), plane_of_segment.end()},
          .kept = std::vector<std::uint8_t>(plane_of_segment.size()),
          .plane_of_pixel = segments.labels};
}

void KeepUnchanged(const ViewAnalysis& analysis, const RefinedReference& previous, const RefinedReference& i_frame,
                   int p_threshold, int i_threshold, RefinedView& view) {
  const SegmentMap& segments = analysis.segments;
  const std::vector<AdoptedSegment> adopted =
      FindUnchanged(segments, previous.analysis->segments, i_frame.analysis->segments, p_threshold, i_threshold);
  Adoption from_previous(previous, p_threshold, analysis.picture, view);
  Adoption from_i_frame(i_frame, i_threshold, analysis.picture, view);
  const auto source = [&](SegmentIndex s) -> Adoption& {
    return adopted[s].source == DepthSource::kIFrame ? from_i_frame : from_previous;
  };
  for (SegmentIndex s = 0; s < adopted.size(); ++s)
    if (adopted[s].source != DepthSource::kEstimated) source(s).AdoptSegment(s, segments.centers[s]);
  for (int y = 0; y < segments.labels.height(); ++y) {
    for (int x = 0; x < segments.labels.width(); ++x) {
      const SegmentIndex s = segments.labels(x, y);
      if (view.kept[s] != 0) source(s).AdoptPixel(s, x, y);
    }
  }
}

void StartFromAround(const SegmentMap& segments, const RefinedReference& previous, std::span<const double> reach,
                     RefinedView& view) {
  for (SegmentIndex s = 0; s < view.num_segments(); ++s)
    if (view.kept[s] == 0) view.planes[s] = PlaneFromAround(segments, s, previous, reach[s], view.planes[s]);
}

}  // namespace depthfarm
