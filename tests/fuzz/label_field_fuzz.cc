#include "tests/fuzz/fuzz_target.h"
#include "worker/estimation/label_field_codec.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  fuzz::RequireArtifactRoundTrip({.magic = "DFLF", .version = 1}, fuzz::Text(data, size), DecodeLabelField,
                                 EncodeLabelField);
  return 0;
}
