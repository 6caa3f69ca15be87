#ifndef DEPTHFARM_WORKER_REFINEMENT_PICTURE_SAMPLES_H_
#define DEPTHFARM_WORKER_REFINEMENT_PICTURE_SAMPLES_H_

#include <cstdint>
#include <cstring>

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
[[nodiscard]] FineImage Blurred(const YcbcrImage& picture);

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

// Bilinear; (x, y) must lie in [0, W - 1] x [0, H - 1], W and H at least 2. Pixel: Ycbcr or FineYcbcr.
template <typename Pixel>
[[nodiscard, gnu::always_inline]] inline ColourVector SampleAt(const Grid<Pixel>& picture, double x, double y) {
  const int x0 = x >= picture.width() - 1 ? picture.width() - 2 : static_cast<int>(x);
  const int y0 = y >= picture.height() - 1 ? picture.height() - 2 : static_cast<int>(y);
  const auto fx = static_cast<float>(x - x0);
  const auto fy = static_cast<float>(y - y0);
  const auto top = picture_samples_internal::LoadTwo(picture.row(y0) + x0);
  const auto bottom = picture_samples_internal::LoadTwo(picture.row(y0 + 1) + x0);
  const ColourVector upper = top.left + fx * (top.right - top.left);
  const ColourVector lower = bottom.left + fx * (bottom.right - bottom.left);
  return upper + fy * (lower - upper);
}

// The colours of a picture as it is or smoothed. Refers to the picture, which must outlive it; cheap to copy.
class PictureColours {
 public:
  PictureColours() = default;
  PictureColours(const YcbcrImage& picture) : sharp_(&picture) {}      // NOLINT(google-explicit-constructor): a view
  PictureColours(const FineImage& smoothed) : smoothed_(&smoothed) {}  // NOLINT(google-explicit-constructor): a view
  PictureColours(YcbcrImage&&) = delete;
  PictureColours(FineImage&&) = delete;

  // Null: as it is.
  [[nodiscard]] const FineImage* smoothed() const { return smoothed_; }
  [[nodiscard]] int width() const { return smoothed_ != nullptr ? smoothed_->width() : sharp_->width(); }
  [[nodiscard]] int height() const { return smoothed_ != nullptr ? smoothed_->height() : sharp_->height(); }
  [[nodiscard]] Colour operator()(int x, int y) const {
    return smoothed_ != nullptr ? ColourOf((*smoothed_)(x, y)) : ColourOf((*sharp_)(x, y));
  }
  // As SampleAt.
  [[nodiscard]] ColourVector Between(double x, double y) const {
    return smoothed_ != nullptr ? SampleAt(*smoothed_, x, y) : SampleAt(*sharp_, x, y);
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
