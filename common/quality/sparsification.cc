#include "common/quality/sparsification.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/quality/pixel_error.h"

namespace depthfarm {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kErrorsPerPx = 256;
constexpr int kSteps = 100;   // of the curves
constexpr int kClasses = 20;  // of confidence

double Percent(double part, double whole) { return whole > 0 ? 100 * part / whole : kNaN; }

template <typename Curve>
double MeanOverSteps(const Curve& curve) {
  double sum = 0;
  for (int step = 1; step <= kSteps; ++step) sum += curve(static_cast<double>(step) / kSteps);
  return sum / kSteps;
}

}  // namespace

Sparsification::Sparsification()
    : by_confidence_(kCodes), by_error_(static_cast<std::size_t>(kMostPx) * kErrorsPerPx + 1) {}

void Sparsification::Add(std::uint16_t confidence, double px) {
  const double error = std::min(px, kMostPx);
  const auto add = [&](Bin& bin) {
    ++bin.pixels;
    bin.wrong += px > kWrongPx ? 1 : 0;
    bin.px_sum += error;
  };
  add(by_confidence_[static_cast<std::size_t>(kCodes - 1 - confidence)]);
  add(by_error_[static_cast<std::size_t>(error * kErrorsPerPx)]);
  ++pixels_;
}

void Sparsification::Add(const Sparsification& other) {
  const auto add = [](const std::vector<Bin>& from, std::vector<Bin>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i].pixels += from[i].pixels;
      to[i].wrong += from[i].wrong;
      to[i].px_sum += from[i].px_sum;
    }
  };
  add(other.by_confidence_, by_confidence_);
  add(other.by_error_, by_error_);
  pixels_ += other.pixels_;
}

Sparsification::Mean Sparsification::Front(const std::vector<Bin>& bins, double kept) const {
  const double wanted = kept * static_cast<double>(pixels_);
  double taken = 0;
  double wrong = 0;
  double px_sum = 0;
  for (const Bin& bin : bins) {
    if (bin.pixels == 0) continue;
    const double share = std::min(1.0, (wanted - taken) / static_cast<double>(bin.pixels));
    if (share <= 0) break;
    taken += share * static_cast<double>(bin.pixels);
    wrong += share * static_cast<double>(bin.wrong);
    px_sum += share * bin.px_sum;
  }
  return {Percent(wrong, taken), taken > 0 ? px_sum / taken : kNaN};
}

double Sparsification::WrongPercent(double kept) const { return Front(by_confidence_, kept).wrong_percent; }
double Sparsification::MeanPx(double kept) const { return Front(by_confidence_, kept).px; }
double Sparsification::BestWrongPercent(double kept) const { return Front(by_error_, kept).wrong_percent; }
double Sparsification::BestMeanPx(double kept) const { return Front(by_error_, kept).px; }

double Sparsification::AuseWrongPercent() const {
  return MeanOverSteps([&](double kept) { return WrongPercent(kept) - BestWrongPercent(kept); });
}

double Sparsification::AusePx() const {
  return MeanOverSteps([&](double kept) { return MeanPx(kept) - BestMeanPx(kept); });
}

double Sparsification::CalibrationErrorPercent() const {
  struct Class {
    double pixels = 0;
    double right = 0;
    double claimed = 0;
  };
  std::array<Class, kClasses> classes = {};
  for (std::size_t i = 0; i < by_confidence_.size(); ++i) {
    const Bin& bin = by_confidence_[i];
    const double probability = static_cast<double>(kCodes - 1 - static_cast<int>(i)) / (kCodes - 1);
    Class& of = classes[static_cast<std::size_t>(std::min(probability * kClasses, kClasses - 1.0))];
    of.pixels += static_cast<double>(bin.pixels);
    of.right += static_cast<double>(bin.pixels - bin.wrong);
    of.claimed += probability * static_cast<double>(bin.pixels);
  }
  double sum = 0;
  for (const Class& of : classes) sum += std::abs(of.right - of.claimed);
  return Percent(sum, static_cast<double>(pixels_));
}

Status AddConfidence(const DepthErrorInput& input, const Grid<std::uint16_t>& confidence, Sparsification& sum) {
  DEPTHFARM_RETURN_IF_ERROR(CheckErrorInput(input));
  DEPTHFARM_RETURN_IF_ERROR(CheckGridSize(&confidence, input.camera, "confidence map"));
  const PixelErrors errors(input);
  for (int y = 0; y < input.camera.height; ++y) {
    for (int x = 0; x < input.camera.width; ++x) {
      if (!errors.Known(x, y)) continue;
      const PixelError error = errors.At(x, y);
      if (error.estimated) sum.Add(confidence(x, y), error.px);
    }
  }
  return {};
}

}  // namespace depthfarm
