#include "worker/media_cli/submit_views.h"

#include <filesystem>
#include <system_error>
#include <vector>

#include "common/sequence/output_layout.h"
#include "common/wire/render_wire.h"
#include "worker/media_cli/virtual_views.h"
#include "worker/rendering/source_views.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

Result<std::string> Absolute(const std::string& what, const std::string& path) {
  std::error_code error;
  const fs::path absolute = fs::absolute(path, error);
  if (error) return InvalidArgument(what + " " + path + ": " + error.message());
  return absolute.lexically_normal().string();
}

Status CheckOutput(const std::string& output) {
  const fs::path folder(output);
  if (!folder.extension().empty() && !fs::is_directory(folder)) {
    return InvalidArgument("output '" + output + "': a farm writes PNG pictures, expected a folder");
  }
  std::error_code ignored;
  if (fs::exists(folder, ignored) && !fs::is_directory(folder, ignored)) {
    return InvalidArgument("output folder " + output + " is a file");
  }
  const bool ours = fs::exists(folder / kViewsManifestName, ignored) || fs::exists(folder / kViewsJobMarker, ignored);
  if (fs::exists(folder / kViewsFolder, ignored) && !ours) {
    return InvalidArgument("output folder " + output +
                           " has a 'views' that no job of depthfarm made; choose another folder or remove it");
  }
  return {};
}

}  // namespace

Result<JobSubmission> PlanViewsJob(const SynthesizeCommandOptions& options, const std::string& name, int priority) {
  DEPTHFARM_RETURN_IF_ERROR(CheckOutput(options.output));
  JobSubmission submission;
  submission.priority = priority;
  DEPTHFARM_ASSIGN_OR_RETURN(submission.output_dir, Absolute("output folder", options.output));
  SequenceWithDepth input;
  DEPTHFARM_RETURN_IF_ERROR(ReadSequenceWithDepth(options.sequence, options.depth_dir, input));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<VirtualView> views, PlanVirtualViews(options, input));
  if (views.size() > static_cast<std::size_t>(kMaxVirtualPictures)) {
    return InvalidArgument("the job has " + std::to_string(views.size()) + " pictures, expected at most " +
                           std::to_string(kMaxVirtualPictures) + ": submit it in parts with --frames or --steps");
  }
  submission.sequence.name = input.sequence.name;
  DEPTHFARM_ASSIGN_OR_RETURN(submission.sequence.file, Absolute("sequence file", options.sequence));
  submission.name = name.empty() ? input.sequence.name + " views" : name;
  submission.render.emplace();
  DEPTHFARM_ASSIGN_OR_RETURN(submission.render->source, RenderSourceOf(options.depth_dir));
  for (const VirtualView& view : views) submission.render->views.push_back(ToPicture(input, view));
  return submission;
}

}  // namespace depthfarm
