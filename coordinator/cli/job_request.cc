#include "coordinator/cli/job_request.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "common/sequence/guides.h"
#include "common/sequence/output_layout.h"
#include "common/sequence/picture_format.h"
#include "common/sequence/read_sequence.h"
#include "common/text/text_table.h"

namespace depthfarm {
namespace {

std::string SizeOf(const Camera& camera) { return std::to_string(camera.width) + "x" + std::to_string(camera.height); }

// The sequence with the files that guide the estimation, if any are asked for.
Status AddGuides(const EstimationParams& params, Sequence& sequence) {
  if (!params.prior.empty()) DEPTHFARM_RETURN_IF_ERROR(AddPriors(params.prior, sequence));
  if (params.mask == "sequence") {
    for (const SequenceCamera& camera : sequence.cameras)
      if (!camera.masks.empty()) return {};
    return InvalidArgument(sequence.file + ": no camera has 'masks', which --mask sequence asks for");
  }
  for (SequenceCamera& camera : sequence.cameras) camera.masks.clear();
  return params.mask.empty() ? Status() : AddMasks(params.mask, sequence);
}

std::string BlocksText(const ResolvedJob& job) {
  std::string text = "n = " + std::to_string(job.level_blocks_i);
  if (job.HasPFrames() && job.level_blocks_p != job.level_blocks_i) {
    text += " (P frames " + std::to_string(job.level_blocks_p) + ")";
  }
  if (job.level_blocks_i > 1) {
    text += job.params.partition == Partition::kInterleaved ? " interleaved" : " blocks";
  }
  return text;
}

// Which views are guided: a name that fits no camera shows here.
std::string GuidesText(const ResolvedJob& job) {
  const auto priors = std::ranges::count_if(
      job.views, [](const JobView& view) { return view.prior.holds != PriorFormat::Holds::kNothing; });
  const auto masks = std::ranges::count_if(job.views, &JobView::masked);
  std::string text;
  if (priors > 0) text += ", prior depth of " + std::to_string(priors);
  if (masks > 0) text += ", masks of " + std::to_string(masks);
  return text;
}

// What can be said of a file without decoding it. `what`: picture, video or mask.
Status CheckFile(const std::string& camera, int frame, const char* what, const std::string& file) {
  const auto bad = [&](const std::string& reason) {
    return InvalidArgument("camera '" + camera + "', frame " + std::to_string(frame) + ": " + what + " " + file + ": " +
                           reason);
  };
  std::error_code error;
  const bool regular = std::filesystem::is_regular_file(file, error);
  if (!regular) return bad(error ? error.message() : "not a regular file");
  if (::access(file.c_str(), R_OK) != 0) return bad(std::generic_category().message(errno));
  if (std::filesystem::file_size(file, error) == 0) return bad("is empty");
  return {};
}

Status CheckPicture(const SequenceCamera& camera, int frame) {
  const std::string& path = camera.images[static_cast<std::size_t>(frame)];
  const bool video = camera.format.of_all_frames();
  DEPTHFARM_RETURN_IF_ERROR(CheckFile(camera.camera.name, frame, video ? "video" : "picture", path));
  if (!camera.format.all_frames) return {};
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  const std::uint64_t picture = RawPictureBytes(camera.format, camera.camera.width, camera.camera.height);
  if (error || bytes / picture > static_cast<std::uint64_t>(frame)) return {};  // read errors are the worker's to tell
  return InvalidArgument("camera '" + camera.camera.name + "', frame " + std::to_string(frame) + ": video " + path +
                         " holds " + std::to_string(bytes / picture) + " pictures of " +
                         std::to_string(camera.camera.width) + "x" + std::to_string(camera.camera.height) + " " +
                         RawFormatName(camera.format));
}

}  // namespace

Status CheckPictures(const Sequence& sequence, const ResolvedJob& job) {
  for (int frame = 0; frame < job.num_frames; ++frame) {
    const int sequence_frame = job.params.first_frame + frame;
    for (const JobView& view : job.views) {
      const auto source = std::ranges::find(sequence.cameras, view.camera.name,
                                            [](const SequenceCamera& camera) { return camera.camera.name; });
      if (source == sequence.cameras.end() || sequence_frame >= static_cast<int>(source->images.size())) continue;
      const auto position = static_cast<std::size_t>(sequence_frame);
      DEPTHFARM_RETURN_IF_ERROR(CheckPicture(*source, sequence_frame));
      if (position >= source->masks.size() || source->masks[position].empty()) continue;
      DEPTHFARM_RETURN_IF_ERROR(CheckFile(view.camera.name, sequence_frame, "mask", source->masks[position]));
    }
  }
  return {};
}

Status CheckOutputFolder(const std::string& output_dir) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path folder(output_dir);
  const fs::file_status status = fs::status(folder, error);
  if (!fs::exists(status)) return {};
  if (!fs::is_directory(status)) return InvalidArgument("output folder " + output_dir + " is a file");
  const bool has_depth = fs::exists(folder / kDepthFolder, error);
  const bool ours = fs::exists(folder / kDepthManifestName, error) || fs::exists(folder / kDepthJobMarker, error);
  if (has_depth && !ours) {
    return InvalidArgument("output folder " + output_dir +
                           " has a 'depth' that no job of depthfarm made; choose another folder or remove it");
  }
  return {};
}

std::string DescribeJob(const ResolvedJob& job) {
  long segments = 0;
  for (const JobView& view : job.views) segments += view.segments;
  const Camera& first = job.views.front().camera;
  const bool same_size = std::ranges::all_of(job.views, [&](const JobView& view) {
    return view.camera.width == first.width && view.camera.height == first.height;
  });
  const int first_frame = job.params.first_frame;
  return std::to_string(job.num_views()) + " views " + (same_size ? SizeOf(first) : "of different sizes") + ", " +
         WithThousands(segments) + " segments, " + std::to_string(job.params.levels) + " levels, " + BlocksText(job) +
         ", frames " + std::to_string(first_frame) + " to " + std::to_string(first_frame + job.num_frames - 1) +
         GuidesText(job);
}

Result<JobRequest> ReadJobRequest(const JobArguments& arguments) {
  JobRequest request;
  DEPTHFARM_ASSIGN_OR_RETURN(request.params, BuildEstimationParams(arguments.estimation));
  DEPTHFARM_ASSIGN_OR_RETURN(request.sequence,
                             ReadSequence(arguments.sequence, {.allow_outside = arguments.allow_outside}));
  DEPTHFARM_RETURN_IF_ERROR(AddGuides(request.params, request.sequence));
  auto resolved = ResolveJob(request.sequence, request.params);
  if (!resolved.ok()) return resolved.status().WithContext(request.sequence.file);
  request.resolved = std::move(resolved).value();
  DEPTHFARM_RETURN_IF_ERROR(CheckPictures(request.sequence, request.resolved));
  return request;
}

Result<JobRequest> PrepareJobRequest(const JobArguments& arguments) {
  DEPTHFARM_ASSIGN_OR_RETURN(JobRequest request, ReadJobRequest(arguments));
  if (arguments.output_dir.empty()) return InvalidArgument("output folder '': expected the path of a folder");
  std::error_code error;
  const std::filesystem::path absolute = std::filesystem::absolute(arguments.output_dir, error);
  if (error) return InvalidArgument("output folder " + arguments.output_dir + ": " + error.message());
  request.output_dir = absolute.lexically_normal().string();
  DEPTHFARM_RETURN_IF_ERROR(CheckOutputFolder(request.output_dir));
  return request;
}

}  // namespace depthfarm
