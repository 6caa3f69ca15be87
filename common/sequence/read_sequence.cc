#include "common/sequence/read_sequence.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>
#include <string_view>

#include "common/files/atomic_file.h"
#include "common/sequence/camera_fields.h"
#include "common/sequence/ground_truth_fields.h"
#include "common/sequence/json_fields.h"
#include "common/sequence/picture_format.h"

namespace depthfarm {
namespace {

Result<std::string> ResolvePath(const std::filesystem::path& folder, const std::string& path, const std::string& what,
                                bool allow_outside) {
  const auto bad = [&](const std::string& why) {
    return InvalidArgument(what + " is " + Shortened(Json(path)) + ", " + why);
  };
  if (path.empty()) return bad("expected the path of a file");
  if (HasControlCharacter(path)) return bad("expected a path without control characters");
  const std::filesystem::path relative = std::filesystem::path(path).lexically_normal();
  if (relative.filename().empty() || relative == "." || relative.filename() == "..") {
    return bad("expected a file, not a folder");
  }
  if (!allow_outside && relative.is_absolute()) {
    return bad("expected a path relative to the sequence file (--allow-outside accepts others)");
  }
  if (!allow_outside && *relative.begin() == "..") {
    return bad("expected a path that stays in the folder of the sequence file (--allow-outside accepts others)");
  }
  return (folder / relative).lexically_normal().string();
}

Result<bool> ReadChoice(const JsonFields& fields, std::string_view key, std::string_view no, std::string_view yes) {
  if (!fields.Has(key)) return false;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string word, fields.String(key));
  if (word == no) return false;
  if (word == yes) return true;
  return fields.Bad("'" + std::string(key) + "' is " + Shortened(Json(word)) + ", expected " + std::string(no) +
                    " or " + std::string(yes));
}

Status ReadColour(const JsonFields& fields, PictureFormat& format) {
  DEPTHFARM_ASSIGN_OR_RETURN(format.full_range, ReadChoice(fields, "range", "limited", "full"));
  DEPTHFARM_ASSIGN_OR_RETURN(format.bt709, ReadChoice(fields, "matrix", "bt601", "bt709"));
  return {};
}

// The 'format' of raw pictures. `others`: what files without one are.
Status ReadRawFormat(const JsonFields& fields, const std::string& others, PictureFormat& format) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string name, fields.String("format"));
  if (ParseRawFormat(name, &format)) return {};
  return fields.Bad("'format' is " + Shortened(Json(name)) + ", expected " + kRawFormatNames + ", or no 'format' for " +
                    others);
}

Result<PictureFormat> ReadFormat(const JsonFields& fields) {
  PictureFormat format;
  if (!fields.Has("format")) {
    for (const std::string_view key : {"range", "matrix"}) {
      if (fields.Has(key)) {
        return fields.Bad("'" + std::string(key) +
                          "' is given without 'format': it applies to raw pictures and videos only");
      }
    }
    return format;
  }
  DEPTHFARM_RETURN_IF_ERROR(ReadRawFormat(fields, "image files", format));
  DEPTHFARM_RETURN_IF_ERROR(ReadColour(fields, format));
  return format;
}

Status ReadRange(const JsonFields& fields, std::optional<double>* z_near, std::optional<double>* z_far) {
  if (fields.Has("zNear")) {
    DEPTHFARM_ASSIGN_OR_RETURN(*z_near, fields.Positive("zNear"));
  }
  if (fields.Has("zFar")) {
    DEPTHFARM_ASSIGN_OR_RETURN(*z_far, fields.Positive("zFar"));
  }
  return {};
}

Status CheckRange(const std::string& where, std::optional<double> z_near, std::optional<double> z_far) {
  if (!z_near || !z_far || *z_near < *z_far) return {};
  return InvalidArgument(where + ": zNear is " + Shortened(Json(*z_near)) + " and zFar " + Shortened(Json(*z_far)) +
                         ", expected zNear < zFar");
}

class SequenceReader {
 public:
  SequenceReader(std::filesystem::path file, const ReadSequenceOptions& options)
      : file_(std::move(file)), folder_(file_.parent_path()), where_(file_.string()), options_(options) {}

  Result<Sequence> Read(const Json& document) {
    static constexpr std::array<std::string_view, 9> kKeys = {
        "name", "convention", "zNear", "zFar", "frameRate", "reference", "notes", "cameras", "groundTruth"};
    DEPTHFARM_ASSIGN_OR_RETURN(const JsonFields fields, JsonFields::Of(document, where_, kKeys));
    DEPTHFARM_RETURN_IF_ERROR(ReadGeneral(fields));
    DEPTHFARM_ASSIGN_OR_RETURN(const Json* cameras, fields.Array("cameras", kMaxCameras));
    if (cameras->empty()) return fields.Bad("'cameras' is empty, expected at least one camera");
    for (std::size_t i = 0; i < cameras->size(); ++i) {
      DEPTHFARM_RETURN_IF_ERROR(ReadCamera((*cameras)[i], i));
    }
    DEPTHFARM_RETURN_IF_ERROR(CheckFrameCounts());
    DEPTHFARM_RETURN_IF_ERROR(CheckReference());
    if (fields.Has("groundTruth")) {
      DEPTHFARM_RETURN_IF_ERROR(ReadGroundTruth(fields));
    }
    return std::move(sequence_);
  }

 private:
  Status ReadGeneral(const JsonFields& fields) {
    sequence_.file = file_.string();
    sequence_.name = folder_.filename().empty() ? file_.stem().string() : folder_.filename().string();
    if (fields.Has("name")) {
      DEPTHFARM_ASSIGN_OR_RETURN(sequence_.name, fields.String("name"));
      if (sequence_.name.empty() || sequence_.name.size() > kMaxNameLength || HasControlCharacter(sequence_.name)) {
        return fields.Bad("'name' is " + Shortened(Json(sequence_.name)) + ", expected 1 to " +
                          std::to_string(kMaxNameLength) + " bytes without control characters");
      }
    }
    if (fields.Has("convention")) {
      DEPTHFARM_ASSIGN_OR_RETURN(const std::string convention, fields.String("convention"));
      if (convention != kSequenceConvention) {
        return fields.Bad("'convention' is " + Shortened(Json(convention)) + ", expected \"" + kSequenceConvention +
                          "\" (convert the cameras to it)");
      }
    }
    if (fields.Has("notes")) DEPTHFARM_RETURN_IF_ERROR(fields.String("notes").status());
    if (fields.Has("reference")) {
      DEPTHFARM_ASSIGN_OR_RETURN(sequence_.reference, fields.String("reference"));
    }
    if (fields.Has("frameRate")) {
      DEPTHFARM_ASSIGN_OR_RETURN(sequence_.frame_rate, fields.Positive("frameRate"));
    }
    DEPTHFARM_RETURN_IF_ERROR(ReadRange(fields, &sequence_.z_near, &sequence_.z_far));
    return CheckRange(where_, sequence_.z_near, sequence_.z_far);
  }

  Status ReadCamera(const Json& value, std::size_t index) {
    static constexpr std::array<std::string_view, 16> kKeys = {"name",   "width",  "height", "K",      "R",     "t",
                                                               "images", "format", "range",  "matrix", "zNear", "zFar",
                                                               "masks",  "depth",  "notes",  "video"};
    const std::string position = where_ + ": cameras[" + std::to_string(index) + "]";
    DEPTHFARM_ASSIGN_OR_RETURN(JsonFields fields, JsonFields::Of(value, CameraWhere(value, position), kKeys));
    SequenceCamera result;
    DEPTHFARM_RETURN_IF_ERROR(ReadCalibration(fields, position, &result));
    if (fields.Has("notes")) DEPTHFARM_RETURN_IF_ERROR(fields.String("notes").status());
    if (fields.Has("video")) {
      DEPTHFARM_RETURN_IF_ERROR(ReadVideo(fields, result));
    } else {
      DEPTHFARM_ASSIGN_OR_RETURN(result.format, ReadFormat(fields));
      DEPTHFARM_RETURN_IF_ERROR(fields.Value("images").status());
      DEPTHFARM_ASSIGN_OR_RETURN(result.images, Paths(fields, "images"));
    }
    DEPTHFARM_ASSIGN_OR_RETURN(result.masks, Paths(fields, "masks"));
    DEPTHFARM_ASSIGN_OR_RETURN(result.depth, Paths(fields, "depth"));
    DEPTHFARM_RETURN_IF_ERROR(ReadRange(fields, &result.z_near, &result.z_far));
    // A camera that gives one end takes the other from the sequence.
    DEPTHFARM_RETURN_IF_ERROR(CheckRange(fields.where(), result.z_near ? result.z_near : sequence_.z_near,
                                         result.z_far ? result.z_far : sequence_.z_far));
    sequence_.cameras.push_back(std::move(result));
    return {};
  }

  // {"path", "frames"} and, of raw pictures one after the other, "format"; range and matrix stand beside it, as those
  // of pictures do.
  Status ReadVideo(const JsonFields& camera, SequenceCamera& result) const {
    static constexpr std::array<std::string_view, 3> kKeys = {"path", "format", "frames"};
    if (camera.Has("images") || camera.Has("format"))
      return camera.Bad("has 'video' and 'images' or 'format', expected either a video or pictures");
    DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, camera.Value("video"));
    DEPTHFARM_ASSIGN_OR_RETURN(const JsonFields video, JsonFields::Of(*value, camera.where() + ": 'video'", kKeys));
    DEPTHFARM_ASSIGN_OR_RETURN(std::string path, video.String("path"));
    DEPTHFARM_ASSIGN_OR_RETURN(path, ResolvePath(folder_, path, video.where() + ": 'path'", options_.allow_outside));
    if (video.Has("format")) {
      DEPTHFARM_RETURN_IF_ERROR(ReadRawFormat(video, "coded videos (mp4, mkv, y4m, ...)", result.format));
      result.format.all_frames = true;
    } else {
      result.format.kind = PictureFormat::Kind::kVideo;
      result.format.colour_said = camera.Has("range");
      if (camera.Has("range") != camera.Has("matrix"))
        return camera.Bad("has one of 'range' and 'matrix', expected both, or none to take what the video says");
    }
    DEPTHFARM_RETURN_IF_ERROR(ReadColour(camera, result.format));
    std::int64_t frames = 0;
    if (video.Has("frames") || !result.format.raw()) {
      DEPTHFARM_ASSIGN_OR_RETURN(frames, video.Integer("frames", 1, kMaxFrames));
    } else {
      DEPTHFARM_ASSIGN_OR_RETURN(frames, RawFramesOf(video, path, result));
    }
    result.images.assign(static_cast<std::size_t>(frames), path);
    return {};
  }

  // Pictures that a file of raw ones holds.
  static Result<std::int64_t> RawFramesOf(const JsonFields& video, const std::string& path,
                                          const SequenceCamera& camera) {
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(path, error);
    if (error) return video.Bad("has no 'frames', and " + path + " cannot be looked at: " + error.message());
    const std::uint64_t picture = RawPictureBytes(camera.format, camera.camera.width, camera.camera.height);
    if (bytes == 0 || bytes % picture != 0 || bytes / picture > kMaxFrames) {
      return video.Bad("has no 'frames', and " + path + " holds " + std::to_string(bytes) + " bytes, expected 1 to " +
                       std::to_string(kMaxFrames) + " pictures of " + std::to_string(picture) + " (" +
                       std::to_string(camera.camera.width) + "x" + std::to_string(camera.camera.height) + " " +
                       RawFormatName(camera.format) + ")");
    }
    return static_cast<std::int64_t>(bytes / picture);
  }

  Status ReadCalibration(const JsonFields& fields, const std::string& position, SequenceCamera* result) {
    DEPTHFARM_ASSIGN_OR_RETURN(result->camera, ReadCameraFields(fields, position));
    if (!names_.insert(result->camera.name).second) {
      return InvalidArgument(position + ": 'name' is '" + result->camera.name +
                             "', which an earlier camera has already");
    }
    return ValidateCamera(result->camera).WithContext(where_);
  }

  Result<std::vector<std::string>> Paths(const JsonFields& fields, std::string_view key) const {
    if (!fields.Has(key)) return std::vector<std::string>();
    DEPTHFARM_ASSIGN_OR_RETURN(std::vector<std::string> paths, fields.Strings(key, kMaxFrames));
    for (std::size_t frame = 0; frame < paths.size(); ++frame) {
      const std::string what = fields.where() + ": '" + std::string(key) + "' of frame " + std::to_string(frame);
      DEPTHFARM_ASSIGN_OR_RETURN(paths[frame], ResolvePath(folder_, paths[frame], what, options_.allow_outside));
    }
    return paths;
  }

  // Every list that is not empty has one entry per frame: position f is frame f for all cameras.
  Status CheckFrameCounts() {
    const SequenceCamera* first = nullptr;
    for (const SequenceCamera& camera : sequence_.cameras) {
      if (camera.images.empty()) continue;
      if (first == nullptr) first = &camera;
      if (camera.images.size() != first->images.size()) {
        return InvalidArgument(where_ + ": camera '" + camera.camera.name + "' has " +
                               std::to_string(camera.images.size()) + " images and camera '" + first->camera.name +
                               "' has " + std::to_string(first->images.size()) +
                               ", expected one per frame for both, or none for a camera without pictures");
      }
    }
    num_frames_ = first == nullptr ? 0 : first->images.size();
    for (const SequenceCamera& camera : sequence_.cameras) {
      for (const auto& [key, paths] : {std::pair{"masks", &camera.masks}, std::pair{"depth", &camera.depth}}) {
        if (paths->empty() || first == nullptr || paths->size() == num_frames_) continue;
        return InvalidArgument(where_ + ": camera '" + camera.camera.name + "': '" + key + "' has " +
                               std::to_string(paths->size()) + " entries, expected one per frame, " +
                               std::to_string(num_frames_));
      }
    }
    return {};
  }

  Status CheckReference() const {
    if (sequence_.reference.empty() || names_.contains(sequence_.reference)) return {};
    return InvalidArgument(where_ + ": 'reference' is '" + sequence_.reference + "', expected the name of a camera");
  }

  Status ReadGroundTruth(const JsonFields& fields) {
    GroundTruthContext context;
    context.where = where_ + ": groundTruth";
    context.num_frames = num_frames_;
    context.resolve = [this](const std::string& path, const std::string& what) {
      return ResolvePath(folder_, path, what, options_.allow_outside);
    };
    if (fields.Has("x-disparityOffset")) {
      DEPTHFARM_ASSIGN_OR_RETURN(context.disparity_offset, fields.Number("x-disparityOffset"));
    }
    DEPTHFARM_ASSIGN_OR_RETURN(const Json* value, fields.Value("groundTruth"));
    return ReadGroundTruthFields(*value, context, &sequence_);
  }

  std::filesystem::path file_;
  std::filesystem::path folder_;
  std::string where_;
  ReadSequenceOptions options_;
  Sequence sequence_;
  std::set<std::string> names_;
  std::size_t num_frames_ = 0;
};

}  // namespace

Result<Sequence> ParseSequence(std::string_view text, const std::string& file, const ReadSequenceOptions& options) {
  const auto document = ParseStrictJson(text);
  if (!document.ok()) return document.status().WithContext(file);
  return SequenceReader(file, options).Read(*document);
}

Result<Sequence> ReadSequence(const std::string& file, const ReadSequenceOptions& options) {
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(file, error).lexically_normal();
  if (file.empty() || error) return InvalidArgument("sequence file '" + file + "': expected the path of a JSON file");
  const auto text = ReadFileBytes(absolute.string(), std::uint64_t{kMaxSequenceFileMib} << 20);
  if (!text.ok()) return InvalidArgument("sequence file " + text.status().message());
  return ParseSequence(*text, absolute.string(), options);
}

}  // namespace depthfarm
