#ifndef DEPTHFARM_COMMON_CALIBRATION_COLMAP_LENS_H_
#define DEPTHFARM_COMMON_CALIBRATION_COLMAP_LENS_H_

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "common/geometry/camera.h"

namespace depthfarm {

// One of COLMAP's camera models, whose parameters begin with one or two focal lengths and the principal point. Of a
// perspective one all others are distortion, and zeros leave a pinhole.
struct ColmapLens {
  std::uint32_t id;
  std::string_view name;
  std::size_t num_params;
  int num_focals;
  bool perspective;
};

// nullptr: not known.
[[nodiscard]] const ColmapLens* ColmapLensOf(std::uint32_t id);
[[nodiscard]] const ColmapLens* ColmapLensOf(std::string_view name);

// An entry of cameras.txt or cameras.bin; several images may share it.
struct ColmapCamera {
  const ColmapLens* lens = nullptr;
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::vector<double> params;  // lens->num_params
};

// Size and K. COLMAP counts pixels from the corner of the top-left one, half a pixel more than here.
// kInvalidArgument, without a name: a lens with distortion (the message says what to do), a size past that of a Camera.
[[nodiscard]] Result<Camera> CameraOf(const ColmapCamera& camera);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_COLMAP_LENS_H_
