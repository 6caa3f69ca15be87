#include "common/calibration/colmap_lens.h"

#include <algorithm>
#include <array>
#include <string>

namespace depthfarm {
namespace {

constexpr std::uint64_t kMostPixels = 1'000'000;  // fits an int; ValidateCamera has the bound

constexpr auto kLenses = std::to_array<ColmapLens>({
    {0, "SIMPLE_PINHOLE", 3, 1, true},
    {1, "PINHOLE", 4, 2, true},
    {2, "SIMPLE_RADIAL", 4, 1, true},
    {3, "RADIAL", 5, 1, true},
    {4, "OPENCV", 8, 2, true},
    {5, "OPENCV_FISHEYE", 8, 2, false},
    {6, "FULL_OPENCV", 12, 2, true},
    {7, "FOV", 5, 2, false},
    {8, "SIMPLE_RADIAL_FISHEYE", 4, 1, false},
    {9, "RADIAL_FISHEYE", 5, 1, false},
    {10, "THIN_PRISM_FISHEYE", 12, 2, false},
    {11, "RAD_TAN_THIN_PRISM_FISHEYE", 16, 2, false},
});

template <typename Matches>
const ColmapLens* Find(const Matches& matches) {
  const auto* found = std::ranges::find_if(kLenses, matches);
  return found == kLenses.end() ? nullptr : found;
}

}  // namespace

const ColmapLens* ColmapLensOf(std::uint32_t id) {
  return Find([id](const ColmapLens& lens) { return lens.id == id; });
}

const ColmapLens* ColmapLensOf(std::string_view name) {
  return Find([name](const ColmapLens& lens) { return lens.name == name; });
}

Result<Camera> CameraOf(const ColmapCamera& camera) {
  const ColmapLens& lens = *camera.lens;
  const auto focals = static_cast<std::size_t>(lens.num_focals);
  const bool distorts = std::any_of(camera.params.begin() + static_cast<std::ptrdiff_t>(focals + 2),
                                    camera.params.end(), [](double number) { return number != 0; });
  if (!lens.perspective || distorts) {
    return InvalidArgument("has the lens " + std::string(lens.name) +
                           " with distortion, which is not supported: run 'colmap image_undistorter' and import the "
                           "model and the images that it writes");
  }
  Camera result;
  result.width = static_cast<int>(std::min(camera.width, kMostPixels));
  result.height = static_cast<int>(std::min(camera.height, kMostPixels));
  const double cx = camera.params[focals];
  const double cy = camera.params[focals + 1];
  result.intrinsics << camera.params[0], 0, cx - 0.5, 0, camera.params[focals - 1], cy - 0.5, 0, 0, 1;
  return result;
}

}  // namespace depthfarm
