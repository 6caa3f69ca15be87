#include "coordinator/importing/picture_files.h"

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <optional>
#include <system_error>

#include "common/sequence/picture_format.h"
#include "common/sequence/read_sequence.h"
#include "coordinator/importing/picture_pattern.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

Result<PictureFormat> ParsePictureFormat(const ImportOptions& options) {
  PictureFormat format;
  if (options.pixel_format.empty()) {
    if (options.range.empty() && options.matrix.empty()) return format;
    return InvalidArgument("--range and --matrix are of raw pictures: give --pixel-format too");
  }
  if (!ParseRawFormat(options.pixel_format, &format)) {
    return InvalidArgument("--pixel-format is '" + options.pixel_format + "', expected one of " + kRawFormatNames +
                           "; image files need none");
  }
  format.full_range = options.range == "full";
  format.bt709 = options.matrix == "bt709";
  return format;
}

struct Frames {
  int first = 0;
  int count = 1;
};

Result<Frames> ParseFrames(const std::string& text) {
  const auto bad = InvalidArgument("--frames is '" + text + "', expected A:B with 0 <= A < B, at most " +
                                   std::to_string(kMaxFrames) + " frames, e.g. 0:50 for frames 0 to 49");
  Frames frames;
  int end = 0;
  const char* stop = text.data() + text.size();
  const auto [colon, error] = std::from_chars(text.data(), stop, frames.first);
  if (error != std::errc() || colon == stop || *colon != ':') return bad;
  const auto [rest, end_error] = std::from_chars(colon + 1, stop, end);
  if (end_error != std::errc() || rest != stop || frames.first < 0 || end <= frames.first ||
      end - frames.first > kMaxFrames) {
    return bad;
  }
  frames.count = end - frames.first;
  return frames;
}

// The paths of a camera's pictures, one for each frame.
class PictureNames {
 public:
  static Result<PictureNames> Of(const CalibrationFormat& format, const ImportOptions& options, bool many_cameras) {
    PictureNames names;
    if (!PicturePattern::IsPattern(options.images)) {
      if (!format.names_pictures) {
        return InvalidArgument(
            "--images is '" + options.images + "': format " + format.name +
            " names no pictures, so it needs {camera} or {number}, e.g. 'cam{number}/{frame:04}.png'");
      }
      if (!options.frames.empty()) {
        return InvalidArgument("--frames needs {frame} in --images; of format " + std::string(format.name) +
                               " each picture is the only frame of a camera");
      }
      names.folder_ = options.images;
      return names;
    }
    DEPTHFARM_ASSIGN_OR_RETURN(names.pattern_, PicturePattern::Parse(options.images));
    if (many_cameras && !names.pattern_->tells_cameras_apart()) {
      return InvalidArgument("--images is '" + options.images +
                             "', which is the same for all cameras: it needs {camera} or {number}");
    }
    if (names.pattern_->has_frames() == options.frames.empty()) {
      return InvalidArgument(options.frames.empty()
                                 ? "--images has {frame}: give --frames A:B, e.g. --frames 0:50 for frames 0 to 49"
                                 : "--frames needs {frame} in --images");
    }
    if (!options.frames.empty()) {
      DEPTHFARM_ASSIGN_OR_RETURN(names.frames_, ParseFrames(options.frames));
    }
    return names;
  }

  [[nodiscard]] Result<std::vector<std::string>> PathsOf(const CalibratedCamera& camera) const {
    if (!pattern_) return std::vector<std::string>{(fs::path(folder_) / camera.picture).string()};
    std::vector<std::string> paths;
    for (int frame = 0; frame < frames_.count; ++frame) {
      DEPTHFARM_ASSIGN_OR_RETURN(std::string path, pattern_->PathOf(camera.camera.name, frames_.first + frame));
      paths.push_back(std::move(path));
    }
    return paths;
  }

 private:
  std::string folder_;
  std::optional<PicturePattern> pattern_;  // none: picture names in folder_
  Frames frames_;
};

bool IsThere(const std::string& path) {
  std::error_code error;
  return fs::exists(fs::status(path, error));
}

// "camera 'left': picture /a/b.png: <what>".
Status BadPicture(const SequenceCamera& camera, const std::string& path, const std::string& what) {
  return InvalidArgument("camera '" + camera.camera.name + "': picture " + path + ": " + what);
}

Status CheckFile(const SequenceCamera& camera, const std::string& path) {
  const auto bad = [&](const std::string& what) { return BadPicture(camera, path, what); };
  std::error_code error;
  if (!IsThere(path)) {
    return bad(
        "is not there: correct --images, choose cameras with --cameras, or give --allow-missing to keep "
        "cameras without pictures, for which no depth is estimated");
  }
  if (!fs::is_regular_file(path, error)) return bad("is no file");
  const std::uint64_t bytes = fs::file_size(path, error);
  if (error) return bad(error.message());
  if (bytes == 0) return bad("is empty");
  if (camera.format.kind == PictureFormat::Kind::kImage) return {};
  const std::uint64_t expected = RawPictureBytes(camera.format, camera.camera.width, camera.camera.height);
  if (bytes == expected) return {};
  const std::string size = std::to_string(camera.camera.width) + "x" + std::to_string(camera.camera.height);
  std::string what = "holds " + std::to_string(bytes) + " bytes, expected " + std::to_string(expected) +
                     " for one picture of " + size + " " + RawFormatName(camera.format);
  if (bytes % expected == 0) {
    what += ": it may hold " + std::to_string(bytes / expected) +
            " frames, and a sequence has a file for each: split it, e.g. with split -b " + std::to_string(expected);
  }
  return bad(what);
}

// Makes paths absolute and checks them.
Status SetPictures(const std::vector<std::string>& paths, const ImportOptions& options, const std::string& output,
                   SequenceCamera& camera) {
  if (options.allow_missing && std::ranges::none_of(paths, IsThere)) return {};
  const fs::path folder = fs::path(output).parent_path();
  for (const std::string& path : paths) {
    DEPTHFARM_RETURN_IF_ERROR(CheckFile(camera, path));
    std::error_code error;
    const fs::path absolute = fs::absolute(path, error).lexically_normal();
    if (error) return BadPicture(camera, path, error.message());
    if (absolute == output)
      return BadPicture(camera, path, "would be replaced by the sequence file: choose another -o");
    const fs::path relative = absolute.lexically_relative(folder);
    if (!options.allow_outside && (relative.empty() || *relative.begin() == "..")) {
      return BadPicture(camera, path,
                        "is not below " + folder.string() +
                            ", the folder of the sequence file: write that beside the pictures, or give "
                            "--allow-outside here and to the commands that read it");
    }
    camera.images.push_back(absolute.string());
  }
  return {};
}

}  // namespace

Result<std::vector<SequenceCamera>> CamerasWithPictures(const std::vector<CalibratedCamera>& cameras,
                                                        const CalibrationFormat& format, const ImportOptions& options,
                                                        const std::string& output) {
  DEPTHFARM_ASSIGN_OR_RETURN(const PictureFormat picture_format, ParsePictureFormat(options));
  if (options.images.empty() && !(options.frames.empty() && options.pixel_format.empty())) {
    return InvalidArgument("--frames and --pixel-format are of pictures: give --images too");
  }
  PictureNames names;
  if (!options.images.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(names, PictureNames::Of(format, options, cameras.size() > 1));
  }
  std::vector<SequenceCamera> result;
  std::map<std::string, std::string> camera_of_first_picture;
  for (const CalibratedCamera& camera : cameras) {
    SequenceCamera& entry = result.emplace_back();
    entry.camera = camera.camera;
    entry.z_near = camera.z_near;
    entry.z_far = camera.z_far;
    if (options.images.empty()) continue;
    entry.format = picture_format;
    DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<std::string> paths, names.PathsOf(camera));
    DEPTHFARM_RETURN_IF_ERROR(SetPictures(paths, options, output, entry));
    if (entry.images.empty()) continue;
    const auto [other, is_new] = camera_of_first_picture.emplace(entry.images.front(), camera.camera.name);
    if (!is_new) {
      return BadPicture(
          entry, entry.images.front(),
          "is that of camera '" + other->second + "' too: choose cameras with --cameras, or use {camera}");
    }
  }
  if (!options.images.empty() && camera_of_first_picture.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<std::string> paths, names.PathsOf(cameras.front()));
    return InvalidArgument("no camera has pictures: correct --images, by which the first one of camera '" +
                           cameras.front().camera.name + "' is " + paths.front());
  }
  return result;
}

}  // namespace depthfarm
