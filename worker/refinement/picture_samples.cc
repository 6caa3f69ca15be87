#include "worker/refinement/picture_samples.h"

#include <algorithm>

namespace depthfarm {
namespace {

ColourGrid Blurred(const ColourGrid& in, int dx, int dy) {
  constexpr std::array<float, 5> kTaps{1.0F / 16, 4.0F / 16, 6.0F / 16, 4.0F / 16, 1.0F / 16};
  ColourGrid out(in.width(), in.height());
  for (int y = 0; y < in.height(); ++y) {
    for (int x = 0; x < in.width(); ++x) {
      Colour sum{};
      for (int k = -2; k <= 2; ++k) {
        const Colour& from = in(std::clamp(x + k * dx, 0, in.width() - 1), std::clamp(y + k * dy, 0, in.height() - 1));
        for (int i = 0; i < 4; ++i) sum[i] += kTaps[k + 2] * from[i];
      }
      out(x, y) = sum;
    }
  }
  return out;
}

}  // namespace

ColourGrid ColourOf(const YcbcrImage& picture, bool blur) {
  ColourGrid grid(picture.width(), picture.height());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    const Ycbcr& p = picture.values()[i];
    grid.values()[i] = {static_cast<float>(p.y), static_cast<float>(p.cb), static_cast<float>(p.cr), 0};
  }
  return blur ? Blurred(Blurred(grid, 1, 0), 0, 1) : grid;
}

}  // namespace depthfarm
