#include "worker/media_cli/export_command.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <utility>

#include "common/files/atomic_file.h"
#include "common/files/writable_folder.h"
#include "common/image/picture.h"
#include "common/media/depth_file.h"
#include "common/media/exr.h"
#include "common/media/pfm.h"
#include "common/media/raw_picture.h"
#include "common/sequence/camera_fields.h"
#include "common/sequence/depth_manifest.h"
#include "worker/media_cli/picture_sink.h"
#include "worker/media_cli/point_cloud.h"
#include "worker/rendering/sequence_with_depth.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr double kCertain = 65535;

struct Frames {
  int first = 0;
  int end = 0;  // of the sequence, with depth in `first` to `end` - 1
};

Result<Frames> FramesOf(const ExportCommandOptions& options, const DepthManifest& manifest) {
  if (manifest.cameras.empty() || manifest.cameras.front().files.empty())
    return InvalidArgument(options.depth_dir + ": depth.json lists no depth maps");
  const Frames all{manifest.first_frame,
                   manifest.first_frame + static_cast<int>(manifest.cameras.front().files.size())};
  const Frames asked{options.first_frame < 0 ? all.first : options.first_frame,
                     options.end_frame < 0 ? all.end : options.end_frame};
  if (asked.first >= all.first && asked.end <= all.end && asked.first < asked.end) return asked;
  return InvalidArgument("--frames asks for " + std::to_string(asked.first) + " to " + std::to_string(asked.end - 1) +
                         ", " + options.depth_dir + " has depth of " + std::to_string(all.first) + " to " +
                         std::to_string(all.end - 1));
}

Status CheckInterrupted(const ExportCommandOptions& options) {
  return options.interrupted && options.interrupted() ? Cancelled() : Status();
}

std::string CountOf(int count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string NameOf(int frame, const std::string& extension) {
  return fs::path(DepthFileName("x", frame, extension)).filename().string();
}

bool IsMetric(const std::string& format) { return format == "pfm" || format == "exr"; }

Status ExportMetric(const ExportCommandOptions& options, const DepthManifest& manifest, const Frames& frames) {
  for (const DepthManifestCamera& camera : manifest.cameras) {
    const fs::path folder = fs::path(options.output) / camera.camera.name;
    DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(folder.string()));
    for (int frame = frames.first; frame < frames.end; ++frame) {
      DEPTHFARM_RETURN_IF_ERROR(CheckInterrupted(options));
      const auto position = static_cast<std::size_t>(frame - manifest.first_frame);
      DEPTHFARM_ASSIGN_OR_RETURN(const DepthMap depth, ReadDepthOf(options.depth_dir, camera, position));
      DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes,
                                 options.format == "exr" ? EncodeExr(depth) : EncodePfm(depth));
      DEPTHFARM_RETURN_IF_ERROR(WriteFileAtomically((folder / NameOf(frame, options.format)).string(), bytes));
    }
  }
  return {};
}

// The videos, and of what cameras and depth they are: codes alone say nothing.
Status ExportYuv(const ExportCommandOptions& options, const DepthManifest& manifest, const Frames& frames) {
  nlohmann::ordered_json cameras = nlohmann::ordered_json::array();
  for (const DepthManifestCamera& camera : manifest.cameras) {
    const int width = camera.camera.width;
    const int height = camera.camera.height;
    DEPTHFARM_ASSIGN_OR_RETURN(const DepthCode code, DepthCode::Create(camera.z_near, camera.z_far));
    const std::string name = camera.camera.name + ".yuv";
    DEPTHFARM_ASSIGN_OR_RETURN(const std::unique_ptr<PictureSink> video,
                               OpenPictureSink((fs::path(options.output) / name).string(), {}));
    for (int frame = frames.first; frame < frames.end; ++frame) {
      DEPTHFARM_RETURN_IF_ERROR(CheckInterrupted(options));
      const auto position = static_cast<std::size_t>(frame - manifest.first_frame);
      const std::string file = (fs::path(options.depth_dir) / camera.files[position].path).string();
      DEPTHFARM_ASSIGN_OR_RETURN(const Grid<std::uint16_t> codes, ReadDepthCodes(file, width, height, code));
      DEPTHFARM_RETURN_IF_ERROR(video->Write(frame, EncodeRawLuma16(codes)));
    }
    DEPTHFARM_RETURN_IF_ERROR(video->Finish());
    nlohmann::ordered_json entry = CameraFieldsJson(camera.camera);
    entry["zNear"] = camera.z_near;
    entry["zFar"] = camera.z_far;
    entry["depth"] = name;
    cameras.push_back(std::move(entry));
  }
  const nlohmann::ordered_json json = {{"format", "yuv420p16le"},
                                       {"firstFrame", frames.first},
                                       {"frames", frames.end - frames.first},
                                       {"cameras", std::move(cameras)}};
  return WriteFileAtomically((fs::path(options.output) / "cameras.json").string(), json.dump(1) + "\n");
}

Status ExportPly(const ExportCommandOptions& options, const Frames& frames, std::size_t& points) {
  SequenceWithDepth input;
  DEPTHFARM_RETURN_IF_ERROR(ReadSequenceWithDepth(options.sequence, options.depth_dir, input));
  for (int frame = frames.first; frame < frames.end; ++frame) {
    PointCloud cloud;
    for (std::size_t v = 0; v < input.views.size(); ++v) {
      DEPTHFARM_RETURN_IF_ERROR(CheckInterrupted(options));
      if (input.views[v].depth == nullptr) continue;
      const int view = static_cast<int>(v);
      DEPTHFARM_ASSIGN_OR_RETURN(const DepthMap depth, ReadDepthOf(input, view, frame));
      DEPTHFARM_ASSIGN_OR_RETURN(const YcbcrImage picture, ReadPictureOf(input, view, frame));
      PointChoice choice{.step = options.step};
      std::optional<Grid<std::uint16_t>> confidence;
      if (options.min_confidence > 0) {
        DEPTHFARM_ASSIGN_OR_RETURN(confidence, ReadConfidenceOf(input, view, frame));
        if (!confidence)
          return InvalidArgument("--min-confidence: " + options.depth_dir +
                                 " has no confidence; run with --confidence on makes it");
        choice.confidence = &*confidence;
        choice.least = static_cast<std::uint16_t>(std::ceil(options.min_confidence * kCertain));
      }
      cloud.Add(input.views[v].camera, depth, picture, choice);
    }
    DEPTHFARM_RETURN_IF_ERROR(
        WriteFileAtomically((fs::path(options.output) / NameOf(frame, "ply")).string(), cloud.Ply()));
    points += cloud.num_points();
  }
  return {};
}

// Options that the format does not have.
Status CheckOptions(const ExportCommandOptions& options) {
  const bool ply = options.format == "ply";
  if (!ply && !IsMetric(options.format) && options.format != "yuv")
    return InvalidArgument("FORMAT is '" + options.format + "', expected pfm, exr, yuv or ply");
  if (ply && options.sequence.empty())
    return InvalidArgument("ply needs --sequence, the file that the depth was estimated from: points have its colours");
  if (!ply && !(options.sequence.empty() && options.step == 1 && options.min_confidence == 0))
    return InvalidArgument("--sequence, --step and --min-confidence are of ply");
  std::error_code error;
  if (fs::equivalent(options.depth_dir, options.output, error))
    return InvalidArgument("-o is " + options.output + ", the folder that is exported: choose another one");
  return {};
}

}  // namespace

Status RunExport(const ExportCommandOptions& options, std::ostream& out) {
  DEPTHFARM_RETURN_IF_ERROR(CheckOptions(options));
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthManifest manifest, ReadDepthManifest(options.depth_dir));
  DEPTHFARM_ASSIGN_OR_RETURN(const Frames frames, FramesOf(options, manifest));
  DEPTHFARM_RETURN_IF_ERROR(CheckWritableFolder(options.output));
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(options.output));
  const std::string of = CountOf(frames.end - frames.first, "frame") + " of " +
                         CountOf(static_cast<int>(manifest.cameras.size()), "camera");
  if (IsMetric(options.format)) {
    DEPTHFARM_RETURN_IF_ERROR(ExportMetric(options, manifest, frames));
    out << of << " -> " << options.output << "/CAMERA/FRAME." << options.format << "\n";
  } else if (options.format == "yuv") {
    DEPTHFARM_RETURN_IF_ERROR(ExportYuv(options, manifest, frames));
    out << of << " -> " << options.output << "/CAMERA.yuv (yuv420p16le)\n";
  } else {
    std::size_t points = 0;
    DEPTHFARM_RETURN_IF_ERROR(ExportPly(options, frames, points));
    out << of << ", " << points << " points -> " << options.output << "/FRAME.ply\n";
  }
  return {};
}

}  // namespace depthfarm
