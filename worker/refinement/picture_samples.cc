#include "worker/refinement/picture_samples.h"

#include <algorithm>
#include <array>

namespace depthfarm {
namespace {

ColourGrid BlurredAlong(const ColourGrid& in, int dx, int dy) {
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

ColourGrid Blurred(const ColourGrid& colours) { return BlurredAlong(BlurredAlong(colours, 1, 0), 0, 1); }

}  // namespace depthfarm
