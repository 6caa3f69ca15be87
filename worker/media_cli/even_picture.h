#ifndef DEPTHFARM_WORKER_MEDIA_CLI_EVEN_PICTURE_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_EVEN_PICTURE_H_

#include "common/image/grid.h"

namespace depthfarm {

// Encoders of 4:2:0 want even sides: a picture of an odd one loses its last column or row.
[[nodiscard]] constexpr int EvenSide(int side) { return side / 2 * 2; }

template <typename T>
[[nodiscard]] Grid<T> WithEvenSides(const Grid<T>& picture) {
  if (picture.width() % 2 == 0 && picture.height() % 2 == 0) return picture;
  Grid<T> result(EvenSide(picture.width()), EvenSide(picture.height()));
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) result(x, y) = picture(x, y);
  }
  return result;
}

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_EVEN_PICTURE_H_
