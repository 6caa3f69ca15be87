#ifndef DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_RATES_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_RATES_H_

#include <array>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/video/hevc_rate.h"
#include "worker/media_cli/evaluate_targets.h"
#include "worker/rendering/sequence_with_depth.h"

namespace depthfarm {

inline constexpr std::array<int, 4> kRateQps = {22, 27, 32, 37};
inline constexpr const char* kRateEncoder = "libx265 medium, first picture intra, no B pictures";

// A video's bits and quality, one entry per kRateQps.
struct RateCurve {
  std::string view;
  std::vector<HevcRate> rates;
};

struct RateReport {
  std::vector<RateCurve> virtual_views;  // one per target: 8 bits, BT.601, 16-235
  std::vector<RateCurve> depth;          // of all sources of targets: 10 bits, uniform in 1/z
};

struct RateComparison {
  std::string depth_dir;  // the anchor's
  RateReport anchor;
  // Bjøntegaard delta rate, in the order of the tested RateReport; NaN where the curves have no PSNR in common.
  std::vector<double> virtual_views_percent;
  std::vector<double> depth_percent;
};

// Mean of those that are numbers; NaN of none.
[[nodiscard]] double MeanPercent(const std::vector<double>& values);

// Encodes the targets' synthesised pictures and their sources' depth in all frames of `input`, odd sides cut by one
// pixel. Depth is coded over the range of `depth_range`'s depth.json, so that the bits of two folders are comparable.
// Errors  kInvalidArgument: pictures too small to encode, files that can't be read; kUnavailable: no encoder.
[[nodiscard]] Result<RateReport> MeasureRates(const SequenceWithDepth& input,
                                              const std::vector<EvaluateTarget>& targets,
                                              const SequenceWithDepth& depth_range);

// Both measured with equal targets.
[[nodiscard]] RateComparison Compare(const std::string& anchor_dir, const RateReport& anchor, const RateReport& tested);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_RATES_H_
