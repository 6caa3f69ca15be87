#include "worker/temporal/unchanged.h"

#include <cstddef>
#include <cstdlib>

namespace depthfarm {
namespace {

bool ChangedLessThan(const MeanColor& a, const MeanColor& b, int threshold) {
  const int bound = threshold * kMeanColorScale;
  return std::abs(a.y - b.y) < bound && std::abs(a.cb - b.cb) < bound && std::abs(a.cr - b.cr) < bound &&
         std::abs(a.matte - b.matte) < bound;
}

}  // namespace

std::vector<AdoptedSegment> FindUnchanged(const SegmentMap& current, const SegmentMap& previous,
                                          const SegmentMap& i_frame, int p_threshold, int i_threshold) {
  std::vector<AdoptedSegment> result(current.means.size());
  for (std::size_t s = 0; s < result.size(); ++s) {
    const PixelPosition center = current.centers[s];
    const SegmentIndex in_i_frame = i_frame.labels(center.x, center.y);
    const SegmentIndex in_previous = previous.labels(center.x, center.y);
    if (ChangedLessThan(current.means[s], i_frame.means[in_i_frame], i_threshold)) {
      result[s] = {DepthSource::kIFrame, in_i_frame};
    } else if (ChangedLessThan(current.means[s], previous.means[in_previous], p_threshold)) {
      result[s] = {DepthSource::kPrevious, in_previous};
    }
  }
  return result;
}

}  // namespace depthfarm
