#include "common/media/exr.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  const auto values = DecodeExr(fuzz::Text(data, size));
  if (!values.ok()) return 0;
  ++fuzz::accepted;
  // By bits: NaN is not itself.
  const std::string encoded = EncodeExr(*values).value();
  fuzz::Require(EncodeExr(DecodeExr(encoded).value()).value() == encoded, "values come back to the bit");
  return 0;
}
