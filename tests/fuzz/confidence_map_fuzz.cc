#include "tests/fuzz/fuzz_target.h"
#include "worker/confidence/confidence_codec.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  fuzz::RequireArtifactRoundTrip({.magic = "DFCM", .version = 1}, fuzz::Text(data, size), DecodeConfidence,
                                 EncodeConfidence);
  return 0;
}
