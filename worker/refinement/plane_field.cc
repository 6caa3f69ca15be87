#include "worker/refinement/plane_field.h"

#include "common/base/parallel.h"

namespace depthfarm {

InverseDepthMap RefinedView::Map(int threads) const {
  constexpr std::size_t kRowsAtOnce = 32;
  InverseDepthMap map(plane_of_pixel.width(), plane_of_pixel.height());
  ParallelForPieces(static_cast<std::size_t>(map.height()), kRowsAtOnce, threads,
                    [&](std::size_t begin, std::size_t end) {
                      for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y)
                        for (int x = 0; x < map.width(); ++x) map(x, y) = static_cast<float>(At(x, y));
                    });
  return map;
}

}  // namespace depthfarm
