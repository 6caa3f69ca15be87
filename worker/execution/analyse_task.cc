// Analyse: a picture of a camera, with what guides it, in superpixels.
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/media/guide_files.h"
#include "common/media/picture_reader.h"
#include "worker/execution/analysis_key.h"
#include "worker/execution/executor_task.h"
#include "worker/execution/fetch_ahead.h"
#include "worker/execution/uploaded_files.h"
#include "worker/segmentation/analysis_codec.h"
#include "worker/segmentation/mask_trust.h"
#include "worker/segmentation/view_prior.h"

namespace depthfarm {

Status TaskExecutor::Analyse(const Task& task, TaskOutcome& outcome) {
  const int view_index = task.spec.id.index;
  if (view_index < 0 || view_index >= task.job().num_views()) {
    return InvalidArgument(TaskName(task.spec.id) + ": the job has " + std::to_string(task.job().num_views()) +
                           " views");
  }
  const JobView& view = task.job().views[static_cast<std::size_t>(view_index)];
  return AnalysePicture(task, view, outcome).WithContext("camera '" + view.camera.name + "', " + task.FrameName());
}

namespace {

constexpr std::uint64_t kMaxGuideBytes = std::uint64_t{1} << 32;
constexpr double kLeftAside = 0.1;  // of a mask that is worth less next to nothing is used

// The bytes of the files that guide a view; nothing where there is none.
struct GuideBytes {
  std::optional<std::string> mask;
  std::optional<std::string> prior;
  std::optional<std::string> prior_confidence;
};

// Reads a guide: by its path, or what the submitter serves of it.
using ReadFile = std::function<Result<std::string>(const std::string& path, const std::optional<UploadedFile>& upload)>;

Result<std::optional<std::string>> ReadGuide(const ReadFile& read, const std::string& path,
                                             const std::optional<UploadedFile>& upload) {
  if (path.empty()) return std::optional<std::string>();
  DEPTHFARM_ASSIGN_OR_RETURN(std::string bytes, read(path, upload));
  return std::optional<std::string>(std::move(bytes));
}

Result<GuideBytes> ReadGuides(const ReadFile& read, const TaskSpec& spec) {
  const GuideFiles& files = spec.guides;
  const SourceDigests uploads = spec.uploads ? spec.uploads->files : SourceDigests();
  GuideBytes guides;
  DEPTHFARM_ASSIGN_OR_RETURN(guides.mask, ReadGuide(read, files.mask, uploads.mask));
  DEPTHFARM_ASSIGN_OR_RETURN(guides.prior, ReadGuide(read, files.prior, uploads.prior));
  if (guides.prior.has_value()) {
    DEPTHFARM_ASSIGN_OR_RETURN(guides.prior_confidence,
                               ReadGuide(read, files.prior_confidence, uploads.prior_confidence));
  }
  return guides;
}

// Of uploads the job says them: equal files give equal names, however they are read.
AnalysisDigests DigestsOf(const SourceDigests& uploads) {
  const auto digest = [](const std::optional<UploadedFile>& upload) {
    return upload ? std::optional<ContentDigest>(upload->file.sha256) : std::nullopt;
  };
  return {.picture = uploads.picture.file.sha256,
          .mask = digest(uploads.mask),
          .prior = digest(uploads.prior),
          .prior_confidence = uploads.prior ? digest(uploads.prior_confidence) : std::nullopt,
          .before = {}};
}

std::optional<ContentDigest> DigestOf(const std::optional<std::string>& bytes) {
  return bytes.has_value() ? std::optional<ContentDigest>(Sha256(*bytes)) : std::nullopt;
}

Result<ViewPrior> PriorOf(const GuideBytes& guides, const GuideFiles& files, const PriorFormat& format,
                          const SegmentMap& segments) {
  const int width = segments.labels.width();
  const int height = segments.labels.height();
  Result<Grid<float>> values = DecodePrior(*guides.prior, format, width, height);
  if (!values.ok()) return values.status().WithContext(files.prior);
  Grid<float> confidence;
  if (guides.prior_confidence.has_value()) {
    Result<Grid<float>> shares = DecodeShare(*guides.prior_confidence, width, height);
    if (!shares.ok()) return shares.status().WithContext(files.prior_confidence);
    confidence = std::move(*shares);
  }
  ViewPrior prior = MakePrior(*values, confidence);
  prior.segments = DescribePrior(segments, prior);
  return prior;
}

}  // namespace

Status TaskExecutor::AnalysePicture(const Task& task, const JobView& view, TaskOutcome& outcome) {
  const std::string& path = task.spec.picture;
  const EstimationParams& params = task.job().params;
  const bool refers = !task.job().IsIFrame(task.spec.id.frame);
  if (refers != task.KeyOf(InputRole::kPreviousAnalysis).has_value()) {
    return InvalidArgument(TaskName(task.spec.id) + (refers ? ": expected the analysis of the frame before"
                                                            : ": expected no analysis of another frame"));
  }
  const ReadFile read = [&](const std::string& file, const std::optional<UploadedFile>& upload) -> Result<std::string> {
    if (!task.spec.uploads) {
      DEPTHFARM_RETURN_IF_ERROR(roots_.CheckRead(file));
      return ReadFileBytes(file, kMaxGuideBytes);
    }
    return ReadUpload(store_, fetcher_, upload.value_or(UploadedFile()), task.spec.uploads->from, file, task.stop,
                      outcome.stats.fetched_bytes);
  };
  GuideBytes guides;
  YcbcrImage picture;
  {
    PictureBytes read_picture{.bytes = {}, .format = view.format};
    AnalysisDigests digests;
    if (task.spec.uploads) {
      digests = DigestsOf(task.spec.uploads->files);
    } else {
      DEPTHFARM_ASSIGN_OR_RETURN(guides, ReadGuides(read, task.spec));
      DEPTHFARM_RETURN_IF_ERROR(roots_.CheckRead(path));
      const PictureFile file{path,
                             view.format,
                             view.source_width,
                             view.source_height,
                             params.first_frame + task.spec.id.frame,
                             params.first_frame + task.job().num_frames};
      DEPTHFARM_ASSIGN_OR_RETURN(read_picture, ReadPictureBytes(file, &videos_));
      digests = {.picture = DigestOf(file, read_picture),
                 .mask = DigestOf(guides.mask),
                 .prior = DigestOf(guides.prior),
                 .prior_confidence = DigestOf(guides.prior_confidence),
                 .before = {}};
    }
    digests.before = task.KeyOf(InputRole::kPreviousAnalysis);
    const ArtifactKey key = AnalysisKey(view, params, digests);
    outcome.picture_digest = digests.picture;
    outcome.output_key = key;
    outcome.pins->push_back(store_.Pin({key}));
    if (task.spec.known.has_value() && task.spec.known->artifact.key == key)
      outcome.stats.fetched_bytes += FetchIntoStore(store_, fetcher_, *task.spec.known, task.stop);
    if (const auto known = FindMade<ViewAnalysis>(task, key, outcome); known != nullptr) {
      outcome.stats.segments = static_cast<std::uint32_t>(known->segments.num_segments());
      return {};
    }
    if (task.spec.uploads) {
      DEPTHFARM_ASSIGN_OR_RETURN(guides, ReadGuides(read, task.spec));
      DEPTHFARM_ASSIGN_OR_RETURN(read_picture.bytes, read(path, task.spec.uploads->files.picture));
      ReleaseUploads(task);
    }
    Result<YcbcrImage> decoded =
        DecodePicture(read_picture.bytes, read_picture.format, view.source_width, view.source_height, params.downscale);
    if (!decoded.ok()) return decoded.status().WithContext(path);
    picture = std::move(*decoded);
  }
  if (guides.mask.has_value()) {
    DEPTHFARM_RETURN_IF_ERROR(ApplyMask(*guides.mask, picture).WithContext(task.spec.guides.mask));
    outcome.stats.left_aside = WeighMask(picture) < kLeftAside;
  }
  if (task.stop.stop_requested()) return Cancelled();
  DEPTHFARM_ASSIGN_OR_RETURN(ViewAnalysis analysis, SegmentsOf(task, view, std::move(picture)));
  if (guides.prior.has_value()) {
    DEPTHFARM_ASSIGN_OR_RETURN(analysis.prior, PriorOf(guides, task.spec.guides, view.prior, analysis.segments));
  }
  outcome.stats.segments = static_cast<std::uint32_t>(analysis.segments.num_segments());
  DEPTHFARM_ASSIGN_OR_RETURN(outcome.artifact, store_.Put(*outcome.output_key, EncodeAnalysis(analysis)));
  cache_.Put(*outcome.output_key, std::make_shared<const ViewAnalysis>(std::move(analysis)));
  return {};
}

void TaskExecutor::ReleaseUploads(const Task& task) {
  std::vector<ArtifactKey> read;
  for (const TaskInput& upload : UploadsOf(task.spec)) read.push_back(upload.artifact.key);
  store_.Release(read);
}

Result<ViewAnalysis> TaskExecutor::SegmentsOf(const Task& task, const JobView& view, YcbcrImage picture) {
  const EstimationParams& params = task.job().params;
  if (task.job().IsIFrame(task.spec.id.frame))
    return AnalyseView(std::move(picture), view.segments, params.snic_compactness, task.stop);
  DEPTHFARM_RETURN_IF_ERROR(task.LoadInputs());
  const auto before =
      task.inputs.ListedAnalyses(InputRole::kPreviousAnalysis)[static_cast<std::size_t>(task.spec.id.index)];
  if (before == nullptr) return InvalidArgument("the analysis of the frame before is another view's");
  return AnalyseNextView(std::move(picture), *before, params.p_threshold, params.snic_compactness, task.stop);
}

}  // namespace depthfarm
