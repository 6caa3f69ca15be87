#include "worker/refinement/view_memory.h"

#include "worker/refinement/plain_regions.h"

namespace depthfarm {

ViewMemory::Maps ViewMemory::MapsOf(std::span<const std::shared_ptr<const RefinedView>> views, int threads) {
  return maps_.Of(views, [threads](const RefinedView& view) { return view.Map(threads); });
}

ViewMemory::Smoothed ViewMemory::SmoothedOf(std::span<const std::shared_ptr<const ViewAnalysis>> analyses,
                                            int threads) {
  return smoothed_.Of(analyses, [threads](const ViewAnalysis& analysis) {
    SmoothedPicture smoothed{.colours = Blurred(analysis.picture, threads), .plain = {}};
    smoothed.plain = PlainSegments(smoothed.colours, analysis.segments);
    return smoothed;
  });
}

void ViewMemory::Clear() {
  maps_.Clear();
  smoothed_.Clear();
}

}  // namespace depthfarm
