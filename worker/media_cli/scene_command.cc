#include "worker/media_cli/scene_command.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "common/files/atomic_file.h"
#include "common/files/writable_folder.h"
#include "common/geometry/neighbours.h"
#include "common/media/colour_map.h"
#include "common/media/grey_picture.h"
#include "common/media/pfm.h"
#include "common/media/raw_picture.h"
#include "common/scene/array.h"
#include "common/scene/render.h"
#include "common/scene/scene.h"
#include "common/scene/zone.h"
#include "common/sequence/camera_fields.h"
#include "common/sequence/frame_name.h"

namespace depthfarm {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int kFrameRate = 25;

template <typename T>
Status CheckBounds(const char* option, T value, T low, T high) {
  if (value >= low && value <= high) return {};  // written so that NaN fails
  std::ostringstream text;
  text << "scene: " << option << " is " << value << ", expected " << low << " to " << high;
  return InvalidArgument(text.str());
}

// Bits of a sample of a raw format; 0 for PNG.
int RawBits(const std::string& format) { return format == "yuv420p8" ? 8 : format == "yuv420p10le" ? 10 : 0; }

// Where a view's files go, relative to the output folder; the same strings stand in sequence.json.
struct ViewFiles {
  std::string picture;
  std::string depth;
  std::string zones;
};
ViewFiles FilesOf(const Camera& camera, int frame, const SceneCommandOptions& options) {
  const std::string name = camera.name + "/" + FrameName(frame);
  return {name + (RawBits(options.format) > 0 ? ".yuv" : ".png"), "truth/" + name + ".pfm",
          "truth/" + name + "_zones.png"};
}

Status WriteView(const RenderedView& view, const ViewFiles& files, const SceneCommandOptions& options) {
  const fs::path folder = options.output;
  std::string picture;
  if (const int bits = RawBits(options.format); bits > 0) {
    picture = EncodeRawYuv420(view.rgb, bits);
  } else {
    DEPTHFARM_ASSIGN_OR_RETURN(picture, EncodeRgbPng(view.rgb));
  }
  DEPTHFARM_RETURN_IF_ERROR(WriteFileAtomically(folder / files.picture, picture));
  DEPTHFARM_RETURN_IF_ERROR(WriteFileAtomically(folder / files.depth, EncodePfm(view.depth)));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string zones, EncodeGreyPng(view.zones));
  return WriteFileAtomically(folder / files.zones, zones);
}

Json CameraJson(const Camera& camera, const SceneCommandOptions& options) {
  Json json = CameraFieldsJson(camera);
  if (RawBits(options.format) > 0) {
    json["format"] = options.format;
    json["range"] = "full";
    json["matrix"] = "bt601";
  }
  for (int frame = 0; frame < options.frames; ++frame) {
    json["images"].push_back(FilesOf(camera, frame, options).picture);
  }
  return json;
}

Json GroundTruthJson(const std::vector<Camera>& cameras, const SceneCommandOptions& options) {
  Json truth = {{"encoding", "z-pfm"}};
  for (const Zone zone : kSurfaceZones) truth["zones"][std::string(ZoneName(zone))] = static_cast<int>(zone);
  for (const Camera& camera : cameras) {
    Json view = {{"view", camera.name}};
    for (int frame = 0; frame < options.frames; ++frame) {
      const ViewFiles files = FilesOf(camera, frame, options);
      view["depth"].push_back(files.depth);
      view["zones"].push_back(files.zones);
    }
    truth["views"].push_back(view);
  }
  return truth;
}

Json SequenceJson(const std::vector<Camera>& cameras, const DepthRange& range, const SceneCommandOptions& options) {
  Json json = {{"name", options.kind + "-" + std::to_string(options.seed)},
               {"convention", "x_cam = R*X_world + t, +z forward, +y down, pixels (0,0)=centre of top-left pixel"},
               {"zNear", range.z_near},
               {"zFar", range.z_far},
               {"frameRate", kFrameRate}};
  for (const Camera& camera : cameras) json["cameras"].push_back(CameraJson(camera, options));
  json["groundTruth"] = GroundTruthJson(cameras, options);
  return json;
}

}  // namespace

Status ValidateSceneOptions(const SceneCommandOptions& options) {
  DEPTHFARM_RETURN_IF_ERROR(ParseArrayKind(options.kind).status().WithContext("scene"));
  if (options.output.empty()) return InvalidArgument("scene: no output folder is given");
  DEPTHFARM_RETURN_IF_ERROR(CheckBounds("cameras", options.cameras, 2, 256));
  DEPTHFARM_RETURN_IF_ERROR(CheckBounds("width", options.width, 16, 8192));
  DEPTHFARM_RETURN_IF_ERROR(CheckBounds("height", options.height, 16, 8192));
  DEPTHFARM_RETURN_IF_ERROR(CheckBounds("frames", options.frames, 1, 100000));
  DEPTHFARM_RETURN_IF_ERROR(CheckBounds("noise", options.noise, 0.0, 50.0));
  DEPTHFARM_RETURN_IF_ERROR(CheckBounds("gain", options.gain, 0.0, 0.2));
  if (options.format != "png" && RawBits(options.format) == 0) {
    return InvalidArgument("scene: format is '" + options.format + "', expected png, yuv420p8 or yuv420p10le");
  }
  return {};
}

Status RunScene(const SceneCommandOptions& options) {
  DEPTHFARM_RETURN_IF_ERROR(ValidateSceneOptions(options));
  DEPTHFARM_RETURN_IF_ERROR(CheckWritableFolder(options.output).WithContext("scene"));
  DEPTHFARM_ASSIGN_OR_RETURN(const ArrayKind kind, ParseArrayKind(options.kind));
  const std::vector<Camera> cameras = MakeArray(kind, options.cameras, options.width, options.height, options.seed);
  const Scene scene = MakeScene(options.seed);
  const Camera& reference = cameras[CentreCamera(cameras)];
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthRange range, SceneDepthRange(scene, cameras, reference, options.frames));

  const fs::path folder = options.output;
  const fs::path sequence_file = folder / "sequence.json";
  for (const Camera& camera : cameras) {
    DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(folder / camera.name));
    DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(folder / "truth" / camera.name));
  }
  std::error_code error;
  fs::remove(sequence_file, error);
  if (error) return Unavailable(sequence_file.string() + ": the old file could not be removed: " + error.message());

  const RenderOptions render{.noise = options.noise, .gain = options.gain};
  for (int frame = 0; frame < options.frames; ++frame) {
    for (const Camera& camera : cameras) {
      const RenderedView view = RenderView(scene, camera, frame, render);
      DEPTHFARM_RETURN_IF_ERROR(WriteView(view, FilesOf(camera, frame, options), options));
    }
  }
  return WriteFileAtomically(sequence_file, SequenceJson(cameras, range, options).dump(1) + "\n");
}

}  // namespace depthfarm
