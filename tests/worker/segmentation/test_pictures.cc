#include "tests/worker/segmentation/test_pictures.h"

#include <algorithm>
#include <random>

namespace depthfarm {
namespace {

std::uint8_t Clamped(int value) { return static_cast<std::uint8_t>(std::clamp(value, 0, 255)); }

}  // namespace

YcbcrImage NoisePicture(int width, int height, std::uint32_t seed) {
  std::mt19937 random(seed);
  YcbcrImage picture(width, height);
  for (Ycbcr& pixel : picture.values()) {
    const auto bits = static_cast<std::uint32_t>(random());
    pixel = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8U),
             static_cast<std::uint8_t>(bits >> 16U)};
  }
  return picture;
}

YcbcrImage ScenePicture(int width, int height, std::uint32_t seed) {
  std::mt19937 random(seed);
  const auto noise = [&random] { return static_cast<int>(random() % 7) - 3; };
  YcbcrImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int object = (x + y / 2) / 13 % 3 * 50;
      picture(x, y) = {Clamped(40 + object + x / 2 + noise()), Clamped(128 + object / 3 - y / 3 + noise()),
                       Clamped(110 + (x - y) / 4 + noise())};
    }
  }
  return picture;
}

YcbcrImage GradientPicture(int width, int height) {
  YcbcrImage picture(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      picture(x, y) = {Clamped(255 * x / width), Clamped(255 * y / height), Clamped(255 - 255 * y / height)};
    }
  }
  return picture;
}

YcbcrImage ConstantPicture(int width, int height) { return {width, height, Ycbcr{90, 120, 140}}; }

std::ostream& operator<<(std::ostream& out, const NamedPicture& picture) { return out << picture.name; }

std::vector<NamedPicture> PropertyPictures() {
  return {
      {"Noise", NoisePicture(61, 47, 1), 120},
      {"NoiseOneSegment", NoisePicture(23, 17, 2), 1},
      {"NoiseOneSegmentAPixel", NoisePicture(19, 11, 3), 19 * 11},
      {"Scene", ScenePicture(96, 64, 4), 300},
      {"SceneFewSegments", ScenePicture(80, 90, 5), 7},
      {"Gradient", GradientPicture(70, 50), 175},
      {"Constant", ConstantPicture(64, 48), 150},
      {"OneRow", ScenePicture(200, 1, 6), 20},
      {"OneColumn", NoisePicture(1, 150, 7), 11},
      {"OnePixel", ConstantPicture(1, 1), 5},
  };
}

}  // namespace depthfarm
