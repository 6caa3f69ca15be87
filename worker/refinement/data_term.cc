#include "worker/refinement/data_term.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "common/base/parallel.h"

namespace depthfarm {
namespace {

constexpr double kBlurArea = 13;               // pixels that a smoothed one shares its noise with
constexpr double kMisfitFloor = 0.03;          // of rho: differences below tell nothing of a silhouette
constexpr double kAgreement = 50;              // weight of another view's depth
constexpr double kAgreementScale = 0.5;        // pixels of u
constexpr std::size_t kSegmentsAtOnce = 4096;  // of a thread

// One pixel of each `row_step` x `column_step` (1 or 2) speaks, for all of them: what the others would add is not worth
// its time. Its column is even where its row is.
struct Sampling {
  int row_step = 1;
  int column_step = 1;
};
constexpr Sampling kSmoothed{2, 2};
constexpr Sampling kSharp{1, 2};  // as on a chessboard

// One segment against one other view.
struct Fit {
  double rho = 0;
  int pixels = 0;
  NormalEquations equations;
};

// A pixel that another view sees.
struct SeenPixel {
  int x = 0;
  PlaneIndex segment = 0;
  Seen seen;
};

// What the misfit of one pixel says of its u: weight g (g du + r), summed over the components.
struct PixelFit {
  int x = 0;
  PlaneIndex segment = 0;
  double rho = 0;
  double gg = 0;
  double gr = 0;
};

// Compares pixels with one other view. Pixel: of its picture.
template <typename Pixel>
class Comparison {
 public:
  // `base`: weight of a pixel whose colours fit.
  Comparison(const OtherView& other, const Grid<Pixel>& picture, double base)
      : sampler_(picture),
        right_(picture.width() - 1),
        bottom_(picture.height() - 1),
        inverse_scale_(1 / (kKappa * kKappa * other.sigma * other.sigma)),
        base_(base) {}

  // False where the colour half a pixel before or behind in the direction of motion is not seen, or nothing moves.
  [[nodiscard, gnu::always_inline]] bool Fit(const Seen& seen, const Colour& own, PixelFit& fit) const {
    const double squared = seen.dx * seen.dx + seen.dy * seen.dy;
    if (!(squared > 1e-18)) return false;
    const double motion = std::sqrt(squared);
    const DoublePair at{seen.x, seen.y};
    const DoublePair half_way = 0.5 / motion * DoublePair{seen.dx, seen.dy};
    const DoublePair before = at - half_way;
    const DoublePair after = at + half_way;
    if (!Inside(before) || !Inside(after)) return false;
    const ColourVector gradient = sampler_.At(after) - sampler_.At(before);
    const ColourVector difference = sampler_.At(at) - VectorOf(own);
    // Of each component both numbers in one register.
    const DoublePair y = __builtin_convertvector(__builtin_shufflevector(gradient, difference, 0, 4), DoublePair);
    const DoublePair cb = __builtin_convertvector(__builtin_shufflevector(gradient, difference, 1, 5), DoublePair);
    const DoublePair cr = __builtin_convertvector(__builtin_shufflevector(gradient, difference, 2, 6), DoublePair);
    const DoublePair squares = y * y + cb * cb + cr * cr;
    const double gg = squares[0];
    const double rr = squares[1];
    const double gr = y[0] * y[1] + cb[0] * cb[1] + cr[0] * cr[1];
    const double t = rr * inverse_scale_;
    const double robust = 1 / (1 + t);
    const double weight = base_ * robust * robust;
    fit.rho = t * robust;
    fit.gg = weight * squared * gg;
    fit.gr = weight * motion * gr;
    return true;
  }

 private:
  [[nodiscard]] bool Inside(DoublePair p) const { return p[0] >= 0 && p[1] >= 0 && p[0] <= right_ && p[1] <= bottom_; }

  Sampler<Pixel> sampler_;
  double right_, bottom_;
  double inverse_scale_;
  double base_;
};

// Adds the pixel (px, py) from the segment's centre.
void AddPixel(const PixelFit& pixel, double px, double py, Fit& fit) {
  fit.rho += pixel.rho;
  ++fit.pixels;
  auto& [h, rhs] = fit.equations;
  h[0] += pixel.gg * px * px;
  h[1] += pixel.gg * px * py;
  h[2] += pixel.gg * px;
  h[3] += pixel.gg * py * py;
  h[4] += pixel.gg * py;
  h[5] += pixel.gg;
  rhs[0] -= pixel.gr * px;
  rhs[1] -= pixel.gr * py;
  rhs[2] -= pixel.gr;
}

// The pixels of row y that speak, from left to right.
void FindSpeaking(const FreePixels& free, int y, int step, std::vector<int>& speaking) {
  speaking.clear();
  for (const PixelRun& run : free.Row(y))
    for (int x = run.left + (run.left + y) % step; x < run.right; x += step) speaking.push_back(x);
}

// By the number of the segment among those that are free. `picture`: the other view's. Piece by piece of a row, each
// step for all its pixels: what one pixel waits for (a division, a root, a value of the map) is of no concern to the
// next.
template <typename Pixel>
std::vector<Fit> FitsAgainst(const OtherView& other, const Grid<Pixel>& picture, const PictureColours& own,
                             const RefinedView& refined, const FreePixels& free, const InverseDepthMap& map,
                             std::span<const PixelPosition> centers, bool blurred, const std::stop_token& stop) {
  constexpr std::size_t kPiece = 64;  // pixels
  std::vector<Fit> fits(free.num_segments());
  const Sampling sampling = blurred ? kSmoothed : kSharp;
  const int share = sampling.row_step * sampling.column_step;
  const double base = share / (other.sigma * other.sigma * (blurred ? kBlurArea : 1));
  const Sight sight(*other.pair, *other.map);
  const Comparison<Pixel> comparison(other, picture, base);
  std::array<SeenPixel, kPiece> seen_pixels{};
  std::array<PixelFit, kPiece> pixel_fits{};
  std::vector<int> speaking;
  for (int y = 0; y < own.height() && !stop.stop_requested(); y += sampling.row_step) {
    FindSpeaking(free, y, sampling.column_step, speaking);
    for (std::size_t first = 0; first < speaking.size(); first += kPiece) {
      std::size_t num_seen = 0;
      for (const int x : std::span(speaking).subspan(first, std::min(kPiece, speaking.size() - first))) {
        if (const auto seen = sight.Of(x, y, map(x, y)))
          seen_pixels[num_seen++] = {.x = x, .segment = refined.plane_of_pixel(x, y), .seen = *seen};
      }
      std::size_t num_fits = 0;
      for (const SeenPixel& pixel : std::span(seen_pixels).first(num_seen)) {
        PixelFit& fit = pixel_fits[num_fits];
        fit.x = pixel.x;
        fit.segment = pixel.segment;
        if (comparison.Fit(pixel.seen, own(pixel.x, y), fit)) ++num_fits;
      }
      for (const PixelFit& fit : std::span(pixel_fits).first(num_fits)) {
        const PixelPosition& center = centers[fit.segment];
        AddPixel(fit, fit.x - center.x, y - center.y, fits[free.NumberOf(fit.segment)]);
      }
    }
  }
  return fits;
}

}  // namespace

std::vector<NormalEquations> DataTerm(const PictureColours& own, const RefinedView& refined, const FreePixels& free,
                                      const InverseDepthMap& map, std::span<const PixelPosition> centers,
                                      std::span<const OtherView> others, bool blurred, const std::stop_token& stop,
                                      int threads) {
  std::vector<std::vector<Fit>> fits(others.size());
  ParallelFor(others.size(), threads, [&](std::size_t i) {
    fits[i] = others[i].colour.With([&](const auto& picture) {
      return FitsAgainst(others[i], picture, own, refined, free, map, centers, blurred, stop);
    });
  });
  std::vector<NormalEquations> result(centers.size());
  ParallelForPieces(centers.size(), kSegmentsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    for (auto s = static_cast<PlaneIndex>(begin); s < end; ++s) {
      if (refined.kept[s] != 0) continue;
      const std::size_t number = free.NumberOf(s);
      double best = 1;
      for (const auto& view : fits)
        if (view[number].pixels > 0) best = std::min(best, view[number].rho / view[number].pixels);
      for (const auto& view : fits) {
        const Fit& fit = view[number];
        if (fit.pixels == 0) continue;
        const double ratio = (best + kMisfitFloor) / (fit.rho / fit.pixels + kMisfitFloor);
        for (std::size_t i = 0; i < 6; ++i) result[s].h[i] += ratio * ratio * fit.equations.h[i];
        for (std::size_t i = 0; i < 3; ++i) result[s].rhs[i] += ratio * ratio * fit.equations.rhs[i];
      }
    }
  });
  return result;
}

void AddAgreement(const RefinedView& refined, std::span<const PixelPosition> centers, std::span<const OtherView> others,
                  std::vector<NormalEquations>& equations, int threads) {
  const auto add = [&](const OtherView& other, std::size_t begin, std::size_t end) {
    const InverseDepthMap& there = *other.map;
    const Sight sight(*other.pair, there);
    for (std::size_t s = begin; s < end; ++s) {
      if (refined.kept[s] != 0) continue;
      const double u = refined.planes[s].At(centers[s].x, centers[s].y);
      const auto seen = sight.Of(centers[s].x, centers[s].y, u);
      if (!seen || !(seen->u_in_other > 0)) continue;
      const int x = std::min(static_cast<int>(seen->x), there.width() - 2);
      const int y = std::min(static_cast<int>(seen->y), there.height() - 2);
      const auto [low, high] = std::minmax({there(x, y), there(x + 1, y), there(x, y + 1), there(x + 1, y + 1)});
      if (high - low > kAgreementScale) continue;
      const double fx = seen->x - x;
      const double fy = seen->y - y;
      const double value = (1 - fy) * ((1 - fx) * there(x, y) + fx * there(x + 1, y)) +
                           fy * ((1 - fx) * there(x, y + 1) + fx * there(x + 1, y + 1));
      const double change = value * u / seen->u_in_other - u;  // u and u' of a point are in one ratio
      const double t = change / kAgreementScale;
      const double weight = kAgreement / ((1 + t * t) * (1 + t * t));
      equations[s].h[5] += weight;
      equations[s].rhs[2] += weight * change;
    }
  };
  ParallelForPieces(centers.size(), kSegmentsAtOnce, threads, [&](std::size_t begin, std::size_t end) {
    for (const OtherView& other : others) add(other, begin, end);
  });
}

}  // namespace depthfarm
