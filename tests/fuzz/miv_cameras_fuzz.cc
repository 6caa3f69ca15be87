#include "common/calibration/miv.h"
#include "tests/fuzz/calibration_round_trip.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  fuzz::RequireSequenceOf(ParseMivCameras(fuzz::Text(data, size), "miv.json"));
  return 0;
}
