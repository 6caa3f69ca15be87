#include "common/calibration/llff.h"

#include <algorithm>
#include <cmath>

#include "common/calibration/camera_collector.h"
#include "common/calibration/npy.h"
#include "common/calibration/picture_name.h"
#include "common/sequence/json_fields.h"

namespace depthfarm {
namespace {

constexpr std::size_t kPoseColumns = 5;
constexpr std::size_t kColumns = 3 * kPoseColumns + 2;
constexpr double kMostPixels = 1e9;  // fits an int; what is too large for a camera is for the collector to tell

bool IsWhole(double number) { return number >= 0 && number <= kMostPixels && number == std::floor(number); }

std::string NumberedName(std::size_t row) {
  std::string digits = std::to_string(row);
  if (digits.size() < 3) digits.insert(0, 3 - digits.size(), '0');
  return digits;
}

// All but the names.
Result<CalibratedCamera> CameraOf(const NumberTable& table, std::size_t row) {
  const auto pose = [&](std::size_t y, std::size_t x) { return table.At(row, kPoseColumns * y + x); };
  const auto column = [&](std::size_t x) { return Eigen::Vector3d(pose(0, x), pose(1, x), pose(2, x)); };
  const double height = pose(0, 4);
  const double width = pose(1, 4);
  const double focal = pose(2, 4);
  if (!IsWhole(height) || !IsWhole(width)) {
    return InvalidArgument("the size is " + Shortened(Json(width)) + "x" + Shortened(Json(height)) +
                           ", expected whole numbers of pixels");
  }
  CalibratedCamera result;
  Camera& camera = result.camera;
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  camera.intrinsics << focal, 0, width / 2 - 0.5, 0, focal, height / 2 - 0.5, 0, 0, 1;
  camera.cam_from_world_rotation.row(0) = column(1).transpose();
  camera.cam_from_world_rotation.row(1) = column(0).transpose();
  camera.cam_from_world_rotation.row(2) = -column(2).transpose();
  camera.cam_from_world_translation = -OrderedProduct(camera.cam_from_world_rotation, column(3));
  result.z_near = table.At(row, kColumns - 2);
  result.z_far = table.At(row, kColumns - 1);
  return result;
}

}  // namespace

Result<Calibration> ParseLlffCameras(std::string_view bytes, const std::string& file,
                                     const std::vector<std::string>& pictures) {
  DEPTHFARM_ASSIGN_OR_RETURN(const NumberTable table, ParseNpy(bytes, file));
  if (table.columns != kColumns) {
    return InvalidArgument(file + ": has " + std::to_string(table.columns) + " columns, expected " +
                           std::to_string(kColumns) + ": a 3x5 pose and two depths for each picture");
  }
  if (!pictures.empty() && pictures.size() != table.rows) {
    return InvalidArgument(file + ": has " + std::to_string(table.rows) + " rows, and there are " +
                           std::to_string(pictures.size()) + " pictures, expected one for each row");
  }
  CameraCollector cameras(file);
  for (std::size_t row = 0; row < table.rows; ++row) {
    const std::string position = "row " + std::to_string(row);
    Result<CalibratedCamera> camera = CameraOf(table, row);
    if (!camera.ok()) return camera.status().WithContext(position).WithContext(file);
    if (!pictures.empty()) camera->picture = pictures[row];
    camera->camera.name = pictures.empty() ? NumberedName(row) : NameOfPicture(pictures[row]);
    DEPTHFARM_RETURN_IF_ERROR(cameras.Add(*std::move(camera), position));
  }
  Calibration calibration;
  DEPTHFARM_ASSIGN_OR_RETURN(calibration.cameras, cameras.Take());
  return calibration;
}

}  // namespace depthfarm
