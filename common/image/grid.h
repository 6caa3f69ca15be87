#ifndef DEPTHFARM_COMMON_IMAGE_GRID_H_
#define DEPTHFARM_COMMON_IMAGE_GRID_H_

#include <cstddef>
#include <cstdint>
#include <vector>

namespace depthfarm {

// A picture of T: height rows of width values, row after row without padding, value semantics (a copy shares nothing,
// unlike cv::Mat: pure code and its caches rely on that). Positions are (x right, y down), (0, 0) the top-left pixel.
// Not thread-safe for writers; any number of readers.
template <typename T>
class Grid {
 public:
  Grid() = default;
  Grid(int width, int height, T fill = T{})
      : width_(width),
        height_(height),
        values_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] std::size_t size() const { return values_.size(); }
  [[nodiscard]] bool empty() const { return values_.empty(); }
  [[nodiscard]] bool Contains(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

  [[nodiscard]] std::size_t Index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  [[nodiscard]] T& operator()(int x, int y) { return values_[Index(x, y)]; }
  [[nodiscard]] const T& operator()(int x, int y) const { return values_[Index(x, y)]; }
  [[nodiscard]] T* row(int y) { return values_.data() + Index(0, y); }
  [[nodiscard]] const T* row(int y) const { return values_.data() + Index(0, y); }
  [[nodiscard]] std::vector<T>& values() { return values_; }
  [[nodiscard]] const std::vector<T>& values() const { return values_; }

  bool operator==(const Grid&) const = default;

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<T> values_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_IMAGE_GRID_H_
