#include "common/calibration/msr.h"
#include "tests/fuzz/calibration_round_trip.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  fuzz::RequireSequenceOf(ParseMsrCameras(fuzz::Text(data, size), "calibParams.txt", fuzz::kSize));
  return 0;
}
