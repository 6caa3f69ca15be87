#include "worker/refinement/picture_samples.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "common/base/parallel.h"

namespace depthfarm {
namespace {

constexpr std::array<int, 5> kTaps{1, 4, 6, 4, 1};  // sixteenths

// A row in 1/16 grey level.
void BlurRow(const Ycbcr* in, int width, FineYcbcr* out) {
  const auto at = [&](int x, auto component) { return static_cast<int>(in[std::clamp(x, 0, width - 1)].*component); };
  const auto sum = [&](int x, auto component) {
    int weighted = 0;
    for (int k = -2; k <= 2; ++k) weighted += kTaps[static_cast<std::size_t>(k + 2)] * at(x + k, component);
    return static_cast<std::uint16_t>(weighted);
  };
  for (int x = 0; x < width; ++x)
    out[x] = {sum(x, &Ycbcr::y), sum(x, &Ycbcr::cb), sum(x, &Ycbcr::cr), sum(x, &Ycbcr::matte)};
}

// The rows [top, bottom).
void BlurRows(const YcbcrImage& picture, int top, int bottom, FineImage& blurred) {
  const int height = picture.height();
  // The rows around one, each where its number modulo their count says.
  std::array<std::vector<FineYcbcr>, kTaps.size()> rows;
  for (auto& row : rows) row.resize(static_cast<std::size_t>(picture.width()));
  int next = std::max(0, top - 2);
  for (int y = top; y < bottom; ++y) {
    for (; next <= std::min(y + 2, height - 1); ++next)
      BlurRow(picture.row(next), picture.width(), rows[static_cast<std::size_t>(next) % rows.size()].data());
    std::array<const FineYcbcr*, kTaps.size()> around{};
    for (int k = -2; k <= 2; ++k) {
      const auto row = static_cast<std::size_t>(std::clamp(y + k, 0, height - 1));
      around[static_cast<std::size_t>(k + 2)] = rows[row % rows.size()].data();
    }
    FineYcbcr* const out = blurred.row(y);
    for (int x = 0; x < picture.width(); ++x) {
      const auto sum = [&](auto component) {
        int weighted = 0;
        for (std::size_t k = 0; k < kTaps.size(); ++k) weighted += kTaps[k] * (around[k][x].*component);
        return static_cast<std::uint16_t>(weighted);
      };
      out[x] = {sum(&FineYcbcr::y), sum(&FineYcbcr::cb), sum(&FineYcbcr::cr), sum(&FineYcbcr::matte)};
    }
  }
}

}  // namespace

FineImage Blurred(const YcbcrImage& picture, int threads) {
  FineImage blurred(picture.width(), picture.height());
  const auto rows = static_cast<std::size_t>(picture.height());
  const auto pieces = static_cast<std::size_t>(std::max(threads, 1));
  ParallelForPieces(rows, (rows + pieces - 1) / pieces, threads, [&](std::size_t begin, std::size_t end) {
    BlurRows(picture, static_cast<int>(begin), static_cast<int>(end), blurred);
  });
  return blurred;
}

}  // namespace depthfarm
