#include "worker/segmentation/analysis.h"

#include <cstdint>
#include <utility>
#include <vector>

#include "worker/segmentation/describe.h"
#include "worker/segmentation/snic.h"
#include "worker/segmentation/still_segments.h"

namespace depthfarm {

Result<ViewAnalysis> AnalyseView(YcbcrImage picture, int num_segments, double compactness,
                                 const std::stop_token& stop) {
  DEPTHFARM_ASSIGN_OR_RETURN(Grid<SegmentIndex> labels, SegmentSnic(picture, num_segments, compactness, stop));
  SegmentMap segments = DescribeSegments(std::move(labels), picture);
  return ViewAnalysis{.picture = std::move(picture), .segments = std::move(segments)};
}

Result<ViewAnalysis> AnalyseNextView(YcbcrImage picture, const ViewAnalysis& before, int threshold, double compactness,
                                     const std::stop_token& stop) {
  const SegmentMap& segments = before.segments;
  std::vector<std::uint8_t> still(segments.centers.size());
  if (picture.width() == before.picture.width() && picture.height() == before.picture.height())
    still = StillSegments(segments, before.picture, picture, threshold);
  DEPTHFARM_ASSIGN_OR_RETURN(Grid<SegmentIndex> labels, RegrowSnic(picture, segments, still, compactness, stop));
  SegmentMap described = DescribeSegments(std::move(labels), picture);
  return ViewAnalysis{.picture = std::move(picture), .segments = std::move(described)};
}

}  // namespace depthfarm
