#include "worker/refinement/start_view.h"

#include <limits>
#include <vector>

#include "worker/temporal/unchanged.h"

namespace depthfarm {
namespace {

constexpr PlaneIndex kNotYet = std::numeric_limits<PlaneIndex>::max();

// Copies planes of one reference behind the view's own, each at most once.
class PlaneCopies {
 public:
  PlaneCopies(const RefinedView& from, RefinedView& to) : from_(from), to_(to), copies_(from.planes.size(), kNotYet) {}

  PlaneIndex CopyOf(PlaneIndex plane) {
    PlaneIndex& copy = copies_[plane];
    if (copy == kNotYet) {
      copy = static_cast<PlaneIndex>(to_.planes.size());
      to_.planes.push_back(from_.planes[plane]);
    }
    return copy;
  }

 private:
  const RefinedView& from_;
  RefinedView& to_;
  std::vector<PlaneIndex> copies_;
};

}  // namespace

RefinedView StartView(const SegmentMap& segments, std::span<const SlantedPlane> plane_of_segment) {
  return {.planes = {plane_of_segment.begin(), plane_of_segment.end()},
          .kept = std::vector<std::uint8_t>(plane_of_segment.size()),
          .plane_of_pixel = segments.labels};
}

void KeepUnchanged(const SegmentMap& segments, const RefinedReference& previous, const RefinedReference& i_frame,
                   int p_threshold, int i_threshold, RefinedView& view) {
  const std::vector<AdoptedSegment> adopted =
      FindUnchanged(segments, *previous.segments, *i_frame.segments, p_threshold, i_threshold);
  const auto source = [&](SegmentIndex s) -> const RefinedView& {
    return adopted[s].source == DepthSource::kIFrame ? *i_frame.refined : *previous.refined;
  };
  for (SegmentIndex s = 0; s < adopted.size(); ++s) {
    if (adopted[s].source == DepthSource::kEstimated) continue;
    const RefinedView& from = source(s);
    view.kept[s] = 1;
    view.planes[s] = from.planes[from.plane_of_pixel(segments.centers[s].x, segments.centers[s].y)];
  }
  PlaneCopies of_previous(*previous.refined, view);
  PlaneCopies of_i_frame(*i_frame.refined, view);
  for (int y = 0; y < segments.labels.height(); ++y) {
    for (int x = 0; x < segments.labels.width(); ++x) {
      const SegmentIndex s = segments.labels(x, y);
      if (view.kept[s] == 0) continue;
      PlaneCopies& copies = adopted[s].source == DepthSource::kIFrame ? of_i_frame : of_previous;
      view.plane_of_pixel(x, y) = copies.CopyOf(source(s).plane_of_pixel(x, y));
    }
  }
}

}  // namespace depthfarm
