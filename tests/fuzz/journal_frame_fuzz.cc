#include "coordinator/journal/frame_codec.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  const std::string_view bytes = fuzz::Text(data, size);
  fuzz::RequireRoundTrip(bytes, DecodeFrame, EncodeFrame);
  return 0;
}
