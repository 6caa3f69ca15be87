#include "worker/refinement/plane_field.h"

namespace depthfarm {

InverseDepthMap RefinedView::Map() const {
  InverseDepthMap map(plane_of_pixel.width(), plane_of_pixel.height());
  for (int y = 0; y < map.height(); ++y)
    for (int x = 0; x < map.width(); ++x) map(x, y) = static_cast<float>(At(x, y));
  return map;
}

}  // namespace depthfarm
