#include "tests/fuzz/fuzz_target.h"
#include "worker/segmentation/analysis_codec.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  fuzz::RequireArtifactRoundTrip({.magic = "DFVA", .version = 2}, fuzz::Text(data, size), DecodeAnalysis,
                                 EncodeAnalysis);
  return 0;
}
