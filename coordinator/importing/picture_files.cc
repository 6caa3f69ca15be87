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
  format.full_range = options.range == "full";
  format.bt709 = options.matrix == "bt709";
  if (!options.pixel_format.empty()) {
    format.all_frames = !options.videos.empty();
    if (ParseRawFormat(options.pixel_format, &format)) return format;
    return InvalidArgument("--pixel-format is '" + options.pixel_format + "', expected one of " + kRawFormatNames +
                           "; image files and other videos need none");
  }
  const bool colour_said = !options.range.empty() || !options.matrix.empty();
  if (options.videos.empty()) {
    if (!colour_said) return format;
    return InvalidArgument("--range and --matrix are of raw pictures and videos: give --pixel-format or --videos too");
  }
  if (options.range.empty() != options.matrix.empty()) {
    return InvalidArgument("of videos --range and --matrix are given both, or none to take what they say");
  }
  format.kind = PictureFormat::Kind::kVideo;
  format.colour_said = colour_said;
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
    if (!options.videos.empty()) return OfVideos(options, many_cameras);
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
    DEPTHFARM_RETURN_IF_ERROR(names.CheckTellsApart("--images", options.images, many_cameras));
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

  // The file of all frames of a camera, and how many those are where that is said.
  [[nodiscard]] Result<std::string> VideoOf(const CalibratedCamera& camera) const {
    return pattern_->PathOf(camera.camera.name, 0);
  }
  [[nodiscard]] const std::optional<Frames>& video_frames() const { return video_frames_; }

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
  static Result<PictureNames> OfVideos(const ImportOptions& options, bool many_cameras) {
    PictureNames names;
    if (!options.images.empty())
      return InvalidArgument("--images and --videos are given: a camera has one or the other");
    DEPTHFARM_ASSIGN_OR_RETURN(names.pattern_, PicturePattern::Parse(options.videos));
    DEPTHFARM_RETURN_IF_ERROR(names.CheckTellsApart("--videos", options.videos, many_cameras));
    if (names.pattern_->has_frames())
      return InvalidArgument("--videos is '" + options.videos + "': a video has all frames, {frame} is of --images");
    if (!options.frames.empty()) {
      DEPTHFARM_ASSIGN_OR_RETURN(names.video_frames_, ParseFrames(options.frames));
      if (names.video_frames_->first != 0)
        return InvalidArgument("--frames is '" + options.frames +
                               "': of videos it begins with 0; choose frames with --frames of run");
    } else if (options.pixel_format.empty()) {
      return InvalidArgument(
          "--videos needs --frames 0:B, how many frames they have, e.g. by ffprobe -v error -select_streams v:0 "
          "-count_packets -show_entries stream=nb_read_packets -of csv=p=0 FILE");
    }
    return names;
  }
  [[nodiscard]] Status CheckTellsApart(const std::string& option, const std::string& text, bool many_cameras) const {
    if (!many_cameras || pattern_->tells_cameras_apart()) return {};
    return InvalidArgument(option + " is '" + text +
                           "', which is the same for all cameras: it needs {camera} or {number}");
  }

  std::string folder_;
  std::optional<PicturePattern> pattern_;  // none: picture names in folder_
  Frames frames_;
  std::optional<Frames> video_frames_;
};

bool IsThere(const std::string& path) {
  std::error_code error;
  return fs::exists(fs::status(path, error));
}

// "camera 'left': picture /a/b.png: <what>".
Status BadPicture(const SequenceCamera& camera, const std::string& path, const std::string& what) {
  return InvalidArgument("camera '" + camera.camera.name + "': picture " + path + ": " + what);
}

// Bytes of a file that is there and is not empty. `option`: what names it.
Result<std::uint64_t> SizeOf(const SequenceCamera& camera, const std::string& path, const std::string& option) {
  const auto bad = [&](const std::string& what) { return BadPicture(camera, path, what); };
  std::error_code error;
  if (!IsThere(path)) {
    return bad("is not there: correct " + option +
               ", choose cameras with --cameras, or give --allow-missing to keep "
               "cameras without pictures, for which no depth is estimated");
  }
  if (!fs::is_regular_file(path, error)) return bad("is no file");
  const std::uint64_t bytes = fs::file_size(path, error);
  if (error) return bad(error.message());
  if (bytes == 0) return bad("is empty");
  return bytes;
}

// "1234 bytes, expected 300 for one picture of 20x10 yuv420p8".
std::string RawSizeText(const SequenceCamera& camera, std::uint64_t bytes, std::uint64_t expected) {
  return std::to_string(bytes) + " bytes, expected " + std::to_string(expected) + " for one picture of " +
         std::to_string(camera.camera.width) + "x" + std::to_string(camera.camera.height) + " " +
         RawFormatName(camera.format);
}

Status CheckFile(const SequenceCamera& camera, const std::string& path) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t bytes, SizeOf(camera, path, "--images"));
  if (!camera.format.raw()) return {};
  const std::uint64_t expected = RawPictureBytes(camera.format, camera.camera.width, camera.camera.height);
  if (bytes == expected) return {};
  std::string what = "holds " + RawSizeText(camera, bytes, expected);
  if (bytes % expected == 0)
    what += ": it may hold " + std::to_string(bytes / expected) + " frames; then name it with --videos";
  return BadPicture(camera, path, what);
}

// Frames of a video: as asked for, else what a raw one holds.
Result<int> FramesOf(const SequenceCamera& camera, const std::string& path, const std::optional<Frames>& asked) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t bytes, SizeOf(camera, path, "--videos"));
  if (!camera.format.raw()) return asked->count;
  const std::uint64_t expected = RawPictureBytes(camera.format, camera.camera.width, camera.camera.height);
  const std::uint64_t frames = bytes / expected;
  if (bytes % expected != 0 || frames > static_cast<std::uint64_t>(kMaxFrames)) {
    return BadPicture(
        camera, path,
        "holds " + RawSizeText(camera, bytes, expected) + ", or 1 to " + std::to_string(kMaxFrames) + " times as many");
  }
  if (!asked) return static_cast<int>(frames);
  if (frames < static_cast<std::uint64_t>(asked->count)) {
    return BadPicture(camera, path,
                      "holds " + std::to_string(frames) + " frames, --frames asks for " + std::to_string(asked->count));
  }
  return asked->count;
}

// The path as sequence files have it.
Result<std::string> AbsolutePath(const SequenceCamera& camera, const std::string& path, const ImportOptions& options,
                                 const std::string& output) {
  const fs::path folder = fs::path(output).parent_path();
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error).lexically_normal();
  if (error) return BadPicture(camera, path, error.message());
  if (absolute == output) return BadPicture(camera, path, "would be replaced by the sequence file: choose another -o");
  const fs::path relative = absolute.lexically_relative(folder);
  if (!options.allow_outside && (relative.empty() || *relative.begin() == "..")) {
    return BadPicture(camera, path,
                      "is not below " + folder.string() +
                          ", the folder of the sequence file: write that beside the pictures, or give "
                          "--allow-outside here and to the commands that read it");
  }
  return absolute.string();
}

// Makes paths absolute and checks them.
Status SetPictures(const std::vector<std::string>& paths, const ImportOptions& options, const std::string& output,
                   SequenceCamera& camera) {
  if (options.allow_missing && std::ranges::none_of(paths, IsThere)) return {};
  for (const std::string& path : paths) {
    DEPTHFARM_RETURN_IF_ERROR(CheckFile(camera, path));
    DEPTHFARM_ASSIGN_OR_RETURN(std::string absolute, AbsolutePath(camera, path, options, output));
    camera.images.push_back(std::move(absolute));
  }
  return {};
}

// The same of a file of all frames.
Status SetVideo(const std::string& path, const std::optional<Frames>& frames, const ImportOptions& options,
                const std::string& output, SequenceCamera& camera) {
  if (options.allow_missing && !IsThere(path)) return {};
  DEPTHFARM_ASSIGN_OR_RETURN(const int count, FramesOf(camera, path, frames));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string absolute, AbsolutePath(camera, path, options, output));
  camera.images.assign(static_cast<std::size_t>(count), absolute);
  return {};
}

}  // namespace

Result<std::vector<SequenceCamera>> CamerasWithPictures(const std::vector<CalibratedCamera>& cameras,
                                                        const CalibrationFormat& format, const ImportOptions& options,
                                                        const std::string& output) {
  DEPTHFARM_ASSIGN_OR_RETURN(const PictureFormat picture_format, ParsePictureFormat(options));
  const bool with_pictures = !(options.images.empty() && options.videos.empty());
  if (!with_pictures && !(options.frames.empty() && options.pixel_format.empty())) {
    return InvalidArgument("--frames and --pixel-format are of pictures: give --images or --videos too");
  }
  PictureNames names;
  if (with_pictures) {
    DEPTHFARM_ASSIGN_OR_RETURN(names, PictureNames::Of(format, options, cameras.size() > 1));
  }
  std::vector<SequenceCamera> result;
  std::map<std::string, std::string> camera_of_first_picture;
  for (const CalibratedCamera& camera : cameras) {
    SequenceCamera& entry = result.emplace_back();
    entry.camera = camera.camera;
    entry.z_near = camera.z_near;
    entry.z_far = camera.z_far;
    if (!with_pictures) continue;
    entry.format = picture_format;
    if (picture_format.of_all_frames()) {
      DEPTHFARM_ASSIGN_OR_RETURN(const std::string path, names.VideoOf(camera));
      DEPTHFARM_RETURN_IF_ERROR(SetVideo(path, names.video_frames(), options, output, entry));
    } else {
      DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<std::string> paths, names.PathsOf(camera));
      DEPTHFARM_RETURN_IF_ERROR(SetPictures(paths, options, output, entry));
    }
    if (entry.images.empty()) continue;
    const auto [other, is_new] = camera_of_first_picture.emplace(entry.images.front(), camera.camera.name);
    if (!is_new) {
      return BadPicture(
          entry, entry.images.front(),
          "is that of camera '" + other->second + "' too: choose cameras with --cameras, or use {camera}");
    }
  }
  if (with_pictures && camera_of_first_picture.empty()) {
    const bool videos = picture_format.of_all_frames();
    DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<std::string> paths, names.PathsOf(cameras.front()));
    return InvalidArgument(std::string("no camera has pictures: correct ") + (videos ? "--videos" : "--images") +
                           ", by which the first one of camera '" + cameras.front().camera.name + "' is " +
                           paths.front());
  }
  return result;
}

}  // namespace depthfarm
