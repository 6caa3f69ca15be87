#include "tests/common/video/test_video.h"

#include <cmath>
#include <cstdint>
#include <random>

namespace depthfarm {

std::string TestPicture(int frame, double offset, int noise) {
  std::mt19937 random(static_cast<std::uint32_t>(frame));
  std::string picture;
  for (int y = 0; y < kVideoHeight; ++y) {
    for (int x = 0; x < kVideoWidth; ++x) {
      const double wave = 60 * std::sin((x + offset) * 0.4) * std::cos(y * 0.3);
      const int grain = noise == 0 ? 0 : static_cast<int>(random() % (2 * static_cast<unsigned>(noise) + 1)) - noise;
      picture += static_cast<char>(static_cast<std::uint8_t>(128 + std::lround(wave) + grain));
    }
  }
  return picture.append(static_cast<std::size_t>(kVideoWidth) * kVideoHeight / 2, static_cast<char>(128));
}

}  // namespace depthfarm
