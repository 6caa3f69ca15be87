#ifndef DEPTHFARM_COMMON_CALIBRATION_COLMAP_PARTS_H_
#define DEPTHFARM_COMMON_CALIBRATION_COLMAP_PARTS_H_

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/base/status.h"
#include "common/calibration/colmap_lens.h"
#include "common/calibration/colmap_model.h"

namespace depthfarm {

// What the files of a model hold, each in its two forms. All fail with kInvalidArgument naming file and line or byte.

using ColmapCameras = std::map<std::uint32_t, ColmapCamera>;  // by id
[[nodiscard]] Result<ColmapCameras> ParseColmapCamerasText(const ColmapFile& file);
[[nodiscard]] Result<ColmapCameras> ParseColmapCamerasBinary(const ColmapFile& file);

struct ColmapImage {
  std::uint32_t id = 0;
  std::array<double, 4> rotation{};  // x_cam = R X + t as a quaternion w, x, y, z, as it is in the file
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  std::uint32_t camera = 0;
  std::string name;
  std::string position;  // in the file, for messages
};
[[nodiscard]] Result<std::vector<ColmapImage>> ParseColmapImagesText(const ColmapFile& file);
[[nodiscard]] Result<std::vector<ColmapImage>> ParseColmapImagesBinary(const ColmapFile& file);

// Called for each point, with the ids of the images that see it.
using ColmapPointSink =
    std::function<void(const Eigen::Vector3d& point_in_world, std::span<const std::uint32_t> images)>;
[[nodiscard]] Status ParseColmapPointsText(const ColmapFile& file, const ColmapPointSink& sink);
[[nodiscard]] Status ParseColmapPointsBinary(const ColmapFile& file, const ColmapPointSink& sink);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_CALIBRATION_COLMAP_PARTS_H_
