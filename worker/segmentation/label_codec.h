#ifndef DEPTHFARM_WORKER_SEGMENTATION_LABEL_CODEC_H_
#define DEPTHFARM_WORKER_SEGMENTATION_LABEL_CODEC_H_

#include <cstddef>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/image/grid.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Most bytes that an explicit label takes (see below).
inline constexpr std::size_t kMaxExplicitLabelBytes = 5;

// Appends a label map: one byte a pixel, row by row,
//
//   0  the label above where the left one equals that above left (a border goes on downwards), else the left one
//   1  the other of the two
//   2  the label above right
//   3  explicit
//
// (labels outside the map count as 0), then the explicit labels in the same order: each less the label above (in the
// top row: the left one), its sign folded into the lowest bit, seven bits a byte from the lowest, the eighth set on all
// but the last. The first rule that fits is the one used.
void AppendLabels(const Grid<SegmentIndex>& labels, std::string& bytes);

// The W x H map again. Errors (kCorrupt): `bytes` is not exactly such a map, a label is outside 0..num_segments - 1.
[[nodiscard]] Result<Grid<SegmentIndex>> ReadLabels(std::string_view bytes, int width, int height,
                                                    SegmentIndex num_segments);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_LABEL_CODEC_H_
