#include "worker/segmentation/view_prior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <span>

#include "common/geometry/symmetric_solve.h"

namespace depthfarm {
namespace {

constexpr std::size_t kOutliers = 1000;  // one value of so many may be anything at either end
constexpr int kRounds = 4;
constexpr double kSpreads = 2;         // median deviations that count half
constexpr double kLeastSpread = 1e-4;  // of the value: less is rounding
constexpr double kRidge = 0.01;        // towards no slope, of the weights, per pixel squared

struct Sample {
  double x = 0;  // from the segment's centre
  double y = 0;
  double value = 0;
  double weight = 1;
};

struct Range {
  float lowest = 0;
  float highest = 0;
};

// Of the values that are known, without the few that are far from all others: a pixel at almost no depth would leave
// the rest one code. nullopt: none is known.
std::optional<Range> PlausibleRange(const Grid<float>& values) {
  std::vector<float> known;
  std::copy_if(values.values().begin(), values.values().end(), std::back_inserter(known),
               [](float value) { return value > 0 && value < kMostPriorValue; });
  if (known.empty()) return std::nullopt;
  const auto at = [&](std::size_t rank) {
    const auto element = known.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(known.begin(), element, known.end());
    return *element;
  };
  const std::size_t few = known.size() / kOutliers;
  const float low = at(few);
  const float high = at(known.size() - 1 - few);
  const float margin = high - low;
  Range range{.lowest = high, .highest = low};
  for (const float value : known) {
    if (value < low - margin || value > high + margin) continue;
    range.lowest = std::min(range.lowest, value);
    range.highest = std::max(range.highest, value);
  }
  return range;
}

double Median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Plane through the centre: slopes and the value there.
std::array<double, 3> FitPlane(std::span<const Sample> samples, std::vector<double>& scratch) {
  scratch.clear();
  for (const Sample& sample : samples) scratch.push_back(sample.value);
  std::array<double, 3> plane{0, 0, Median(scratch)};
  for (int round = 0; round < kRounds; ++round) {
    const auto residual = [&](const Sample& s) { return s.value - (plane[0] * s.x + plane[1] * s.y + plane[2]); };
    scratch.clear();
    for (const Sample& sample : samples) scratch.push_back(std::abs(residual(sample)));
    const double scale = kSpreads * std::max(Median(scratch), kLeastSpread * std::abs(plane[2]));
    if (!(scale > 0)) return plane;
    std::array<double, 6> h{};
    std::array<double, 3> r{};
    for (const Sample& s : samples) {
      const double t = residual(s) / scale;
      const double w = s.weight / ((1 + t * t) * (1 + t * t));
      h[0] += w * (s.x * s.x + kRidge);
      h[1] += w * s.x * s.y;
      h[2] += w * s.x;
      h[3] += w * (s.y * s.y + kRidge);
      h[4] += w * s.y;
      h[5] += w;
      r[0] += w * s.x * s.value;
      r[1] += w * s.y * s.value;
      r[2] += w * s.value;
    }
    if (!SolveSymmetric(h, r, plane)) return plane;
  }
  return plane;
}

}  // namespace

ViewPrior MakePrior(const Grid<float>& values, const Grid<float>& confidence) {
  constexpr double kSteps = 65534;
  ViewPrior prior;
  prior.codes = Grid<std::uint16_t>(values.width(), values.height());
  const std::optional<Range> range = PlausibleRange(values);
  if (range) {
    prior.lowest = range->lowest;
    prior.step = static_cast<float>((static_cast<double>(range->highest) - range->lowest) / kSteps);
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double value = values.values()[i];
      if (!(value >= range->lowest && value <= range->highest)) continue;
      const double steps = prior.step > 0 ? (value - prior.lowest) / prior.step + 0.5 : 0;
      prior.codes.values()[i] = static_cast<std::uint16_t>(1 + std::clamp(std::floor(steps), 0.0, kSteps));
    }
  }
  if (confidence.size() == 0) return prior;
  prior.confidence = Grid<std::uint8_t>(confidence.width(), confidence.height());
  for (std::size_t i = 0; i < confidence.size(); ++i) {
    const double share = confidence.values()[i];
    prior.confidence.values()[i] = static_cast<std::uint8_t>(std::lround(std::clamp(share, 0.0, 1.0) * 255));
  }
  return prior;
}

std::vector<SegmentPrior> DescribePrior(const SegmentMap& segments, const ViewPrior& prior) {
  const std::size_t num_segments = segments.centers.size();
  std::vector<std::vector<Sample>> samples(num_segments);
  std::vector<int> pixels(num_segments);
  const Grid<SegmentIndex>& labels = segments.labels;
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      const SegmentIndex s = labels(x, y);
      ++pixels[s];
      const double weight = prior.confidence.size() == 0 ? 1.0 : prior.confidence(x, y) / 255.0;
      const std::optional<double> value = prior.At(x, y);
      if (!value || !(weight > 0)) continue;
      samples[s].push_back({static_cast<double>(x - segments.centers[s].x),
                            static_cast<double>(y - segments.centers[s].y), *value, weight});
    }
  }
  std::vector<SegmentPrior> priors(num_segments);
  std::vector<double> scratch;
  for (std::size_t s = 0; s < num_segments; ++s) {
    if (samples[s].empty()) continue;
    const std::array<double, 3> plane = FitPlane(samples[s], scratch);
    double weight = 0;
    for (const Sample& sample : samples[s]) weight += sample.weight;
    const auto [cx, cy] = segments.centers[s];
    priors[s] = {.a = static_cast<float>(plane[0]),
                 .b = static_cast<float>(plane[1]),
                 .c = static_cast<float>(plane[2] - plane[0] * cx - plane[1] * cy),
                 .weight = static_cast<float>(weight / pixels[s])};
  }
  return priors;
}

}  // namespace depthfarm
