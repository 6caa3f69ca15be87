#include "worker/segmentation/seed_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "worker/segmentation/picture_size.h"

namespace depthfarm {
namespace {

struct Candidate {
  int columns = 0;
  int rows = 0;
  std::int64_t miss = 0;    // |columns * rows - requested|
  std::int64_t longer = 0;  // the sides of a cell, times columns * rows
  std::int64_t shorter = 0;

  Candidate(int width, int height, std::int64_t requested, int columns_, int rows_)
      : columns(columns_), rows(rows_), miss(std::abs(std::int64_t{columns_} * rows_ - requested)) {
    const std::int64_t cell_width = std::int64_t{width} * rows_;
    const std::int64_t cell_height = std::int64_t{height} * columns_;
    longer = std::max(cell_width, cell_height);
    shorter = std::min(cell_width, cell_height);
  }

  [[nodiscard]] bool BetterThan(const Candidate& other) const {
    if (miss != other.miss) return miss < other.miss;
    // longer / shorter without division: at most 2^28 each
    return longer * other.shorter < other.longer * shorter;
  }
};

// Pixel that holds the centre of cell `index` of `cells` equal parts of `side` pixels.
int CellCenter(int index, int side, int cells) {
  return static_cast<int>((2 * std::int64_t{index} + 1) * side / (2 * std::int64_t{cells}));
}

}  // namespace

Result<SeedGrid> SeedGrid::Create(int width, int height, int requested) {
  DEPTHFARM_RETURN_IF_ERROR(ValidatePictureSize(width, height));
  if (requested < 1) {
    return InvalidArgument("number of segments is " + std::to_string(requested) + ", expected at least 1");
  }
  const std::int64_t wanted = std::min<std::int64_t>(requested, std::int64_t{width} * height);
  const double square_rows = std::sqrt(static_cast<double>(wanted) * height / width);
  // Cells of a picture much higher than wide can't be square: never more rows than segments.
  const int most_rows = static_cast<int>(std::min<std::int64_t>(height, wanted));
  const int first = std::clamp(static_cast<int>(std::min(square_rows, std::ceil(square_rows * 0.9))), 1, most_rows);
  const int last = std::clamp(static_cast<int>(std::max(std::ceil(square_rows), square_rows * 1.1)), 1, most_rows);
  Candidate best(width, height, wanted, std::clamp(static_cast<int>(wanted / first), 1, width), first);
  for (int rows = first; rows <= last; ++rows) {
    const int fewer = static_cast<int>(wanted / rows);
    for (const int columns : {fewer, fewer + 1}) {
      const Candidate candidate(width, height, wanted, std::clamp(columns, 1, width), rows);
      if (candidate.BetterThan(best)) best = candidate;
    }
  }
  return SeedGrid(width, height, best.columns, best.rows);
}

PixelPosition SeedGrid::Seed(int index) const {
  return {CellCenter(index % columns_, width_, columns_), CellCenter(index / columns_, height_, rows_)};
}

}  // namespace depthfarm
