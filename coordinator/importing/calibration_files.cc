#include "coordinator/importing/calibration_files.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <system_error>

#include "common/calibration/colmap_model.h"
#include "common/calibration/ftv.h"
#include "common/calibration/llff.h"
#include "common/calibration/middlebury.h"
#include "common/calibration/miv.h"
#include "common/calibration/msr.h"
#include "common/calibration/picture_size.h"
#include "common/files/atomic_file.h"
#include "coordinator/importing/picture_pattern.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMaxTextBytes = std::uint64_t{64} << 20;
constexpr std::uint64_t kMaxModelBytes = std::uint64_t{4} << 30;  // of a file of a sparse model: of 10,000s of images

constexpr auto kFormats = std::to_array<CalibrationFormat>({
    {"ftv", false, false, false},
    {"msr", false, false, false},
    {"colmap", true, true, true},
    {"miv", true, true, false},
    {"llff", true, true, true},
    {"middlebury", false, false, true},
});

// A user named the file: that it is missing is a mistake in what was asked for.
Result<std::string> ReadInput(const std::string& file, std::uint64_t max_bytes) {
  auto bytes = ReadFileBytes(file, max_bytes);
  if (!bytes.ok()) return InvalidArgument("calibration " + bytes.status().message());
  return bytes;
}

Result<FtvConvention> ConventionOf(const ImportOptions& options) {
  FtvConvention convention;
  const std::string& pose = options.pose;
  if (pose == "camera-to-world") {
    convention.pose = FtvConvention::Pose::kCameraToWorld;
  } else if (pose == "world-to-camera") {
    convention.pose = FtvConvention::Pose::kWorldToCamera;
  } else if (!pose.empty() && pose != "centre") {
    return InvalidArgument("--pose is '" + pose + "', expected centre, camera-to-world or world-to-camera");
  }
  convention.scene_behind = options.z_axis == "backward";
  if (!options.z_axis.empty() && options.z_axis != "backward" && options.z_axis != "forward") {
    return InvalidArgument("--z-axis is '" + options.z_axis + "', expected forward or backward");
  }
  return convention;
}

Result<ImportedCalibration> ReadColmap(const std::string& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    return InvalidArgument("calibration " + folder +
                           ": is no folder, expected one with cameras, images and points3D, e.g. sparse/0");
  }
  ColmapFiles files;
  files.binary = fs::exists(fs::path(folder) / "images.bin", error);
  const std::string ending = files.binary ? ".bin" : ".txt";
  if (!files.binary && !fs::exists(fs::path(folder) / "images.txt", error)) {
    return InvalidArgument(
        "calibration " + folder +
        ": has neither images.bin nor images.txt: is it the folder of a sparse model, e.g. sparse/0?");
  }
  files.cameras.name = (fs::path(folder) / ("cameras" + ending)).string();
  files.images.name = (fs::path(folder) / ("images" + ending)).string();
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string cameras, ReadInput(files.cameras.name, kMaxModelBytes));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string images, ReadInput(files.images.name, kMaxModelBytes));
  files.cameras.content = cameras;
  files.images.content = images;
  std::string points;
  const fs::path points_file = fs::path(folder) / ("points3D" + ending);
  if (fs::exists(points_file, error)) {
    DEPTHFARM_ASSIGN_OR_RETURN(points, ReadInput(points_file.string(), kMaxModelBytes));
    if (!points.empty()) files.points = ColmapFile{points_file.string(), points};
  }
  DEPTHFARM_ASSIGN_OR_RETURN(ColmapModel model, ParseColmapModel(files));
  return ImportedCalibration{.calibration = std::move(model.calibration), .depths = std::move(model.depths)};
}

// The picture files of a folder in the order of their names.
Result<std::vector<std::string>> PicturesOf(const std::string& folder) {
  static constexpr auto kEndings =
      std::to_array<std::string_view>({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".ppm", ".pgm", ".bmp", ".webp"});
  std::error_code error;
  std::vector<std::string> names;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    std::string ending = entry->path().extension().string();
    std::ranges::transform(ending, ending.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; });
    if (std::ranges::find(kEndings, ending) != kEndings.end()) names.push_back(entry->path().filename().string());
  }
  if (error) return InvalidArgument("--images " + folder + ": " + error.message());
  if (names.empty()) return InvalidArgument("--images " + folder + ": holds no pictures (.png, .jpg, ...)");
  std::ranges::sort(names);
  return names;
}

Result<Calibration> ReadCameraFile(const ImportOptions& options, const PictureSize& size) {
  const std::string& file = options.calibration;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, ReadInput(file, kMaxTextBytes));
  if (options.format == "ftv") {
    DEPTHFARM_ASSIGN_OR_RETURN(const FtvConvention convention, ConventionOf(options));
    return ParseFtvCameras(bytes, file, size, convention);
  }
  if (options.format == "msr") return ParseMsrCameras(bytes, file, size);
  if (options.format == "middlebury") return ParseMiddleburyCameras(bytes, file, size);
  if (options.format == "miv") return ParseMivCameras(bytes, file);
  std::vector<std::string> pictures;
  if (!options.images.empty() && !PicturePattern::IsPattern(options.images)) {
    DEPTHFARM_ASSIGN_OR_RETURN(pictures, PicturesOf(options.images));
  }
  return ParseLlffCameras(bytes, file, pictures);
}

}  // namespace

Result<CalibrationFormat> FormatOf(const std::string& name) {
  std::string names;
  for (const CalibrationFormat& format : kFormats) {
    if (name == format.name) return format;
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  return InvalidArgument("there is no format '" + name + "'; there are " + names);
}

Result<ImportedCalibration> ReadCalibration(const ImportOptions& options, const PictureSize& size) {
  DEPTHFARM_ASSIGN_OR_RETURN(const CalibrationFormat format, FormatOf(options.format));
  if (options.format != "ftv" && !(options.pose.empty() && options.z_axis.empty())) {
    return InvalidArgument("--pose and --z-axis are for format ftv; " + options.format + " has one convention");
  }
  if (!format.tells_size && size.width == 0) {
    return InvalidArgument(options.calibration + ": files of format " + options.format +
                           " do not tell the size of the pictures: give --size WIDTHxHEIGHT");
  }
  ImportedCalibration result;
  if (options.format == "colmap") {
    DEPTHFARM_ASSIGN_OR_RETURN(result, ReadColmap(options.calibration));
  } else {
    DEPTHFARM_ASSIGN_OR_RETURN(result.calibration, ReadCameraFile(options, size));
  }
  if (!format.tells_size || size.width == 0) return result;
  for (CalibratedCamera& camera : result.calibration.cameras) {
    Result<Camera> scaled = CameraOfSize(camera.camera, size);
    if (!scaled.ok()) return scaled.status().WithContext("--size");
    camera.camera = *std::move(scaled);
  }
  return result;
}

}  // namespace depthfarm
