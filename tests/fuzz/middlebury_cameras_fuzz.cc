#include "common/calibration/middlebury.h"
#include "tests/fuzz/calibration_round_trip.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  fuzz::RequireSequenceOf(ParseMiddleburyCameras(fuzz::Text(data, size), "a_par.txt", fuzz::kSize));
  return 0;
}
