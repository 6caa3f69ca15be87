#ifndef DEPTHFARM_WORKER_SEGMENTATION_ANALYSIS_CODEC_H_
#define DEPTHFARM_WORKER_SEGMENTATION_ANALYSIS_CODEC_H_

#include <string>
#include <string_view>

#include "common/base/status.h"
#include "worker/segmentation/analysis.h"

namespace depthfarm {

// Bytes of an analysis, as stored and sent between workers. All integers are little-endian:
//
//   "DFVA"                magic
//   u32                   version, 3 (kViewAnalysisVersion)
//   one zstd frame with content size and content checksum, and nothing after it:
//     u32 u32 u32         width, height, number of segments
//     u32                 bit 0: there is a matte; 1: a prior; 2: it has confidence
//     f32 f32             lowest value and step of the prior's codes, 0 without
//     W*H bytes, 3 times  planes Y, Cb, Cr: each value less its left neighbour's (0 at the left edge), modulo 256
//     W*H bytes           of a matte: the same of it
//     W*H bytes, 2 times  of a prior: the same of the low and of the high bytes of its codes
//     W*H bytes           of its confidence: the same of it
//     the rest            the labels: how each follows from those before it (label_codec.h)
//
// Means, centres, adjacency and priors of segments follow from these (DescribeSegments, DescribePrior) and are not
// stored. The same analysis gives the same bytes with the same version of libzstd. Requires an analysis as AnalyseView
// makes it.
[[nodiscard]] std::string EncodeAnalysis(const ViewAnalysis& analysis);

// The analysis again. `bytes` may come from anyone: sizes are checked before memory is taken for them, labels before
// use. Errors: kCorrupt (not such bytes, damaged, or no label map), kIncompatible (another version).
[[nodiscard]] Result<ViewAnalysis> DecodeAnalysis(std::string_view bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_ANALYSIS_CODEC_H_
