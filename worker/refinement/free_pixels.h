#ifndef DEPTHFARM_WORKER_REFINEMENT_FREE_PIXELS_H_
#define DEPTHFARM_WORKER_REFINEMENT_FREE_PIXELS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "worker/refinement/plane_field.h"

namespace depthfarm {

// Neighbours of a row: [left, right).
struct PixelRun {
  int left = 0;
  int right = 0;
  bool operator==(const PixelRun&) const = default;
};

// The pixels that the refinement may still move (RefinedView::IsFree) and the segments that are not kept: in a P frame
// a fifth of them, so that what is asked for in each of several loops is found once. Right as long as neither the
// planes of pixels nor what is kept change.
class FreePixels {
 public:
  explicit FreePixels(const RefinedView& view);

  // Of row y, from left to right, none touching the next.
  [[nodiscard]] std::span<const PixelRun> Row(int y) const {
    const auto row = static_cast<std::size_t>(y);
    return std::span(runs_).subspan(first_[row], first_[row + 1] - first_[row]);
  }
  [[nodiscard]] int height() const { return static_cast<int>(first_.size()) - 1; }

  // Segments that are not kept: how many, and the number of each among them.
  [[nodiscard]] std::size_t num_segments() const { return num_segments_; }
  [[nodiscard]] std::size_t NumberOf(PlaneIndex segment) const { return number_of_[segment]; }

 private:
  std::vector<PixelRun> runs_;
  std::vector<std::size_t> first_;        // of each row, then their number
  std::vector<std::uint32_t> number_of_;  // by segment; of kept ones that of the next that is not
  std::size_t num_segments_ = 0;
};

// Sets the free pixels of `map` to what `view` has now; the others have not moved.
void UpdateMap(const RefinedView& view, const FreePixels& free, InverseDepthMap& map, int threads = 1);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_REFINEMENT_FREE_PIXELS_H_
