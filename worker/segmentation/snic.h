#ifndef DEPTHFARM_WORKER_SEGMENTATION_SNIC_H_
#define DEPTHFARM_WORKER_SEGMENTATION_SNIC_H_

#include <cstdint>
#include <stop_token>
#include <vector>

#include "common/base/status.h"
#include "common/image/grid.h"
#include "common/image/picture.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Simple non-iterative clustering (R. Achanta, S. Suesstrunk, "Superpixels and polygons using simple non-iterative
// clustering", CVPR 2017) in Y'CbCr with 8-connected segments (paper IV-C).
//
// Segments grow from the seeds of SeedGrid. Of all pixels that touch a segment the one with the smallest distance joins
// next; the distance is measured when the pixel is seen from the segment,
//
//   |colour - mean colour|^2 + |position - centroid|^2 * compactness^2 / (W * H / N),
//
// to the segment's mean over the pixels it has by then. Equal distances are served in the order they were met.
// Published variants square-root and scale this; the order, hence the result, is the same.
//
// Result  W x H labels, each of 0..N-1 used, each segment 8-connected; N = SeedGrid::num_segments().
// Units   picture: grey levels; compactness: grey levels at one cell side from the centroid (the paper's m = 5).
// Errors  kInvalidArgument: sides outside 1..kMaxPictureSide, num_segments < 1, compactness not > 0 or above 1000;
//         kCancelled soon (about 10 ms) after `stop` is requested.
// Work    O(W H log(W H)) time, about 40 bytes a pixel. The same bytes everywhere: + - * / in one order, one thread.
[[nodiscard]] Result<Grid<SegmentIndex>> SegmentSnic(const YcbcrImage& picture, int num_segments, double compactness,
                                                     const std::stop_token& stop = {});

// The segmentation of the next frame of a view: segments of which `still` (one a segment) is 1 keep their pixels, the
// others give them up and grow anew over what all of these had, from the centre that each had before. So the number of
// segments stays, and where nothing moves so do the segments.
//
// Result  as SegmentSnic, N that of `before`.
// Errors  kInvalidArgument: a picture of another size than `before`, compactness as above; kCancelled.
// Work    that of SegmentSnic on the pixels given up, and O(W H) more.
[[nodiscard]] Result<Grid<SegmentIndex>> RegrowSnic(const YcbcrImage& picture, const SegmentMap& before,
                                                    const std::vector<std::uint8_t>& still, double compactness,
                                                    const std::stop_token& stop = {});

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_SNIC_H_
