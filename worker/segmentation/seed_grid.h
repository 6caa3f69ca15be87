#ifndef DEPTHFARM_WORKER_SEGMENTATION_SEED_GRID_H_
#define DEPTHFARM_WORKER_SEGMENTATION_SEED_GRID_H_

#include "common/base/status.h"
#include "worker/segmentation/segment_map.h"

namespace depthfarm {

// Where the segments of a W x H picture start: columns x rows seeds at the centres of equal cells, numbered row by row.
// The seed's number is the number of its segment, so the actual number of segments follows from W, H and the request.
class SeedGrid {
 public:
  // The grid whose number of seeds is nearest to `requested` among near-square ones: `rows` within 10 % of
  // sqrt(requested * H / W) (its two neighbouring integers always included), `columns` next to requested / rows. Of
  // equally near ones the one with the most square cells, then the one with fewer rows. More than one seed a pixel is
  // not possible: a larger request gives one segment per pixel. Errors (kInvalidArgument): sides
  // outside 1..kMaxPictureSide, requested < 1.
  [[nodiscard]] static Result<SeedGrid> Create(int width, int height, int requested);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] int num_segments() const { return columns_ * rows_; }
  // Pixel of seed `index`, in 0..num_segments() - 1; no two seeds share a pixel.
  [[nodiscard]] PixelPosition Seed(int index) const;

 private:
  SeedGrid(int width, int height, int columns, int rows)
      : width_(width), height_(height), columns_(columns), rows_(rows) {}

  int width_;
  int height_;
  int columns_;
  int rows_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_SEGMENTATION_SEED_GRID_H_
