#ifndef DEPTHFARM_WORKER_REFINEMENT_SIGHT_KERNELS_H_
#define DEPTHFARM_WORKER_REFINEMENT_SIGHT_KERNELS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "common/image/picture.h"
#include "worker/refinement/other_view.h"

namespace depthfarm {

// The loops that look for pixels of a view in another one, on vectors as wide as the processor has (Highway chooses at
// run time). They give the same bits on all, those of Sight and ColourFit: floating point is one operation a step on
// each lane, in the same order. One step for all pixels of a list comes before the next, so that what one pixel waits
// for (a division, a root, a value of the map) is of no concern to another.

// At most this many pixels at a time: what is known of them stays in the nearest cache. A multiple of the lanes.
inline constexpr std::size_t kListPixels = 64;

// One value for each pixel of a list. What is behind the last pixel has no meaning.
template <typename T>
struct alignas(64) ListOf : std::array<T, kListPixels> {};

// Pixels of a view and the u at which they are looked for.
struct PixelList {
  std::size_t count = 0;  // at most kListPixels
  ListOf<std::int32_t> x{};
  ListOf<std::int32_t> y{};
  ListOf<double> u{};
  // Of the view's picture: these where the other view's is sharp, else those.
  ListOf<Ycbcr> sharp{};
  ListOf<FineYcbcr> smoothed{};

  // Adds (x, y) of the view's picture `own`, at `at_u`.
  void Add(const Grid<Ycbcr>& own, int at_x, int at_y, double at_u) { AddTo(sharp, own, at_x, at_y, at_u); }
  void Add(const Grid<FineYcbcr>& own, int at_x, int at_y, double at_u) { AddTo(smoothed, own, at_x, at_y, at_u); }

 private:
  template <typename Pixel>
  void AddTo(ListOf<Pixel>& colours, const Grid<Pixel>& own, int at_x, int at_y, double at_u) {
    x[count] = at_x;
    y[count] = at_y;
    u[count] = at_u;
    colours[count] = own(at_x, at_y);
    ++count;
  }
};

// What the misfit of each pixel of a list says of its u: weight g (g du + r), summed over the components. All 0 where
// the other view does not see the pixel, or not the colour half a pixel before or behind in the direction of motion, or
// nothing moves.
struct PixelFits {
  ListOf<double> fits{};  // 1, or 0 as said above
  ListOf<double> rho{};
  ListOf<double> gg{};
  ListOf<double> gr{};
};

// `base`: weight of a pixel whose colours fit. The list may be filled up behind its last pixel.
void FitColours(const OtherView& other, double base, PixelList& list, PixelFits& result);

inline constexpr double kNotSeen = -1;

// Squared distance of the colours of each pixel; kNotSeen where the other view does not see it.
void SquaredDistances(const OtherView& other, PixelList& list, ListOf<double>& result);

// ColourFit::Misfit of each pixel; kNotSeen where there is none.
void Misfits(const OtherView& other, PixelList& list, ListOf<double>& result);

// ColourFit::MisfitInFreeSpace of each pixel; kNotSeen where there is none.
void MisfitsInFreeSpace(const OtherView& other, PixelList& list, ListOf<double>& result);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_SIGHT_KERNELS_H_
