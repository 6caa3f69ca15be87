#include "common/geometry/camera_path.h"
#include "common/sequence/read_cameras.h"
#include "tests/fuzz/fuzz_target.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace depthfarm;
  const auto cameras = ParseCameras(fuzz::Text(data, size), "cameras.json");
  if (!cameras.ok()) return 0;
  ++fuzz::accepted;
  for (const Camera& camera : *cameras) fuzz::Require(ValidateCamera(camera).ok(), "cameras that are read are valid");
  const auto path = CameraPath::Create(*cameras);
  if (!path.ok()) return 0;
  for (const Camera& camera : path->Sample(5)) fuzz::Require(camera.width >= 1, "a camera on a path has a size");
  return 0;
}
