#include "common/sequence/read_cameras.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "common/files/atomic_file.h"
#include "common/sequence/camera_fields.h"
#include "common/sequence/json_fields.h"

namespace depthfarm {
namespace {

constexpr std::size_t kMostCameras = 1'000'000;
constexpr std::uint64_t kMaxFileBytes = std::uint64_t{256} << 20;

Result<Camera> ReadCamera(const Json& value, const std::string& file, const std::string& position) {
  static constexpr std::array<std::string_view, 7> kKeys = {"name", "width", "height", "K", "R", "t", "notes"};
  DEPTHFARM_ASSIGN_OR_RETURN(const JsonFields fields, JsonFields::Of(value, CameraWhere(value, position), kKeys));
  DEPTHFARM_ASSIGN_OR_RETURN(const Camera camera, ReadCameraFields(fields, position));
  DEPTHFARM_RETURN_IF_ERROR(ValidateCamera(camera).WithContext(file));
  return camera;
}

}  // namespace

Result<std::vector<Camera>> ReadCameras(const std::string& file) {
  const auto text = ReadFileBytes(file, kMaxFileBytes);
  if (!text.ok()) return InvalidArgument("camera file " + text.status().message());
  return ParseCameras(*text, file);
}

Result<std::vector<Camera>> ParseCameras(std::string_view text, const std::string& file) {
  const auto document = ParseStrictJson(text);
  if (!document.ok()) return document.status().WithContext(file);
  if (!document->is_object() || !document->contains("cameras")) {
    DEPTHFARM_ASSIGN_OR_RETURN(const Camera camera, ReadCamera(*document, file, file));
    return std::vector<Camera>{camera};
  }
  static constexpr std::array<std::string_view, 2> kKeys = {"cameras", "notes"};
  DEPTHFARM_ASSIGN_OR_RETURN(const JsonFields fields, JsonFields::Of(*document, file, kKeys));
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* list, fields.Array("cameras", kMostCameras));
  if (list->empty()) return fields.Bad("'cameras' is empty, expected at least one camera");
  std::vector<Camera> cameras;
  for (std::size_t i = 0; i < list->size(); ++i) {
    DEPTHFARM_ASSIGN_OR_RETURN(Camera camera,
                               ReadCamera((*list)[i], file, file + ": cameras[" + std::to_string(i) + "]"));
    cameras.push_back(std::move(camera));
  }
  return cameras;
}

}  // namespace depthfarm
