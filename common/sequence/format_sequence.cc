#include "common/sequence/format_sequence.h"

#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "common/geometry/camera.h"
#include "common/sequence/camera_fields.h"
#include "common/sequence/picture_format.h"
#include "common/sequence/read_sequence.h"

namespace depthfarm {
namespace {

using OrderedJson = nlohmann::ordered_json;  // keeps the order of writing: the file is read by people too

std::string RelativePath(const std::string& path, const std::filesystem::path& folder) {
  return std::filesystem::path(path).lexically_relative(folder).string();
}

OrderedJson PathsOf(const std::vector<std::string>& paths, const std::filesystem::path& folder) {
  OrderedJson list = OrderedJson::array();
  for (const std::string& path : paths) list.push_back(RelativePath(path, folder));
  return list;
}

void AddRange(std::optional<double> z_near, std::optional<double> z_far, OrderedJson& json) {
  if (z_near) json["zNear"] = *z_near;
  if (z_far) json["zFar"] = *z_far;
}

OrderedJson CameraJson(const SequenceCamera& entry, const std::filesystem::path& folder) {
  OrderedJson json = CameraFieldsJson(entry.camera);
  AddRange(entry.z_near, entry.z_far, json);
  const PictureFormat& format = entry.format;
  const bool video = format.of_all_frames() && !entry.images.empty();
  if (!video) json["images"] = PathsOf(entry.images, folder);
  if (!entry.masks.empty()) json["masks"] = PathsOf(entry.masks, folder);
  if (!entry.depth.empty()) json["depth"] = PathsOf(entry.depth, folder);
  if (video) json["video"] = {{"path", RelativePath(entry.images.front(), folder)}, {"frames", entry.images.size()}};
  if (format.raw()) (video ? json["video"] : json)["format"] = RawFormatName(format);
  if (format.raw() || format.colour_said) {
    json["range"] = format.full_range ? "full" : "limited";
    json["matrix"] = format.bt709 ? "bt709" : "bt601";
  }
  return json;
}

// JSON has no word for them, and the library would write null.
Status CheckFinite(const Sequence& sequence) {
  for (const SequenceCamera& entry : sequence.cameras) {
    const Camera& camera = entry.camera;
    const bool finite = camera.intrinsics.allFinite() && camera.cam_from_world_rotation.allFinite() &&
                        camera.cam_from_world_translation.allFinite() && std::isfinite(entry.z_near.value_or(0)) &&
                        std::isfinite(entry.z_far.value_or(0));
    if (!finite) return InvalidArgument("camera '" + camera.name + "' has a number that is not finite");
  }
  if (!std::isfinite(sequence.z_near.value_or(0)) || !std::isfinite(sequence.z_far.value_or(0)) ||
      !std::isfinite(sequence.frame_rate)) {
    return InvalidArgument("depth range or frame rate are not finite");
  }
  return {};
}

}  // namespace

Result<std::string> FormatSequence(const Sequence& sequence) {
  DEPTHFARM_RETURN_IF_ERROR(CheckFinite(sequence));
  const std::filesystem::path folder = std::filesystem::path(sequence.file).parent_path();
  try {
    OrderedJson json;
    if (!sequence.name.empty()) json["name"] = sequence.name;
    json["convention"] = kSequenceConvention;
    AddRange(sequence.z_near, sequence.z_far, json);
    if (sequence.frame_rate > 0) json["frameRate"] = sequence.frame_rate;
    if (!sequence.reference.empty()) json["reference"] = sequence.reference;
    json["cameras"] = OrderedJson::array();
    for (const SequenceCamera& camera : sequence.cameras) json["cameras"].push_back(CameraJson(camera, folder));
    return json.dump(1) + "\n";
  } catch (const nlohmann::json::exception& error) {  // text that is not UTF-8
    return InvalidArgument(std::string("the sequence cannot be written: ") + error.what());
  }
}

}  // namespace depthfarm
