#include "worker/refinement/free_pixels.h"

#include <algorithm>

#include "common/base/parallel.h"

namespace depthfarm {
namespace {

// Appends the runs of `planes` whose `free` is 1.
void AppendRuns(std::span<const PlaneIndex> planes, std::span<const std::uint8_t> free, std::vector<PixelRun>& runs) {
  std::uint8_t before = 0;
  for (std::size_t x = 0; x < planes.size(); ++x) {
    const std::uint8_t here = free[planes[x]];
    if (here == before) continue;
    before = here;
    if (here != 0) {
      runs.push_back({.left = static_cast<int>(x), .right = static_cast<int>(planes.size())});
    } else {
      runs.back().right = static_cast<int>(x);
    }
  }
}

}  // namespace

FreePixels::FreePixels(const RefinedView& view) {
  const std::size_t segments = view.num_segments();
  number_of_.reserve(segments);
  for (const std::uint8_t kept : view.kept) {
    number_of_.push_back(static_cast<std::uint32_t>(num_segments_));
    num_segments_ += kept == 0 ? 1 : 0;
  }
  const int width = view.plane_of_pixel.width();
  const int height = view.plane_of_pixel.height();
  first_.reserve(static_cast<std::size_t>(height) + 1);
  const bool all = num_segments_ == view.planes.size();
  std::vector<std::uint8_t> free(view.planes.size());
  for (PlaneIndex plane = 0; plane < free.size(); ++plane) free[plane] = view.IsFree(plane) ? 1 : 0;
  for (int y = 0; y < height; ++y) {
    first_.push_back(runs_.size());
    if (all) {
      runs_.push_back({.left = 0, .right = width});
    } else {
      AppendRuns({view.plane_of_pixel.row(y), static_cast<std::size_t>(width)}, free, runs_);
    }
  }
  first_.push_back(runs_.size());
}

void UpdateMap(const RefinedView& view, const FreePixels& free, InverseDepthMap& map, int threads) {
  constexpr std::size_t kRowsAtOnce = 32;
  const auto update = [&](std::size_t begin, std::size_t end) {
    for (auto y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (const PixelRun& run : free.Row(y))
        for (int x = run.left; x < run.right; ++x) map(x, y) = static_cast<float>(view.At(x, y));
    }
  };
  ParallelForPieces(static_cast<std::size_t>(map.height()), kRowsAtOnce, threads, update);
}

}  // namespace depthfarm
