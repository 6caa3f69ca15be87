#include "coordinator/service/submission.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "common/text/text_table.h"
#include "common/transport/endpoint.h"
#include "common/transport/keys.h"
#include "common/wire/bounds.h"
#include "common/wire/job_wire.h"
#include "common/wire/render_wire.h"
#include "common/wire/sequence_wire.h"
#include "common/wire/task_wire.h"

namespace depthfarm {
namespace {

Result<std::string> OutputFolder(const std::string& asked) {
  DEPTHFARM_RETURN_IF_ERROR(CheckAbsolutePath("output folder", asked));
  // One spelling per folder: two jobs must not share one.
  std::filesystem::path folder = std::filesystem::path(asked).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  if (folder == folder.root_path())
    return InvalidArgument("output folder is '" + asked + "', expected one below the root");
  return folder.string();
}

// Pictures and guides of the job's views and frames.
void ListFiles(const Sequence& sequence, PlannedJob& job) {
  const ResolvedJob& resolved = job.config.resolved;
  const bool guided = std::any_of(resolved.views.begin(), resolved.views.end(), [](const JobView& view) {
    return view.masked || view.prior.holds != PriorFormat::Holds::kNothing;
  });
  for (const JobView& view : resolved.views) {
    const auto camera =
        std::find_if(sequence.cameras.begin(), sequence.cameras.end(),
                     [&](const SequenceCamera& candidate) { return candidate.camera.name == view.camera.name; });
    const auto first = camera->images.begin() + resolved.params.first_frame;
    job.pictures.emplace_back(first, first + resolved.num_frames);
    if (!guided) continue;
    std::vector<GuideFiles>& guides = job.guides.emplace_back();
    for (int frame = 0; frame < resolved.num_frames; ++frame) {
      const auto f = static_cast<std::size_t>(resolved.params.first_frame + frame);
      const auto of_frame = [f](const std::vector<std::string>& paths) { return f < paths.size() ? paths[f] : ""; };
      guides.push_back({of_frame(camera->masks), of_frame(camera->prior), of_frame(camera->prior_confidence)});
    }
  }
}

Result<std::optional<UploadedFile>> UploadOf(const google::protobuf::RepeatedPtrField<v1::UploadedFile>& files,
                                             int frame, const std::string& path) {
  if (path.empty()) return std::optional<UploadedFile>();
  if (frame >= files.size()) return InvalidArgument("uploads: " + path + " has no digest");
  Result<UploadedFile> file = FromProto(files[frame]);
  if (!file.ok()) return file.status().WithContext("uploads: " + path);
  return std::optional<UploadedFile>(*file);
}

// What the submitter serves of the job's views and frames.
Status ListUploads(const v1::SubmitJob& request, PlannedJob& job) {
  DEPTHFARM_ASSIGN_OR_RETURN(job.uploads_from, FromProto(request.uploads_from()));
  DEPTHFARM_RETURN_IF_ERROR(ParseEndpoint(job.uploads_from.endpoint).status().WithContext("uploads"));
  if (!job.uploads_from.public_key.empty() && !IsCurveKey(job.uploads_from.public_key))
    return InvalidArgument("uploads: the server's key is no CURVE key");
  const ResolvedJob& resolved = job.config.resolved;
  for (std::size_t view = 0; view < resolved.views.size(); ++view) {
    const std::string& name = resolved.views[view].camera.name;
    const auto camera = std::ranges::find_if(request.sequence().cameras(), [&](const v1::SequenceCamera& candidate) {
      return candidate.camera().name() == name;
    });
    const v1::UploadedFiles& uploads = camera->uploads();
    std::vector<SourceDigests>& of_view = job.uploads.emplace_back();
    for (int frame = 0; frame < resolved.num_frames; ++frame) {
      const int f = resolved.params.first_frame + frame;
      const auto position = static_cast<std::size_t>(frame);
      const GuideFiles guides = job.guides.empty() ? GuideFiles() : job.guides[view][position];
      SourceDigests files;
      DEPTHFARM_ASSIGN_OR_RETURN(const auto picture, UploadOf(uploads.images(), f, job.pictures[view][position]));
      files.picture = picture.value();
      DEPTHFARM_ASSIGN_OR_RETURN(files.mask, UploadOf(uploads.masks(), f, guides.mask));
      DEPTHFARM_ASSIGN_OR_RETURN(files.prior, UploadOf(uploads.prior(), f, guides.prior));
      DEPTHFARM_ASSIGN_OR_RETURN(files.prior_confidence,
                                 UploadOf(uploads.prior_confidence(), f, guides.prior_confidence));
      of_view.push_back(files);
    }
  }
  return {};
}

// A job that renders views: the sequence and its depth are read by the workers.
Result<PlannedJob> PlanRendering(const v1::SubmitJob& request) {
  PlannedJob job;
  DEPTHFARM_ASSIGN_OR_RETURN(job.config.render, FromProto(request.render().source()));
  DEPTHFARM_ASSIGN_OR_RETURN(job.views, ViewsFromProto(request.render().views()));
  if (job.views.empty()) return InvalidArgument("the job has no views to render");
  job.config.sequence_name = request.sequence().name();
  job.config.sequence_file = request.sequence().file();
  DEPTHFARM_RETURN_IF_ERROR(CheckText("sequence name", job.config.sequence_name, kMaxNameBytes));
  DEPTHFARM_RETURN_IF_ERROR(CheckAbsolutePath("sequence file", job.config.sequence_file));
  DEPTHFARM_RETURN_IF_ERROR(CheckText("sequence file", job.config.sequence_file, kMaxPathBytes));
  job.config.resolved = PartsOnly(NumParts(job.views.size()));
  return job;
}

Result<PlannedJob> PlanEstimation(const v1::SubmitJob& request) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Sequence sequence, FromProto(request.sequence()));
  DEPTHFARM_ASSIGN_OR_RETURN(const EstimationParams params, FromProto(request.params()));
  PlannedJob job;
  DEPTHFARM_ASSIGN_OR_RETURN(job.config.resolved, ResolveJob(sequence, params));
  DEPTHFARM_RETURN_IF_ERROR(CheckPlannable(job.config.resolved));
  job.config.sequence_name = sequence.name;
  job.config.sequence_file = sequence.file;
  ListFiles(sequence, job);
  if (request.has_uploads_from()) DEPTHFARM_RETURN_IF_ERROR(ListUploads(request, job));
  return job;
}

std::string SummaryOfViews(const std::vector<VirtualPicture>& views) {
  const Camera& first = views.front().camera;
  return WithThousands(views.size()) + " virtual views, " + std::to_string(first.width) + "x" +
         std::to_string(first.height);
}

}  // namespace

Result<PlannedJob> PlanSubmission(const v1::SubmitJob& request, JobId id) {
  DEPTHFARM_RETURN_IF_ERROR(CheckText("job name", request.name(), kMaxNameBytes));
  DEPTHFARM_ASSIGN_OR_RETURN(PlannedJob job, request.has_render() ? PlanRendering(request) : PlanEstimation(request));
  job.config.keeps_results = request.keeps_results();
  if (!job.config.keeps_results) {
    DEPTHFARM_ASSIGN_OR_RETURN(job.config.output_dir, OutputFolder(request.output_dir()));
  } else if (!request.output_dir().empty() || request.has_render()) {
    return InvalidArgument("a job that keeps its results has no output folder and estimates depth");
  }
  job.config.job = id;
  return job;
}

std::string Summary(const PlannedJob& planned) {
  if (planned.config.render) return SummaryOfViews(planned.views);
  const ResolvedJob& job = planned.config.resolved;
  const Camera& first = job.views[0].camera;
  const bool same_size = std::all_of(job.views.begin(), job.views.end(), [&](const JobView& view) {
    return view.camera.width == first.width && view.camera.height == first.height;
  });
  std::int64_t segments = 0;
  for (const JobView& view : job.views) segments += view.segments;
  std::string text = std::to_string(job.num_views()) + " views ";
  text += same_size ? std::to_string(first.width) + "x" + std::to_string(first.height) : "of several sizes";
  text += ", " + WithThousands(segments) + " segments, " + std::to_string(job.params.levels) + " levels, n = ";
  text += std::to_string(job.level_blocks_i);
  if (job.level_blocks_i > 1) text += job.params.partition == Partition::kInterleaved ? " interleaved" : " blocks";
  return text;
}

}  // namespace depthfarm
