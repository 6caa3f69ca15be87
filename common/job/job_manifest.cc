#include "common/job/job_manifest.h"

#include <cstdint>
#include <string>

#include "common/digest/sha256.h"

namespace depthfarm {
namespace {

const char* NameOf(PriorFormat::Holds holds) {
  switch (holds) {
    case PriorFormat::Holds::kNothing:
      break;
    case PriorFormat::Holds::kDepth:
      return "depth";
    case PriorFormat::Holds::kInverseDepth:
      return "inverse-depth";
    case PriorFormat::Holds::kRelativeDepth:
      return "relative-depth";
    case PriorFormat::Holds::kCodes:
      return "codes";
  }
  return "nothing";
}

std::map<std::string, ManifestNumberOrText> ParametersOf(const ResolvedJob& job) {
  const EstimationParams& params = job.params;
  const auto integer = [](int value) { return ManifestNumberOrText(static_cast<std::int64_t>(value)); };
  std::map<std::string, ManifestNumberOrText> parameters{
      {"reference", job.reference.name},
      {"levels", integer(params.levels)},
      {"zNear", params.z_near},
      {"zFar", params.z_far},
      {"smoothing", params.smoothing},
      {"matchingWindow", integer(params.matching_window)},
      {"matchingOffset", params.matching_offset},
      {"uniqueness", integer(params.uniqueness)},
      {"snicCompactness", params.snic_compactness},
      {"gop", integer(params.gop)},
      {"anchor", params.anchor == Anchor::kShared ? "shared" : "gop"},
      {"pThreshold", integer(params.p_threshold)},
      {"iThreshold", integer(params.i_threshold)},
      {"levelBlocksI", integer(job.level_blocks_i)},
      {"levelBlocksP", integer(job.level_blocks_p)},
      {"partition", params.partition == Partition::kContiguous ? "blocks" : "interleaved"},
      {"search", params.search == Search::kFull ? "full" : "sparse"},
      {"maxSweeps", integer(params.max_sweeps)},
      {"neighbours", integer(params.neighbours)},
      {"refineRounds", integer(params.refine_rounds)},
      {"choiceRounds", integer(params.choice_rounds)},
      {"compared", integer(params.compared)},
      {"holes", params.holes},
      {"downscale", integer(params.downscale)},
  };
  // Nothing in depth.json of maps that are as they always were.
  if (params.output_format != DepthFormat::kPng16)
    parameters["outputFormat"] = std::string(NameOf(params.output_format));
  for (const JobView& view : job.views) {
    parameters["segments/" + view.camera.name] = integer(view.segments);
    if (view.prior.holds != PriorFormat::Holds::kNothing)
      parameters["prior/" + view.camera.name] = std::string(NameOf(view.prior.holds));
    if (view.masked) parameters["mask/" + view.camera.name] = std::string("foreground");
  }
  return parameters;
}

Status AddFile(const OutputFile& file, const std::string& expected, std::vector<DepthManifestFile>& files) {
  if (file.path != expected) return InvalidArgument("manifest: file '" + file.path + "', expected '" + expected + "'");
  files.push_back({expected, Hex(file.sha256)});
  return {};
}

}  // namespace

std::string DepthFileOf(const ResolvedJob& job, const JobView& view, int in_sequence) {
  return DepthFileName(view.camera.name, in_sequence, ExtensionOf(job.params.output_format));
}

std::vector<std::string> FilesOfFrame(const ResolvedJob& job, int frame) {
  const int in_sequence = job.params.first_frame + frame;
  std::vector<std::string> paths;
  for (const JobView& view : job.views) paths.push_back(DepthFileOf(job, view, in_sequence));
  if (!job.params.confidence) return paths;
  for (const JobView& view : job.views) paths.push_back(ConfidenceFileName(view.camera.name, in_sequence));
  return paths;
}

Result<DepthManifest> ManifestOf(const JobConfig& config, const std::vector<OutputFile>& files,
                                 const std::vector<ContentDigest>& picture_digests) {
  const ResolvedJob& job = config.resolved;
  const auto num_frames = static_cast<std::size_t>(job.num_frames);
  const std::size_t num_views = job.views.size();
  const std::size_t maps = job.params.confidence ? 2 : 1;  // of a view and frame
  if (files.size() != num_frames * num_views * maps || picture_digests.size() != num_frames * num_views) {
    return InvalidArgument("manifest of " + std::to_string(num_frames) + " frames and " + std::to_string(num_views) +
                           " views: " + std::to_string(files.size()) + " files and " +
                           std::to_string(picture_digests.size()) + " picture digests, expected " +
                           std::to_string(num_frames * num_views * maps) + " and " +
                           std::to_string(num_frames * num_views));
  }
  DepthManifest manifest{.sequence = config.sequence_name,
                         .algorithm_version = config.algorithm_version,
                         .first_frame = job.params.first_frame,
                         .parameters = ParametersOf(job),
                         .cameras = {}};
  for (std::size_t v = 0; v < num_views; ++v) {
    const JobView& view = job.views[v];
    DepthManifestCamera camera{.camera = view.camera,
                               .z_near = view.own_range.z_near,
                               .z_far = view.own_range.z_far,
                               .files = {},
                               .confidence = {},
                               .input_sha256 = {}};
    for (std::size_t frame = 0; frame < num_frames; ++frame) {
      const int in_sequence = job.params.first_frame + static_cast<int>(frame);
      const std::size_t first_of_frame = frame * num_views * maps;
      DEPTHFARM_RETURN_IF_ERROR(AddFile(files[first_of_frame + v], DepthFileOf(job, view, in_sequence), camera.files));
      if (job.params.confidence) {
        DEPTHFARM_RETURN_IF_ERROR(AddFile(files[first_of_frame + num_views + v],
                                          ConfidenceFileName(view.camera.name, in_sequence), camera.confidence));
      }
      camera.input_sha256.push_back(Hex(picture_digests[frame * num_views + v]));
    }
    manifest.cameras.push_back(std::move(camera));
  }
  return manifest;
}

}  // namespace depthfarm
