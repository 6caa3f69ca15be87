#include <algorithm>
#include <cmath>

#include "common/media/guide_files.h"
#include "common/media/pfm.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  const std::string_view bytes = fuzz::Text(data, size);
  const auto values = DecodePfm(bytes);
  for (const auto holds : {PriorFormat::Holds::kDepth, PriorFormat::Holds::kInverseDepth,
                           PriorFormat::Holds::kRelativeDepth, PriorFormat::Holds::kCodes}) {
    const PriorFormat format = {.holds = holds, .unit = 0.001, .z_near = 1, .z_far = 2};
    const auto prior = DecodePrior(bytes, format, 12, 9);
    if (!prior.ok()) continue;
    fuzz::Require(std::all_of(prior->values().begin(), prior->values().end(),
                              [](float value) { return std::isfinite(value) && value >= 0; }),
                  "inverse depths are finite and not negative");
  }
  if (!values.ok()) return 0;
  ++fuzz::accepted;
  // By bits: NaN is not itself.
  const std::string encoded = EncodePfm(*values);
  fuzz::Require(EncodePfm(DecodePfm(encoded).value()) == encoded, "values come back to the bit");
  return 0;
}
