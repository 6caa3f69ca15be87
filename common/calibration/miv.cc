#include "common/calibration/miv.h"

#include <array>
#include <cmath>
#include <numbers>

#include "common/calibration/camera_collector.h"
#include "common/sequence/json_fields.h"
#include "common/sequence/read_sequence.h"

namespace depthfarm {
namespace {

constexpr const char* kViewer = "viewport";
constexpr double kMostPixels = 1e9;  // fits an int; what is too large for a camera is for the collector to tell

Result<std::array<double, 2>> Pair(const JsonFields& fields, std::string_view key) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, fields.Value(key));
  std::array<double, 2> pair{};
  bool good = value->is_array() && value->size() == 2;
  for (std::size_t i = 0; good && i < 2; ++i) {
    good = (*value)[i].is_number();
    if (good) pair[i] = (*value)[i].get<double>();
    good = good && std::isfinite(pair[i]);
  }
  if (!good) return fields.Bad("'" + std::string(key) + "' is " + Shortened(*value) + ", expected 2 finite numbers");
  return pair;
}

std::string Where(const std::string& file, const std::string& position) { return file + ": " + position; }

// Rz(yaw) Ry(pitch) Rx(roll), angles in degrees: from the camera's axes to the world's.
Eigen::Matrix3d WorldFromCamera(const Eigen::Vector3d& degrees) {
  const Eigen::Vector3d angles = degrees * (std::numbers::pi / 180);
  const Eigen::Vector3d s(std::sin(angles[0]), std::sin(angles[1]), std::sin(angles[2]));
  const Eigen::Vector3d c(std::cos(angles[0]), std::cos(angles[1]), std::cos(angles[2]));
  Eigen::Matrix3d yaw;
  Eigen::Matrix3d pitch;
  Eigen::Matrix3d roll;
  yaw << c[0], -s[0], 0, s[0], c[0], 0, 0, 0, 1;
  pitch << c[1], 0, s[1], 0, 1, 0, -s[1], 0, c[1];
  roll << 1, 0, 0, 0, c[2], -s[2], 0, s[2], c[2];
  return OrderedProduct(OrderedProduct(yaw, pitch), roll);
}

Result<CalibratedCamera> ReadCamera(const JsonFields& fields, std::string name) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string projection, fields.String("Projection"));
  if (projection != "Perspective") {
    return fields.Bad("'Projection' is " + Shortened(Json(projection)) +
                      ", expected \"Perspective\": others are not supported");
  }
  CalibratedCamera result;
  Camera& camera = result.camera;
  camera.name = std::move(name);
  DEPTHFARM_ASSIGN_OR_RETURN(const auto size, Pair(fields, "Resolution"));
  for (const double side : size) {
    if (!(side >= 0 && side <= kMostPixels && side == std::floor(side)))
      return fields.Bad("'Resolution' is not of whole numbers of pixels");
  }
  camera.width = static_cast<int>(size[0]);
  camera.height = static_cast<int>(size[1]);
  DEPTHFARM_ASSIGN_OR_RETURN(const auto focal, Pair(fields, "Focal"));
  DEPTHFARM_ASSIGN_OR_RETURN(const auto centre,
                             Pair(fields, fields.Has("Principal_point") ? "Principal_point" : "Principle_point"));
  camera.intrinsics << focal[0], 0, centre[0] - 0.5, 0, focal[1], centre[1] - 0.5, 0, 0, 1;
  DEPTHFARM_ASSIGN_OR_RETURN(const Eigen::Vector3d position, fields.Vector3("Position"));
  DEPTHFARM_ASSIGN_OR_RETURN(const Eigen::Vector3d rotation, fields.Vector3("Rotation"));
  const Eigen::Matrix3d axes = WorldFromCamera(rotation);  // columns: forward, left, up
  camera.cam_from_world_rotation.row(0) = -axes.col(1).transpose();
  camera.cam_from_world_rotation.row(1) = -axes.col(2).transpose();
  camera.cam_from_world_rotation.row(2) = axes.col(0).transpose();
  camera.cam_from_world_translation = -OrderedProduct(camera.cam_from_world_rotation, position);
  DEPTHFARM_ASSIGN_OR_RETURN(const auto range, Pair(fields, "Depth_range"));
  result.z_near = range[0];
  result.z_far = range[1];
  return result;
}

}  // namespace

Result<Calibration> ParseMivCameras(std::string_view text, const std::string& file) {
  const auto document = ParseStrictJson(text);
  if (!document.ok()) return document.status().WithContext(file);
  DEPTHFARM_ASSIGN_OR_RETURN(const JsonFields fields, JsonFields::OfForeign(*document, file));
  Calibration calibration;
  if (fields.Has("Fps")) {
    DEPTHFARM_ASSIGN_OR_RETURN(calibration.frame_rate, fields.Positive("Fps"));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* list, fields.Array("cameras", kMaxCameras + 1));
  CameraCollector cameras(file);
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string position = "cameras[" + std::to_string(i) + "]";
    DEPTHFARM_ASSIGN_OR_RETURN(JsonFields camera, JsonFields::OfForeign((*list)[i], Where(file, position)));
    DEPTHFARM_ASSIGN_OR_RETURN(const std::string name, camera.String("Name"));
    if (name == kViewer) continue;
    camera.set_where(camera.where() + " (camera " + Shortened(Json(name)) + ")");
    DEPTHFARM_ASSIGN_OR_RETURN(CalibratedCamera read, ReadCamera(camera, name));
    DEPTHFARM_RETURN_IF_ERROR(cameras.Add(std::move(read), position));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(calibration.cameras, cameras.Take());
  return calibration;
}

}  // namespace depthfarm
