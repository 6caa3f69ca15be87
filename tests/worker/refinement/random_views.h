#ifndef DEPTHFARM_TESTS_WORKER_REFINEMENT_RANDOM_VIEWS_H_
#define DEPTHFARM_TESTS_WORKER_REFINEMENT_RANDOM_VIEWS_H_

#include <cstdint>

#include "tests/support/random.h"
#include "worker/refinement/other_view.h"

namespace depthfarm {

inline YcbcrImage RandomPicture(test::Random& random, int width, int height) {
  YcbcrImage picture(width, height);
  const auto grey = [&] { return static_cast<std::uint8_t>(random.Int(0, 255)); };
  for (Ycbcr& pixel : picture.values()) pixel = {grey(), grey(), grey(), grey()};
  return picture;
}

// A view and another one, of any size from 2 x 2 pixels, in which about half of it appears, with hidden points and
// points that are seen through; neither shows anything.
struct RandomViews {
  RandomViews(test::Random& random, int width, int height)
      : own(RandomPicture(random, width, height)),
        there(RandomPicture(random, random.Int(2, 90), random.Int(2, 60))),
        smoothed_own(Blurred(own)),
        smoothed_there(Blurred(there)),
        there_map(there.width(), there.height()) {
    const auto real = [&](double most) { return most * random.Int(-1000, 1000) / 1000; };
    pair.m << 1 + real(0.1), real(0.1), real(10), real(0.1), 1 + real(0.1), real(10), real(2e-3), real(2e-3), 1;
    pair.e = {real(2), real(1), real(0.05)};
    pair.other_scale = 1 + real(0.2);
    sigma = 1.5 + 10 * random.Int(0, 10);
    if (random.Chance(5)) pair.e = {0, 0, 0};  // nothing moves
    const int steady = random.Int(1, 6);       // pixels of like depth
    for (int y = 0; y < there.height(); ++y) {
      for (int x = 0; x < there.width(); ++x) {
        const bool starts = x % steady == 0 && y % steady == 0;
        there_map(x, y) = starts ? static_cast<float>(real(12)) : there_map(x / steady * steady, y / steady * steady);
      }
    }
  }
  RandomViews(const RandomViews&) = delete;
  RandomViews& operator=(const RandomViews&) = delete;

  [[nodiscard]] OtherView Other(bool smoothed) const {
    return {.pair = &pair,
            .colour = smoothed ? PictureColours(smoothed_there) : PictureColours(there),
            .map = &there_map,
            .sigma = sigma};
  }
  [[nodiscard]] PictureColours Own(bool smoothed) const { return smoothed ? PictureColours(smoothed_own) : own; }

  YcbcrImage own;
  YcbcrImage there;
  FineImage smoothed_own;
  FineImage smoothed_there;
  PairGeometry pair;
  InverseDepthMap there_map;
  double sigma = 1.5;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_TESTS_WORKER_REFINEMENT_RANDOM_VIEWS_H_
