#include "coordinator/importing/import_sequence.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "common/calibration/robust_range.h"
#include "common/files/atomic_file.h"
#include "common/files/writable_folder.h"
#include "common/geometry/neighbours.h"
#include "common/sequence/format_sequence.h"
#include "common/sequence/read_sequence.h"
#include "coordinator/importing/calibration_files.h"
#include "coordinator/importing/picture_files.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxSide = 32768;

std::string Number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

Result<PictureSize> ParseSize(const std::string& text) {
  PictureSize size;
  if (text.empty()) return size;
  const char* end = text.data() + text.size();
  const auto [middle, error] = std::from_chars(text.data(), end, size.width);
  bool good = error == std::errc() && middle != end && *middle == 'x';
  if (good) {
    const auto [rest, second_error] = std::from_chars(middle + 1, end, size.height);
    good = second_error == std::errc() && rest == end;
  }
  if (!good || size.width < 1 || size.height < 1 || size.width > kMaxSide || size.height > kMaxSide) {
    return InvalidArgument("--size is '" + text + "', expected WIDTHxHEIGHT of 1 to " + std::to_string(kMaxSide) +
                           " pixels, e.g. 1024x768");
  }
  return size;
}

Status CheckRangeOptions(const ImportOptions& options) {
  for (const auto& [name, value] : {std::pair{"--z-near", options.z_near}, std::pair{"--z-far", options.z_far}}) {
    if (!value || (std::isfinite(*value) && *value > 0)) continue;
    return InvalidArgument(
        std::string(name) + " is " + Number(*value) +
        ", expected a distance > 0 (of an ftv file with a scene at negative depth give the distances "
        "and --z-axis backward)");
  }
  if (options.z_near && options.z_far && *options.z_near >= *options.z_far) {
    return InvalidArgument("--z-near is " + Number(*options.z_near) + " and --z-far " + Number(*options.z_far) +
                           ", expected z-near < z-far");
  }
  return {};
}

Result<std::string> OutputFile(const ImportOptions& options) {
  std::error_code error;
  const fs::path file = fs::absolute(options.output, error).lexically_normal();
  if (options.output.empty() || error || file.filename().empty() || fs::is_directory(file, error)) {
    return InvalidArgument("-o is '" + options.output + "', expected the path of a sequence file, e.g. sequence.json");
  }
  if (fs::exists(file, error) && fs::equivalent(file, options.calibration, error)) {
    return InvalidArgument("-o is '" + options.output + "', which is the calibration: choose another name");
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckWritableFolder(file.parent_path().string()));
  return file.string();
}

// Leaves those that were asked for.
Status SelectCameras(const ImportOptions& options, ImportedCalibration& imported) {
  if (options.cameras.empty()) return {};
  std::vector<CalibratedCamera>& cameras = imported.calibration.cameras;
  ImportedCalibration selected;
  for (const std::string& name : options.cameras) {
    const auto found = std::ranges::find(cameras, name, [](const CalibratedCamera& c) { return c.camera.name; });
    if (found == cameras.end()) {
      return InvalidArgument("--cameras: " + options.calibration + " has no camera '" + name + "'; it has '" +
                             cameras.front().camera.name + "' to '" + cameras.back().camera.name + "'");
    }
    const bool twice = std::ranges::count(options.cameras, name) > 1;
    if (twice) return InvalidArgument("--cameras names '" + name + "' twice");
    selected.calibration.cameras.push_back(*found);
    if (imported.depths.empty()) continue;
    selected.depths.push_back(imported.depths[static_cast<std::size_t>(found - cameras.begin())]);
  }
  cameras = std::move(selected.calibration.cameras);
  imported.depths = std::move(selected.depths);
  return {};
}

// The cameras for which depth can be estimated: those with pictures, or where none has any, all.
std::vector<std::size_t> Views(const Sequence& sequence) {
  std::vector<std::size_t> views;
  std::vector<std::size_t> all;
  for (std::size_t i = 0; i < sequence.cameras.size(); ++i) {
    all.push_back(i);
    if (!sequence.cameras[i].images.empty()) views.push_back(i);
  }
  return views.empty() ? all : views;
}

// An index into the cameras of the sequence.
Result<std::size_t> Reference(const ImportOptions& options, const Sequence& sequence) {
  if (!options.reference.empty()) {
    const auto found = std::ranges::find(sequence.cameras, options.reference,
                                         [](const SequenceCamera& camera) { return camera.camera.name; });
    if (found != sequence.cameras.end()) return static_cast<std::size_t>(found - sequence.cameras.begin());
    return InvalidArgument("--reference is '" + options.reference + "', expected the name of a camera");
  }
  const std::vector<std::size_t> views = Views(sequence);
  std::vector<Camera> cameras;
  cameras.reserve(views.size());
  for (const std::size_t view : views) cameras.push_back(sequence.cameras[view].camera);
  return views[static_cast<std::size_t>(CentreCamera(cameras))];
}

// What the format tells of the depth before the reference; none where it tells nothing.
Result<std::optional<DepthRange>> RangeOfFormat(const ImportedCalibration& imported, const SequenceCamera& reference,
                                                std::size_t index) {
  if (reference.z_near && reference.z_far) {
    return std::optional<DepthRange>(DepthRange{.z_near = *reference.z_near, .z_far = *reference.z_far});
  }
  if (imported.depths.empty()) return std::optional<DepthRange>();
  Result<DepthRange> range = RobustRange(imported.depths[index]);
  if (!range.ok()) {
    return InvalidArgument("camera '" + reference.camera.name + "', the reference, " + range.status().message() +
                           ": give --z-near and --z-far, or another --reference");
  }
  return std::optional<DepthRange>(*range);
}

// Of the reference: the options', else the format's. What the options say is meant for all cameras.
Result<DepthRange> SetRange(const ImportOptions& options, const ImportedCalibration& imported, std::size_t reference,
                            Sequence& sequence) {
  DepthRange range;
  if (options.z_near && options.z_far) {
    range = {.z_near = *options.z_near, .z_far = *options.z_far};
  } else {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::optional<DepthRange> told,
                               RangeOfFormat(imported, sequence.cameras[reference], reference));
    if (!told) {
      const std::string missing = options.z_near ? "--z-far" : options.z_far ? "--z-near" : "--z-near and --z-far";
      return InvalidArgument(options.calibration + ": files of format " + options.format +
                             " do not tell the depth range: give " + missing +
                             ", distances along the axis of the reference camera in the calibration's unit of length");
    }
    range = {.z_near = options.z_near.value_or(told->z_near), .z_far = options.z_far.value_or(told->z_far)};
  }
  if (!(range.z_near < range.z_far)) {
    return InvalidArgument("the depth range is " + Number(range.z_near) + " to " + Number(range.z_far) +
                           ": give both --z-near and --z-far");
  }
  sequence.z_near = range.z_near;
  sequence.z_far = range.z_far;
  if (options.z_near || options.z_far) {
    for (SequenceCamera& camera : sequence.cameras) {
      camera.z_near.reset();
      camera.z_far.reset();
    }
  }
  return range;
}

Result<ArrayOverview> LookAt(const ImportOptions& options, const Sequence& sequence, std::size_t reference,
                             const DepthRange& range) {
  std::vector<std::size_t> views = Views(sequence);
  if (std::ranges::find(views, reference) == views.end()) views.push_back(reference);
  std::vector<Camera> cameras;
  std::size_t position = 0;
  for (const std::size_t view : views) {
    if (view == reference) position = cameras.size();
    cameras.push_back(sequence.cameras[view].camera);
  }
  Result<ArrayOverview> overview = LookAtArray(cameras, position, range);
  if (overview.ok()) return overview;
  std::string remedy = ": check the depth range, which is in the calibration's unit of length";
  if (options.format == "ftv") remedy += ", and what the file means: --pose, --z-axis";
  return InvalidArgument(options.calibration + ": " + overview.status().message() + remedy);
}

}  // namespace

Result<ImportedSequence> ImportSequence(const ImportOptions& options) {
  DEPTHFARM_ASSIGN_OR_RETURN(const CalibrationFormat format, FormatOf(options.format));
  DEPTHFARM_ASSIGN_OR_RETURN(const PictureSize size, ParseSize(options.size));
  DEPTHFARM_RETURN_IF_ERROR(CheckRangeOptions(options));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string output, OutputFile(options));
  DEPTHFARM_ASSIGN_OR_RETURN(ImportedCalibration imported, ReadCalibration(options, size));
  DEPTHFARM_RETURN_IF_ERROR(SelectCameras(options, imported));

  ImportedSequence result;
  Sequence& sequence = result.sequence;
  sequence.file = output;
  sequence.name = options.name;
  sequence.frame_rate = imported.calibration.frame_rate;
  DEPTHFARM_ASSIGN_OR_RETURN(sequence.cameras,
                             CamerasWithPictures(imported.calibration.cameras, format, options, output));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::size_t reference, Reference(options, sequence));
  sequence.reference = sequence.cameras[reference].camera.name;
  result.reference = sequence.cameras[reference].camera;
  DEPTHFARM_ASSIGN_OR_RETURN(result.range, SetRange(options, imported, reference, sequence));
  DEPTHFARM_ASSIGN_OR_RETURN(result.array, LookAt(options, sequence, reference, result.range));

  DEPTHFARM_ASSIGN_OR_RETURN(const std::string text, FormatSequence(sequence));
  DEPTHFARM_RETURN_IF_ERROR(ParseSequence(text, output, {.allow_outside = options.allow_outside}).status());
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(fs::path(output).parent_path().string()));
  DEPTHFARM_RETURN_IF_ERROR(WriteFileAtomically(output, text));
  return result;
}

}  // namespace depthfarm
