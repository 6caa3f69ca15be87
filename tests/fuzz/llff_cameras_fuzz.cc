#include "common/calibration/llff.h"
#include "tests/fuzz/calibration_round_trip.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  const std::string_view bytes = fuzz::Text(data, size);
  fuzz::RequireSequenceOf(ParseLlffCameras(bytes, "poses_bounds.npy", {}));
  fuzz::RequireSequenceOf(ParseLlffCameras(bytes, "poses_bounds.npy", {"left.png", "right.png"}));
  return 0;
}
