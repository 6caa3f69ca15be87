#include "common/sequence/depth_manifest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <string_view>

#include "common/files/atomic_file.h"
#include "common/sequence/camera_fields.h"
#include "common/sequence/frame_name.h"
#include "common/sequence/json_fields.h"
#include "common/sequence/output_layout.h"
#include "common/sequence/read_sequence.h"

namespace depthfarm {
namespace {

using OrderedJson = nlohmann::ordered_json;  // keeps the order of writing: the file is read by people too

constexpr std::string_view kFormat = "depthfarm-depth-1";
constexpr std::uint64_t kMaxManifestBytes = std::uint64_t{1} << 30;
constexpr std::size_t kDigestLength = 64;
constexpr const char* kNoDigest = "not 64 lower-case hexadecimal digits";

bool IsSha256(const std::string& text) {
  return text.size() == kDigestLength &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

// Of files and their digests under two keys; empty: nothing.
std::string WhatIsWrong(const std::string& paths, const std::string& digests,
                        const std::vector<DepthManifestFile>& files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    const std::string position = "[" + std::to_string(i) + "]";
    if (!StaysInFolder(files[i].path)) {
      return paths + position + " is " + Shortened(Json(files[i].path)) +
             ", expected a plain path within the folder of depth.json";
    }
    if (!IsSha256(files[i].sha256)) return digests + position + " is " + kNoDigest;
  }
  return "";
}

// What both directions demand of a camera's entry.
Status CheckCamera(const DepthManifestCamera& entry) {
  const auto bad = [&](const std::string& what) {
    return InvalidArgument("camera '" + entry.camera.name + "': " + what);
  };
  DEPTHFARM_RETURN_IF_ERROR(ValidateCamera(entry.camera));
  if (entry.camera.name.empty() || entry.camera.name.find('/') != std::string::npos) {
    return bad("expected a name that is not empty and has no '/'");
  }
  if (!(entry.z_near > 0) || !(entry.z_near < entry.z_far) || !std::isfinite(entry.z_far)) {
    return bad("zNear and zFar are not 0 < zNear < zFar, both finite");
  }
  if (entry.input_sha256.size() != entry.files.size()) {
    return bad("has " + std::to_string(entry.files.size()) + " files and " + std::to_string(entry.input_sha256.size()) +
               " input digests, expected as many");
  }
  if (!entry.confidence.empty() && entry.confidence.size() != entry.files.size()) {
    return bad("has " + std::to_string(entry.files.size()) + " files and " + std::to_string(entry.confidence.size()) +
               " of confidence, expected as many or none");
  }
  if (const std::string wrong = WhatIsWrong("files", "sha256", entry.files); !wrong.empty()) return bad(wrong);
  if (const std::string wrong = WhatIsWrong("confidence", "confidenceSha256", entry.confidence); !wrong.empty())
    return bad(wrong);
  for (std::size_t i = 0; i < entry.input_sha256.size(); ++i) {
    if (!IsSha256(entry.input_sha256[i])) return bad("inputSha256[" + std::to_string(i) + "] is " + kNoDigest);
  }
  return {};
}

Status CheckManifest(const DepthManifest& manifest) {
  std::set<std::string> names;
  for (const DepthManifestCamera& entry : manifest.cameras) {
    DEPTHFARM_RETURN_IF_ERROR(CheckCamera(entry));
    if (!names.insert(entry.camera.name).second) {
      return InvalidArgument("camera '" + entry.camera.name + "' is given twice");
    }
    const DepthManifestCamera& first = manifest.cameras.front();
    if (entry.files.size() != first.files.size()) {
      return InvalidArgument("camera '" + entry.camera.name + "' has " + std::to_string(entry.files.size()) +
                             " files and camera '" + first.camera.name + "' has " + std::to_string(first.files.size()) +
                             ", expected as many");
    }
  }
  for (const auto& [key, value] : manifest.parameters) {
    const double* number = std::get_if<double>(&value);
    if (number != nullptr && !std::isfinite(*number)) {
      return InvalidArgument("parameter '" + key + "' is not a finite number");
    }
  }
  if (manifest.first_frame < 0) {
    return InvalidArgument("firstFrame is " + std::to_string(manifest.first_frame) + ", expected >= 0");
  }
  return {};
}

void AddFiles(const char* paths_key, const char* digests_key, const std::vector<DepthManifestFile>& files,
              OrderedJson& json) {
  OrderedJson paths = OrderedJson::array();
  OrderedJson digests = OrderedJson::array();
  for (const DepthManifestFile& file : files) {
    paths.push_back(file.path);
    digests.push_back(file.sha256);
  }
  json[paths_key] = std::move(paths);
  json[digests_key] = std::move(digests);
}

OrderedJson CameraJson(const DepthManifestCamera& entry) {
  OrderedJson json = CameraFieldsJson(entry.camera);
  json["zNear"] = entry.z_near;
  json["zFar"] = entry.z_far;
  AddFiles("files", "sha256", entry.files, json);
  if (!entry.confidence.empty()) AddFiles("confidence", "confidenceSha256", entry.confidence, json);
  json["inputSha256"] = entry.input_sha256;
  return json;
}

Result<std::vector<DepthManifestFile>> ReadFiles(const JsonFields& fields, std::string_view paths_key,
                                                 std::string_view digests_key) {
  DEPTHFARM_ASSIGN_OR_RETURN(std::vector<std::string> paths, fields.Strings(paths_key, kMaxFrames));
  DEPTHFARM_ASSIGN_OR_RETURN(std::vector<std::string> digests, fields.Strings(digests_key, kMaxFrames));
  if (paths.size() != digests.size()) {
    return fields.Bad("'" + std::string(paths_key) + "' has " + std::to_string(paths.size()) + " entries and '" +
                      std::string(digests_key) + "' " + std::to_string(digests.size()) + ", expected as many");
  }
  std::vector<DepthManifestFile> files;
  for (std::size_t i = 0; i < paths.size(); ++i) files.push_back({std::move(paths[i]), std::move(digests[i])});
  return files;
}

Result<DepthManifestCamera> ReadCamera(const Json& value, const std::string& where) {
  static constexpr std::array<std::string_view, 13> kKeys = {
      "name",   "width",      "height",           "K",          "R", "t", "zNear", "zFar", "files",
      "sha256", "confidence", "confidenceSha256", "inputSha256"};
  DEPTHFARM_ASSIGN_OR_RETURN(const JsonFields fields, JsonFields::Of(value, where, kKeys));
  DepthManifestCamera entry;
  DEPTHFARM_ASSIGN_OR_RETURN(entry.camera.name, fields.String("name"));
  constexpr std::int64_t kMaxInt = std::numeric_limits<int>::max();  // the sides' bounds are ValidateCamera's
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t width, fields.Integer("width", 1, kMaxInt));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t height, fields.Integer("height", 1, kMaxInt));
  entry.camera.width = static_cast<int>(width);
  entry.camera.height = static_cast<int>(height);
  DEPTHFARM_ASSIGN_OR_RETURN(entry.camera.intrinsics, fields.Matrix3("K"));
  DEPTHFARM_ASSIGN_OR_RETURN(entry.camera.cam_from_world_rotation, fields.Matrix3("R"));
  DEPTHFARM_ASSIGN_OR_RETURN(entry.camera.cam_from_world_translation, fields.Vector3("t"));
  DEPTHFARM_ASSIGN_OR_RETURN(entry.z_near, fields.Positive("zNear"));
  DEPTHFARM_ASSIGN_OR_RETURN(entry.z_far, fields.Positive("zFar"));
  DEPTHFARM_ASSIGN_OR_RETURN(entry.files, ReadFiles(fields, "files", "sha256"));
  if (fields.Has("confidence") || fields.Has("confidenceSha256")) {
    DEPTHFARM_ASSIGN_OR_RETURN(entry.confidence, ReadFiles(fields, "confidence", "confidenceSha256"));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(entry.input_sha256, fields.Strings("inputSha256", kMaxFrames));
  return entry;
}

Result<std::map<std::string, ManifestNumberOrText>> ReadParameters(const JsonFields& fields) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, fields.Value("parameters"));
  if (!value->is_object()) return fields.Bad("'parameters' is " + Shortened(*value) + ", expected an object {...}");
  std::map<std::string, ManifestNumberOrText> parameters;
  for (const auto& [key, entry] : value->items()) {
    if (entry.is_number_unsigned() && entry.get<std::uint64_t>() > std::numeric_limits<std::int64_t>::max()) {
      return fields.Bad("parameter '" + key + "' is " + Shortened(entry) + ", expected less than 2^63");
    }
    if (entry.is_number_integer()) {
      parameters[key] = entry.get<std::int64_t>();
    } else if (entry.is_number_float()) {
      parameters[key] = entry.get<double>();
    } else if (entry.is_string()) {
      parameters[key] = entry.get<std::string>();
    } else {
      return fields.Bad("parameter '" + key + "' is " + Shortened(entry) + ", expected a number or a text");
    }
  }
  return parameters;
}

}  // namespace

std::string DepthFileName(const std::string& camera, int frame, const std::string& extension) {
  return std::string(kDepthFolder) + "/" + camera + "/" + FrameName(frame) + "." + extension;
}

std::string ConfidenceFileName(const std::string& camera, int frame) {
  return std::string(kConfidenceFolder) + "/" + camera + "/" + FrameName(frame) + ".png";
}

Result<std::string> FormatDepthManifest(const DepthManifest& manifest) {
  DEPTHFARM_RETURN_IF_ERROR(CheckManifest(manifest));
  try {
    OrderedJson parameters = OrderedJson::object();
    for (const auto& [key, value] : manifest.parameters) {
      std::visit([&, name = key](const auto& held) { parameters[name] = held; }, value);
    }
    OrderedJson cameras = OrderedJson::array();
    for (const DepthManifestCamera& entry : manifest.cameras) cameras.push_back(CameraJson(entry));
    const OrderedJson document = {{"format", kFormat},
                                  {"sequence", manifest.sequence},
                                  {"algorithmVersion", manifest.algorithm_version},
                                  {"firstFrame", manifest.first_frame},
                                  {"parameters", std::move(parameters)},
                                  {"cameras", std::move(cameras)}};
    return document.dump(1) + "\n";
  } catch (const nlohmann::json::exception& error) {  // text that is not UTF-8
    return InvalidArgument(std::string("depth.json cannot be written: ") + error.what());
  }
}

Status WriteDepthManifest(const std::string& directory, const DepthManifest& manifest) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, FormatDepthManifest(manifest));
  return WriteFileAtomically((std::filesystem::path(directory) / kDepthManifestName).string(), text);
}

Result<DepthManifest> ReadDepthManifest(const std::string& directory) {
  const std::string file = (std::filesystem::path(directory) / kDepthManifestName).string();
  const auto missing = [](const std::string& path) {
    std::error_code error;
    return std::filesystem::status(path, error).type() == std::filesystem::file_type::not_found;
  };
  if (missing(directory)) return InvalidArgument(directory + ": no such folder");
  if (std::error_code error; std::filesystem::is_regular_file(directory, error)) {
    return InvalidArgument(directory + " is a file, expected the output folder of a job");
  }
  if (missing(file)) {
    return InvalidArgument(directory + " has no " + kDepthManifestName +
                           ": it is not the output folder of a finished job");
  }
  const auto text = ReadFileBytes(file, kMaxManifestBytes);
  if (!text.ok()) return InvalidArgument(text.status().message());
  return ParseDepthManifest(*text, file);
}

Result<DepthManifest> ParseDepthManifest(std::string_view text, const std::string& file) {
  static constexpr std::array<std::string_view, 6> kKeys = {"format",     "sequence",   "algorithmVersion",
                                                            "firstFrame", "parameters", "cameras"};
  const auto document = ParseStrictJson(text);
  if (!document.ok()) return document.status().WithContext(file);
  DEPTHFARM_ASSIGN_OR_RETURN(const JsonFields fields, JsonFields::Of(*document, file, kKeys));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string format, fields.String("format"));
  if (format != kFormat) {
    return fields.Bad("'format' is " + Shortened(Json(format)) + ", expected " + std::string(kFormat));
  }
  DepthManifest manifest;
  DEPTHFARM_ASSIGN_OR_RETURN(manifest.sequence, fields.String("sequence"));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t version,
                             fields.Integer("algorithmVersion", 0, std::numeric_limits<std::uint32_t>::max()));
  manifest.algorithm_version = static_cast<std::uint32_t>(version);
  DEPTHFARM_ASSIGN_OR_RETURN(const std::int64_t first_frame, fields.Integer("firstFrame", 0, kMaxFrames));
  manifest.first_frame = static_cast<int>(first_frame);
  DEPTHFARM_ASSIGN_OR_RETURN(manifest.parameters, ReadParameters(fields));
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* cameras, fields.Array("cameras", kMaxCameras));
  for (std::size_t i = 0; i < cameras->size(); ++i) {
    DEPTHFARM_ASSIGN_OR_RETURN(DepthManifestCamera entry,
                               ReadCamera((*cameras)[i], file + ": cameras[" + std::to_string(i) + "]"));
    manifest.cameras.push_back(std::move(entry));
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckManifest(manifest).WithContext(file));
  return manifest;
}

}  // namespace depthfarm
