#include "common/sequence/camera_fields.h"

#include <cstdint>

namespace depthfarm {
namespace {

constexpr std::int64_t kMaxSide = 32768;

}  // namespace

Status CheckCameraName(const std::string& name, const std::string& where) {
  const auto bad = [&](const std::string& why) {
    return InvalidArgument(where + ": 'name' is " + Shortened(Json(name)) + ", " + why + " (it names files)");
  };
  if (name.empty()) return bad("expected at least one character");
  if (name.size() > kMaxNameLength) return bad("expected at most " + std::to_string(kMaxNameLength) + " bytes");
  if (name == "." || name.find("..") != std::string::npos || name.find('/') != std::string::npos) {
    return bad("expected a name without '/' and '..'");
  }
  if (HasControlCharacter(name)) return bad("expected a name without control characters");
  return {};
}

Result<Camera> ReadCameraFields(const JsonFields& fields, const std::string& position) {
  Camera camera;
  DEPTHFARM_ASSIGN_OR_RETURN(camera.name, fields.String("name"));
  DEPTHFARM_RETURN_IF_ERROR(CheckCameraName(camera.name, position));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t width, fields.Integer("width", 1, kMaxSide));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t height, fields.Integer("height", 1, kMaxSide));
  camera.width = static_cast<int>(width);
  camera.height = static_cast<int>(height);
  DEPTHFARM_ASSIGN_OR_RETURN(camera.intrinsics, fields.Matrix3("K"));
  DEPTHFARM_ASSIGN_OR_RETURN(camera.cam_from_world_rotation, fields.Matrix3("R"));
  DEPTHFARM_ASSIGN_OR_RETURN(camera.cam_from_world_translation, fields.Vector3("t"));
  return camera;
}

nlohmann::ordered_json CameraFieldsJson(const Camera& camera) {
  const auto rows_of = [](const Eigen::Matrix3d& m) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (int row = 0; row < 3; ++row) rows.push_back({m(row, 0), m(row, 1), m(row, 2)});
    return rows;
  };
  const Eigen::Vector3d& t = camera.cam_from_world_translation;
  return {{"name", camera.name},
          {"width", camera.width},
          {"height", camera.height},
          {"K", rows_of(camera.intrinsics)},
          {"R", rows_of(camera.cam_from_world_rotation)},
          {"t", {t[0], t[1], t[2]}}};
}

std::string CameraWhere(const Json& value, const std::string& position) {
  if (!value.is_object() || !value.contains("name") || !value.at("name").is_string()) return position;
  return position + " (camera " + Shortened(value.at("name")) + ")";
}

}  // namespace depthfarm
