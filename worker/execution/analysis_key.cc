#include "worker/execution/analysis_key.h"

#include <bit>
#include <string>

#include "common/digest/sha256.h"
#include "common/job/artifact_versions.h"

namespace depthfarm {

ArtifactKey AnalysisKey(const JobView& view, const EstimationParams& params, const AnalysisDigests& digests) {
  // One "name value" line each: no two lists of values give the same text.
  std::string text = "analyse\n";
  const auto add = [&text](const char* name, std::uint64_t value) {
    text += std::string(name) + " " + std::to_string(value) + "\n";
  };
  add("algorithm_version", kAlgorithmVersion);
  add("format_version", kViewAnalysisVersion);
  add("kind", static_cast<std::uint64_t>(view.format.kind));
  add("bits", static_cast<std::uint64_t>(view.format.bits));
  add("full_range", view.format.full_range ? 1 : 0);
  add("bt709", view.format.bt709 ? 1 : 0);
  add("source_width", static_cast<std::uint64_t>(view.source_width));
  add("source_height", static_cast<std::uint64_t>(view.source_height));
  add("downscale", static_cast<std::uint64_t>(params.downscale));
  add("segments", static_cast<std::uint64_t>(view.segments));
  add("compactness_bits", std::bit_cast<std::uint64_t>(params.snic_compactness));
  text += "picture " + Hex(digests.picture) + "\n";
  if (digests.mask) text += "mask " + Hex(*digests.mask) + "\n";
  if (digests.prior) {
    text += "prior " + Hex(*digests.prior) + "\n";
    add("prior_holds", static_cast<std::uint64_t>(view.prior.holds));
    for (const double number : {view.prior.unit, view.prior.z_near, view.prior.z_far})
      add("prior_number", std::bit_cast<std::uint64_t>(number));
    if (digests.prior_confidence) text += "prior_confidence " + Hex(*digests.prior_confidence) + "\n";
  }
  if (digests.before) {
    text += "before " + Hex(*digests.before) + "\n";
    add("p_threshold", static_cast<std::uint64_t>(params.p_threshold));
  }
  return Sha256(text);
}

}  // namespace depthfarm
