#include "worker/refinement/data_term.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "common/base/parallel.h"
#include "worker/refinement/sight_kernels.h"

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

// A pixel of a list: where it is from the centre of its segment, and what that one has.
struct Speaker {
  Fit* fit = nullptr;
  std::int32_t x = 0;
  std::int32_t y = 0;
};

// Adds what the i-th pixel of a list says.
void AddPixel(const PixelFits& pixels, std::size_t i, const Speaker& speaker) {
  const double px = speaker.x;
  const double py = speaker.y;
  const double gg = pixels.gg[i];
  const double gr = pixels.gr[i];
  speaker.fit->rho += pixels.rho[i];
  ++speaker.fit->pixels;
  auto& [h, rhs] = speaker.fit->equations;
  h[0] += gg * px * px;
  h[1] += gg * px * py;
  h[2] += gg * px;
  h[3] += gg * py * py;
  h[4] += gg * py;
  h[5] += gg;
  rhs[0] -= gr * px;
  rhs[1] -= gr * py;
  rhs[2] -= gr;
}

// By the number of the segment among those that are free. `own`: the view's picture.
template <typename Pixel>
std::vector<Fit> FitsAgainst(const OtherView& other, const Grid<Pixel>& own, const RefinedView& refined,
                             const FreePixels& free, const InverseDepthMap& map, std::span<const PixelPosition> centers,
                             bool blurred, const std::stop_token& stop) {
  std::vector<Fit> fits(free.num_segments());
  const Sampling sampling = blurred ? kSmoothed : kSharp;
  const int share = sampling.row_step * sampling.column_step;
  const double base = share / (other.sigma * other.sigma * (blurred ? kBlurArea : 1));
  PixelList list;
  std::array<Speaker, kListPixels> speakers;
  PixelFits pixels;
  const auto add_list = [&] {
    if (list.count == 0) return;
    FitColours(other, base, list, pixels);
    for (std::size_t i = 0; i < list.count; ++i)
      if (pixels.fits[i] != 0) AddPixel(pixels, i, speakers[i]);
    list.count = 0;
  };
  // Each segment is met for the first time somewhere, and not in the cache: memory is asked for it while the colours of
  // the list are compared.
  const auto add = [&](int x, int y) {
    const PlaneIndex segment = refined.plane_of_pixel(x, y);
    const PixelPosition& center = centers[segment];
    Fit* const fit = &fits[free.NumberOf(segment)];
    __builtin_prefetch(fit, 1);
    __builtin_prefetch(reinterpret_cast<const char*>(fit + 1) - 1, 1);
    speakers[list.count] = {fit, x - center.x, y - center.y};
    list.Add(own, x, y, map(x, y));
    if (list.count == kListPixels) add_list();
  };
  for (int y = 0; y < own.height() && !stop.stop_requested(); y += sampling.row_step) {
    for (const PixelRun& run : free.Row(y))
      for (int x = run.left + (run.left + y) % sampling.column_step; x < run.right; x += sampling.column_step)
        add(x, y);
  }
  add_list();
  return fits;
}

}  // namespace

std::vector<NormalEquations> DataTerm(const PictureColours& own, const RefinedView& refined, const FreePixels& free,
                                      const InverseDepthMap& map, std::span<const PixelPosition> centers,
                                      std::span<const OtherView> others, bool blurred, const std::stop_token& stop,
                                      int threads) {
  std::vector<std::vector<Fit>> fits(others.size());
  ParallelFor(others.size(), threads, [&](std::size_t i) {
    fits[i] = own.With([&](const auto& picture) {
      return FitsAgainst(others[i], picture, refined, free, map, centers, blurred, stop);
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
