#ifndef DEPTHFARM_WORKER_SEGMENTATION_DESCRIBE_H_
#define DEPTHFARM_WORKER_SEGMENTATION_DESCRIBE_H_

#include "common/base/status.h"
#include "common/image/grid.h"
#include "common/image/picture.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Whether a label map that comes from a file or peer is one: labels 0..N-1, each used, each segment 8-connected.
// Errors (kCorrupt): the first violation, by pixel or label. Work O(pixels).
[[nodiscard]] Status ValidateLabels(const Grid<SegmentIndex>& labels);

// Mean colour, centre and neighbours of each segment, as by integer arithmetic.
// Means are rounded to the nearest 1/64 grey level, halves up; of pixels equally near to the centroid the first row by
// row is the centre. Requires labels that ValidateLabels accepts and a picture of the same size. Work O(pixels).
[[nodiscard]] SegmentMap DescribeSegments(Grid<SegmentIndex> labels, const YcbcrImage& picture);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_DESCRIBE_H_
