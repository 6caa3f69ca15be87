#include "worker/segmentation/mask_trust.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "common/image/grid.h"

namespace depthfarm {
namespace {

constexpr int kReach = 4;   // pixels from the mask's contours
constexpr int kBeside = 3;  // from here on they are something else
constexpr double kNoTrust = 1.3;
constexpr double kFullTrust = 2;

using Foreground = Grid<std::uint8_t>;

Foreground ForegroundOf(const YcbcrImage& picture) {
  Foreground foreground(picture.width(), picture.height());
  for (std::size_t i = 0; i < picture.size(); ++i)
    foreground.values()[i] = 2 * picture.values()[i].matte > kForegroundMatte ? 1 : 0;
  return foreground;
}

// Grown by a pixel (8-connected), or shrunk: `to` is what spreads.
Foreground Spread(const Foreground& foreground, std::uint8_t to) {
  Foreground spread = foreground;
  for (int y = 0; y < foreground.height(); ++y) {
    for (int x = 0; x < foreground.width(); ++x) {
      if (foreground(x, y) != to) continue;
      for (int ny = std::max(0, y - 1); ny <= std::min(foreground.height() - 1, y + 1); ++ny)
        for (int nx = std::max(0, x - 1); nx <= std::min(foreground.width() - 1, x + 1); ++nx) spread(nx, ny) = to;
    }
  }
  return spread;
}

struct Steps {
  std::int64_t sum = 0;
  std::int64_t pairs = 0;

  void Add(const Steps& other) {
    sum += other.sum;
    pairs += other.pairs;
  }
  [[nodiscard]] double Mean() const { return pairs > 0 ? static_cast<double>(sum) / static_cast<double>(pairs) : 0; }
};

// Of the picture along the contours of `foreground`, from 4-neighbour to 4-neighbour.
Steps StepsAlong(const YcbcrImage& picture, const Foreground& foreground) {
  Steps steps;
  const auto look = [&](int x, int y, int nx, int ny) {
    if (!foreground.Contains(nx, ny) || foreground(x, y) == foreground(nx, ny)) return;
    steps.Add({L1Distance(picture(x, y), picture(nx, ny)), 1});
  };
  for (int y = 0; y < foreground.height(); ++y) {
    for (int x = 0; x < foreground.width(); ++x) {
      look(x, y, x + 1, y);
      look(x, y, x, y + 1);
    }
  }
  return steps;
}

}  // namespace

double ContrastAlongMask(const YcbcrImage& picture) {
  const Foreground foreground = ForegroundOf(picture);
  const Steps along = StepsAlong(picture, foreground);
  if (along.pairs == 0) return 0;
  Steps beside;
  for (const std::uint8_t to : {std::uint8_t{0}, std::uint8_t{1}}) {
    Foreground spread = foreground;
    for (int distance = 1; distance <= kReach; ++distance) {
      spread = Spread(spread, to);
      if (distance >= kBeside) beside.Add(StepsAlong(picture, spread));
    }
  }
  constexpr double kLeastStep = 1;  // grey level: even surroundings have noise
  return along.Mean() / std::max(kLeastStep, beside.Mean());
}

double WeighMask(YcbcrImage& picture) {
  const double contrast = ContrastAlongMask(picture);
  const double trust = std::clamp((contrast - kNoTrust) / (kFullTrust - kNoTrust), 0.0, 1.0);
  if (trust < 1)
    for (Ycbcr& pixel : picture.values()) pixel.matte = static_cast<std::uint8_t>(std::lround(pixel.matte * trust));
  return contrast > 0 ? trust : 1;
}

}  // namespace depthfarm
