#include "common/job/estimation_params.h"

#include <cmath>
#include <set>
#include <sstream>

namespace depthfarm {
namespace {

template <typename T>
Status OutOfRange(const std::string& option, T value, const std::string& expected) {
  std::ostringstream text;
  text << option << " is " << value << ", expected " << expected;
  return InvalidArgument(text.str());
}

}  // namespace

Status EstimationParams::Validate() const {
  if (segments < 0 || segments > 4'000'000) return OutOfRange("segments", segments, "1 to 4000000, or auto");
  if (segment_pixels < 1 || segment_pixels > 10000) return OutOfRange("segment-pixels", segment_pixels, "1 to 10000");
  if (levels != 0 && (levels < 2 || levels > 65534)) return OutOfRange("levels", levels, "2 to 65534, or auto");
  const bool ranges_finite = std::isfinite(z_near) && std::isfinite(z_far);
  if (!ranges_finite || z_near < 0) return OutOfRange("z-near", z_near, "a finite number > 0");
  if (z_far < 0) return OutOfRange("z-far", z_far, "a finite number > z-near");
  if (z_near > 0 && z_far > 0 && z_near >= z_far) return OutOfRange("z-near", z_near, "less than z-far");
  if (!(smoothing >= 0) || smoothing > 100) return OutOfRange("smoothing", smoothing, "0 to 100");
  if (matching_window < 1 || matching_window > 15 || matching_window % 2 == 0) {
    return OutOfRange("matching-window", matching_window, "an odd number from 1 to 15");
  }
  if (!(matching_offset > 0) || matching_offset > 765)
    return OutOfRange("matching-offset", matching_offset, "> 0, at most 765");
  if (uniqueness < 0 || uniqueness > 99)
    return OutOfRange("uniqueness", uniqueness, "1 to 99 %, or 0: every match in full");
  if (!(snic_compactness > 0) || snic_compactness > 1000) {
    return OutOfRange("snic-compactness", snic_compactness, "> 0, at most 1000");
  }
  if (gop < 0 || gop > 1'000'000) return OutOfRange("gop", gop, "1 to 1000000, or all");
  if (p_threshold < 0 || p_threshold > 255) return OutOfRange("p-threshold", p_threshold, "0 to 255");
  if (i_threshold < 0 || i_threshold > 255) return OutOfRange("i-threshold", i_threshold, "0 to 255");
  if (level_blocks < 0 || level_blocks > 4096) return OutOfRange("level-blocks", level_blocks, "1 to 4096, or auto");
  if (levels > 0 && level_blocks > levels) {
    return OutOfRange("level-blocks", level_blocks, "at most the number of levels, " + std::to_string(levels));
  }
  if (max_sweeps < 0 || max_sweeps > 1000)
    return OutOfRange("sweeps", max_sweeps, "1 to 1000, or auto: until nothing changes");
  if (search == Search::kSparse && max_sweeps != 1) {
    return InvalidArgument("sweeps is " + (max_sweeps == 0 ? "auto" : std::to_string(max_sweeps)) +
                           ", expected 1 with the sparse search");
  }
  if (neighbours < 1 || neighbours > 16) return OutOfRange("neighbors", neighbours, "1 to 16");
  if (refine_rounds < 0 || refine_rounds > 100)
    return OutOfRange("refine", refine_rounds, "1 to 100 rounds, or 0: depth levels");
  if (choice_rounds < 0 || choice_rounds > 100) return OutOfRange("choice-rounds", choice_rounds, "0 to 100");
  if (compared < 1 || compared > kMostCompared) {
    return OutOfRange("compared", compared, "1 to " + std::to_string(kMostCompared));
  }
  if (!(holes >= 0) || holes >= 1)
    return OutOfRange("holes", holes, "0 to less than 1: the least confidence that is kept");
  if (assesses() && refine_rounds == 0) {
    return InvalidArgument(std::string(confidence ? "confidence" : "holes") +
                           " needs refined depth: leave out --refine 0 (--preset paper)");
  }
  if (!prior.empty() && refine_rounds == 0)
    return InvalidArgument("prior needs refined depth: leave out --refine 0 (--preset paper)");
  if (downscale != 1 && downscale != 2 && downscale != 4) return OutOfRange("downscale", downscale, "1, 2 or 4");
  if (first_frame < 0) return OutOfRange("frames: first", first_frame, ">= 0");
  if (end_frame != -1 && end_frame <= first_frame) {
    return OutOfRange("frames: end", end_frame, "more than the first, " + std::to_string(first_frame));
  }
  std::set<std::string> distinct;
  for (const std::string& view : views)
    if (!distinct.insert(view).second) return InvalidArgument("views names camera '" + view + "' twice");
  return {};
}

Result<EstimationParams> Preset(const std::string& name) {
  EstimationParams params;
  if (name == "default") return params;
  if (name == "paper") {
    params.levels = 250;
    params.level_blocks = 1;
    params.search = Search::kFull;
    params.max_sweeps = 0;
    params.uniqueness = 0;
    params.refine_rounds = 0;
    return params;
  }
  if (name == "best") {
    params.refine_rounds = 5;
    params.choice_rounds = 4;
    return params;
  }
  if (name == "fast") {
    params.segment_pixels = 30;
    params.refine_rounds = 3;
    params.compared = 3;
    return params;
  }
  return InvalidArgument("preset is '" + name + "', expected default, best, fast or paper");
}

}  // namespace depthfarm
