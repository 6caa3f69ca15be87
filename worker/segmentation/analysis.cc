#include "worker/segmentation/analysis.h"

#include <utility>

#include "worker/segmentation/describe.h"
#include "worker/segmentation/snic.h"

namespace depthfarm {

Result<ViewAnalysis> AnalyseView(YcbcrImage picture, int num_segments, double compactness,
                                 const std::stop_token& stop) {
  DEPTHFARM_ASSIGN_OR_RETURN(Grid<SegmentIndex> labels, SegmentSnic(picture, num_segments, compactness, stop));
  SegmentMap segments = DescribeSegments(std::move(labels), picture);
  return ViewAnalysis{.picture = std::move(picture), .segments = std::move(segments)};
}

}  // namespace depthfarm
