#include "common/job/artifact_versions.h"
#include "tests/fuzz/fuzz_target.h"
#include "worker/refinement/refined_view_codec.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  fuzz::RequireArtifactRoundTrip({.magic = "DFRV", .version = kRefinedViewVersion}, fuzz::Text(data, size),
                                 DecodeRefinedView, EncodeRefinedView);
  return 0;
}
