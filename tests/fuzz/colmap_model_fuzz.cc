#include "common/calibration/colmap_model.h"
#include "common/calibration/robust_range.h"
#include "tests/fuzz/calibration_round_trip.h"

namespace {

// A part of so many bytes, at most, as the number before it says.
std::string_view TakePart(std::string_view& rest) {
  const unsigned low = depthfarm::fuzz::TakeByte(rest);
  const unsigned high = depthfarm::fuzz::TakeByte(rest);
  const std::string_view part = rest.substr(0, low | high << 8);
  rest.remove_prefix(part.size());
  return part;
}

}  // namespace

// A byte that is odd for a binary model; cameras and images with their lengths before them, 16 bits; points.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  std::string_view rest = fuzz::Text(data, size);
  ColmapFiles files;
  files.binary = fuzz::TakeByte(rest) % 2 != 0;
  files.cameras = {"cameras", TakePart(rest)};
  files.images = {"images", TakePart(rest)};
  if (!rest.empty()) files.points = ColmapFile{"points3D", rest};
  const Result<ColmapModel> model = ParseColmapModel(files);
  if (!model.ok()) {
    fuzz::RequireSequenceOf(model.status());
    return 0;
  }
  fuzz::RequireSequenceOf(model->calibration);
  fuzz::Require(model->depths.size() == model->calibration.cameras.size(), "every camera has its depths");
  for (const std::vector<float>& depths : model->depths) {
    const Result<DepthRange> range = RobustRange(depths);
    fuzz::Require(!range.ok() || (range->z_near > 0 && range->z_near < range->z_far), "a range is one");
  }
  return 0;
}
