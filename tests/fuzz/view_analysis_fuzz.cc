#include "common/job/artifact_versions.h"
#include "tests/fuzz/fuzz_target.h"
#include "worker/segmentation/analysis_codec.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  fuzz::RequireArtifactRoundTrip({.magic = "DFVA", .version = kViewAnalysisVersion}, fuzz::Text(data, size),
                                 DecodeAnalysis, EncodeAnalysis);
  return 0;
}
