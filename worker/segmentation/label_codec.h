#ifndef DEPTHFARM_WORKER_SEGMENTATION_LABEL_CODEC_H_
#define DEPTHFARM_WORKER_SEGMENTATION_LABEL_CODEC_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/image/grid.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Appends a label map, and to `cuts` where in `bytes` parts with statistics of their own begin (zstd_frame.h).
//
// Row by row, each pixel follows one of four rules, the first that gives its label (labels outside the map count as 0):
//
//   0  the label above where the left one equals that above left (a border goes on downwards), else the left one
//   1  the other of the two
//   2  the label above right
//   3  explicit
//
// Which labels around a pixel are equal is its context: left = above, left = above left, above = above left,
// above right = above, above right = left are bits 0 to 4, of which 13 combinations occur. Rules that give the label of
// a rule before them are left out there; the 2 to 4 that remain are the digits of a number system, and the pixels of
// one context, in order, are the digits of its bytes: 8, 5 or 4 a byte, the first the most significant, the last byte
// filled up with zeros. So the pixels of one context have codes of their own, which follow how often they take each
// rule.
//
//   u32 x 13    bytes of each context, contexts in rising order
//   u32 u32     explicit labels; differences in the table
//   bytes       of each context
//   u32 each    the table: at most 254 differences from the label above (in the top row: the left one), modulo 2^32
//   u8 each     the explicit labels: 0 is one more than the largest explicit label before (at first 0); 1 to 254 the
//               difference of that number in the table; 255 neither
//   u32 each    the labels that are neither
//
// Integers are little-endian. The table has the differences that occur most often. Time: a few ns a pixel.
void AppendLabels(const Grid<SegmentIndex>& labels, std::string& bytes, std::vector<std::size_t>& cuts);

// How many bytes a map of so many pixels may take.
[[nodiscard]] std::size_t LeastLabelBytes(std::size_t pixels);
[[nodiscard]] std::size_t MostLabelBytes(std::size_t pixels);

// The W x H map again; W, H at least 1. Errors (kCorrupt): `bytes` is not exactly such a map, a label is outside
// 0..num_segments - 1. Takes 5 bytes a pixel, and these only once the bytes could hold so many pixels.
[[nodiscard]] Result<Grid<SegmentIndex>> ReadLabels(std::string_view bytes, int width, int height,
                                                    SegmentIndex num_segments);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_LABEL_CODEC_H_
