#ifndef DEPTHFARM_COMMON_SEQUENCE_CAMERA_FIELDS_H_
#define DEPTHFARM_COMMON_SEQUENCE_CAMERA_FIELDS_H_

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>

#include "common/base/status.h"
#include "common/geometry/camera.h"
#include "common/sequence/json_fields.h"

namespace depthfarm {

inline constexpr std::size_t kMaxNameLength = 200;  // bytes; file systems allow 255, endings included

// Whether the name of a camera is fit to name files; kInvalidArgument "<where>: 'name' is ...".
[[nodiscard]] Status CheckCameraName(const std::string& name, const std::string& where);

// name, width, height, K, R and t of a camera. The name is fit to name files; whether K and R are those of a camera is
// for ValidateCamera. `position` begins messages about the name, which may not be known yet.
[[nodiscard]] Result<Camera> ReadCameraFields(const JsonFields& fields, const std::string& position);

// What ReadCameraFields reads of it, in the order of documents. Numbers are finite: JSON has no word for others.
[[nodiscard]] nlohmann::ordered_json CameraFieldsJson(const Camera& camera);

// Where a camera of a file is, for messages: "FILE: cameras[3] (camera "left")".
[[nodiscard]] std::string CameraWhere(const Json& value, const std::string& position);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SEQUENCE_CAMERA_FIELDS_H_
