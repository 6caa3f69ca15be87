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
//   u32                   version, 1
//   one zstd frame with content size and content checksum, and nothing after it:
//     u32 u32 u32         width, height, number of segments
//     W*H bytes, 3 times  planes Y, Cb, Cr: each value less its left neighbour's (0 at the left edge), modulo 256
//     W*H bytes           how each label follows from those before it (label_codec.h)
//     the rest            the labels that follow from none
//
// Means, centres and adjacency follow from these (DescribeSegments) and are not stored.
// The same analysis gives the same bytes with the same version of libzstd.
// Requires an analysis as AnalyseView makes it.
[[nodiscard]] std::string EncodeAnalysis(const ViewAnalysis& analysis);

// The analysis again. `bytes` may come from anyone: sizes are checked before memory is taken for them, labels before
// use. Errors: kCorrupt (not such bytes, damaged, or no label map), kIncompatible (another version).
[[nodiscard]] Result<ViewAnalysis> DecodeAnalysis(std::string_view bytes);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_ANALYSIS_CODEC_H_
