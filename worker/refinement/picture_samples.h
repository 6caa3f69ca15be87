#ifndef DEPTHFARM_WORKER_REFINEMENT_PICTURE_SAMPLES_H_
#define DEPTHFARM_WORKER_REFINEMENT_PICTURE_SAMPLES_H_

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "common/base/double_pair.h"
#include "common/image/colour.h"
#include "common/image/grid.h"
#include "common/image/picture.h"

namespace depthfarm {

// A pixel of a smoothed picture in 1/256 grey level: what smoothing makes of 8 bits, to the last bit.
struct FineYcbcr {
  std::uint16_t y = 0;
  std::uint16_t cb = 0;
  std::uint16_t cr = 0;
  std::uint16_t matte = 0;
  bool operator==(const FineYcbcr&) const = default;
};

using FineImage = Grid<FineYcbcr>;

inline constexpr int kFineScale = 256;

[[nodiscard]] inline Colour ColourOf(const FineYcbcr& pixel) {
  constexpr float kUnit = 1.0F / kFineScale;
  return {static_cast<float>(pixel.y) * kUnit, static_cast<float>(pixel.cb) * kUnit,
          static_cast<float>(pixel.cr) * kUnit, static_cast<float>(pixel.matte) * kUnit};
}

// Smoothed by a Gaussian of one pixel (1 4 6 4 1, borders repeated).
[[nodiscard]] FineImage Blurred(const YcbcrImage& picture, int threads = 1);

// A Colour in one register: GCC's and Clang's vector types, for they do not find them by themselves in loops over four
// values. Each value is computed as it would be alone.
using ColourVector = float __attribute__((vector_size(16)));

[[nodiscard]] inline ColourVector VectorOf(const Colour& colour) {
  ColourVector vector;
  std::memcpy(&vector, colour.data(), sizeof(vector));
  return vector;
}

namespace picture_samples_internal {

using Bytes = std::uint8_t __attribute__((vector_size(16)));
using Words = std::uint16_t __attribute__((vector_size(16)));
using Quads = std::int32_t __attribute__((vector_size(16)));
using Longs = std::uint64_t __attribute__((vector_size(16)));

struct TwoColours {
  ColourVector left, right;
};

// Values are widened by putting zeros behind them: little-endian.
[[nodiscard]] inline TwoColours Widened(Words words) {
  constexpr Words kZero = {};
  return {
      __builtin_convertvector((Quads)__builtin_shufflevector(words, kZero, 0, 8, 1, 9, 2, 10, 3, 11), ColourVector),
      __builtin_convertvector((Quads)__builtin_shufflevector(words, kZero, 4, 12, 5, 13, 6, 14, 7, 15), ColourVector)};
}

// Two neighbours of a row.
[[nodiscard]] inline TwoColours LoadTwo(const Ycbcr* pixels) {
  static_assert(sizeof(Ycbcr) == 4);
  std::uint64_t both = 0;
  std::memcpy(&both, pixels, sizeof(both));
  const auto bytes = (Bytes)Longs{both, 0};
  constexpr Bytes kZero = {};
  return Widened((Words)__builtin_shufflevector(bytes, kZero, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23));
}

[[nodiscard]] inline TwoColours LoadTwo(const FineYcbcr* pixels) {
  static_assert(sizeof(FineYcbcr) == 8);
  Words words;
  std::memcpy(&words, pixels, sizeof(words));
  constexpr float kUnit = 1.0F / kFineScale;
  const TwoColours fine = Widened(words);
  return {fine.left * kUnit, fine.right * kUnit};
}

}  // namespace picture_samples_internal

// The whole part of numbers that are not negative.
using IntPair = std::int32_t __attribute__((vector_size(8)));
[[nodiscard]] inline IntPair WholePart(DoublePair position) { return __builtin_convertvector(position, IntPair); }

// Samples a picture between its pixels, bilinearly. Refers to the picture, of at least 2 x 2 pixels. Pixel: Ycbcr or
// FineYcbcr.
template <typename Pixel>
class Sampler {
 public:
  explicit Sampler(const Grid<Pixel>& picture)
      : pixels_(picture.row(0)), width_(picture.width()), last_{picture.width() - 2, picture.height() - 2} {}

  // `position` must lie in [0, W - 1] x [0, H - 1].
  [[nodiscard, gnu::always_inline]] ColourVector At(DoublePair position) const {
    IntPair corner = WholePart(position);
    corner += corner > last_;  // that is -1 where it holds: on the last column or row, which has none beside it
    const auto fraction = __builtin_convertvector(position - __builtin_convertvector(corner, DoublePair), FloatPair);
    const Pixel* const top_pixels = pixels_ + (static_cast<std::ptrdiff_t>(corner[1]) * width_ + corner[0]);
    const auto top = picture_samples_internal::LoadTwo(top_pixels);
    const auto bottom = picture_samples_internal::LoadTwo(top_pixels + width_);
    const ColourVector upper = top.left + fraction[0] * (top.right - top.left);
    const ColourVector lower = bottom.left + fraction[0] * (bottom.right - bottom.left);
    return upper + fraction[1] * (lower - upper);
  }

 private:
  using FloatPair = float __attribute__((vector_size(8)));

  const Pixel* pixels_;
  std::ptrdiff_t width_;
  IntPair last_;
};

// The colours of a picture as it is or smoothed. Refers to the picture, which must outlive it; cheap to copy.
class PictureColours {
 public:
  PictureColours() = default;
  PictureColours(const YcbcrImage& picture) : sharp_(&picture) {}      // NOLINT(google-explicit-constructor): a view
  PictureColours(const FineImage& smoothed) : smoothed_(&smoothed) {}  // NOLINT(google-explicit-constructor): a view
  PictureColours(YcbcrImage&&) = delete;
  PictureColours(FineImage&&) = delete;

  // One of them is null.
  [[nodiscard]] const YcbcrImage* sharp() const { return sharp_; }
  [[nodiscard]] const FineImage* smoothed() const { return smoothed_; }
  [[nodiscard]] int width() const { return smoothed_ != nullptr ? smoothed_->width() : sharp_->width(); }
  [[nodiscard]] int height() const { return smoothed_ != nullptr ? smoothed_->height() : sharp_->height(); }
  [[nodiscard]] Colour operator()(int x, int y) const {
    return smoothed_ != nullptr ? ColourOf((*smoothed_)(x, y)) : ColourOf((*sharp_)(x, y));
  }
  // As Sampler::At.
  [[nodiscard]] ColourVector Between(double x, double y) const {
    const DoublePair position{x, y};
    return smoothed_ != nullptr ? Sampler(*smoothed_).At(position) : Sampler(*sharp_).At(position);
  }
  // Calls `use` with the picture, a YcbcrImage or a FineImage: what asks for many pixels need not tell each time.
  template <typename Use>
  auto With(const Use& use) const {
    return smoothed_ != nullptr ? use(*smoothed_) : use(*sharp_);
  }

 private:
  const YcbcrImage* sharp_ = nullptr;
  const FineImage* smoothed_ = nullptr;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_PICTURE_SAMPLES_H_
