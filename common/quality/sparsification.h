#ifndef DEPTHFARM_COMMON_QUALITY_SPARSIFICATION_H_
#define DEPTHFARM_COMMON_QUALITY_SPARSIFICATION_H_

#include <cstdint>
#include <vector>

#include "common/base/status.h"
#include "common/image/grid.h"
#include "common/quality/depth_error.h"

namespace depthfarm {

// How well confidence tells right depth from wrong: pixels are removed, the least confident first, and what is left is
// measured. Histograms, so that frames and views add up.
class Sparsification {
 public:
  static constexpr double kWrongPx = 1;  // depth is wrong from here on, as in the bad-1-px figures
  static constexpr double kMostPx = 64;  // larger errors count as that
  static constexpr int kCodes = 65536;   // of confidence: probability times 65535

  Sparsification();

  // A pixel whose depth is off by `px`.
  void Add(std::uint16_t confidence, double px);
  void Add(const Sparsification& other);

  // Share of wrong pixels, %, and mean error, px, of the `kept` (0 to 1) most confident pixels; pixels of equal
  // confidence count alike. NaN without pixels.
  [[nodiscard]] double WrongPercent(double kept) const;
  [[nodiscard]] double MeanPx(double kept) const;
  // The same with the best possible order, by the errors themselves.
  [[nodiscard]] double BestWrongPercent(double kept) const;
  [[nodiscard]] double BestMeanPx(double kept) const;
  // Area between the curve and the best one over `kept` from 0.01 to 1 (AUSE): 0 is perfect.
  [[nodiscard]] double AuseWrongPercent() const;
  [[nodiscard]] double AusePx() const;
  // Expected calibration error, %: by how much the share of right pixels differs from what confidence says, over
  // pixels in 20 classes of confidence.
  [[nodiscard]] double CalibrationErrorPercent() const;
  [[nodiscard]] std::int64_t pixels() const { return pixels_; }

 private:
  struct Bin {
    std::int64_t pixels = 0;
    std::int64_t wrong = 0;
    double px_sum = 0;
  };
  struct Mean {
    double wrong_percent = 0;
    double px = 0;
  };
  // Over the `kept` share of all pixels, those of the first bins first.
  [[nodiscard]] Mean Front(const std::vector<Bin>& bins, double kept) const;

  std::vector<Bin> by_confidence_;  // the most confident first
  std::vector<Bin> by_error_;       // the least first
  std::int64_t pixels_ = 0;
};

// Adds the pixels of known truth that have an estimate. `confidence` has the camera's size. Errors: as
// MeasureDepthError.
[[nodiscard]] Status AddConfidence(const DepthErrorInput& input, const Grid<std::uint16_t>& confidence,
                                   Sparsification& sum);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_QUALITY_SPARSIFICATION_H_
