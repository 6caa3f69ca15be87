#include "common/calibration/ftv.h"
#include "tests/fuzz/calibration_round_trip.h"

// The first byte says what the rest means.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  std::string_view text = fuzz::Text(data, size);
  const unsigned choice = fuzz::TakeByte(text);
  const FtvConvention convention{.pose = static_cast<FtvConvention::Pose>(choice / 2 % 3),
                                 .scene_behind = choice % 2 != 0};
  fuzz::RequireSequenceOf(ParseFtvCameras(text, "cam.txt", fuzz::kSize, convention));
  return 0;
}
