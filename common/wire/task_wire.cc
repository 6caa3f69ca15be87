#include "common/wire/task_wire.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "common/text/clean_line.h"
#include "common/wire/bounds.h"
#include "common/wire/digest_wire.h"
#include "common/wire/render_wire.h"

namespace depthfarm {
namespace {

constexpr int kMaxIndex = 65536;
constexpr int kMaxEndpointBytes = 512;
constexpr std::size_t kKeyCharacters = 40;

v1::InputRole RoleToProto(InputRole role) {
  switch (role) {
    case InputRole::kAnalysis:
      return v1::INPUT_ROLE_ANALYSIS;
    case InputRole::kPreviousAnalysis:
      return v1::INPUT_ROLE_PREVIOUS_ANALYSIS;
    case InputRole::kPreviousLabels:
      return v1::INPUT_ROLE_PREVIOUS_LABELS;
    case InputRole::kIAnalysis:
      return v1::INPUT_ROLE_I_ANALYSIS;
    case InputRole::kILabels:
      return v1::INPUT_ROLE_I_LABELS;
    case InputRole::kLabels:
      return v1::INPUT_ROLE_LABELS;
    case InputRole::kPreviousRefined:
      return v1::INPUT_ROLE_PREVIOUS_REFINED;
    case InputRole::kIRefined:
      return v1::INPUT_ROLE_I_REFINED;
    case InputRole::kRefined:
      return v1::INPUT_ROLE_REFINED;
    case InputRole::kConfidence:
      return v1::INPUT_ROLE_CONFIDENCE;
  }
  return v1::INPUT_ROLE_UNSPECIFIED;
}

Result<InputRole> RoleFromProto(v1::InputRole role) {
  switch (role) {
    case v1::INPUT_ROLE_ANALYSIS:
      return InputRole::kAnalysis;
    case v1::INPUT_ROLE_PREVIOUS_ANALYSIS:
      return InputRole::kPreviousAnalysis;
    case v1::INPUT_ROLE_PREVIOUS_LABELS:
      return InputRole::kPreviousLabels;
    case v1::INPUT_ROLE_I_ANALYSIS:
      return InputRole::kIAnalysis;
    case v1::INPUT_ROLE_I_LABELS:
      return InputRole::kILabels;
    case v1::INPUT_ROLE_LABELS:
      return InputRole::kLabels;
    case v1::INPUT_ROLE_PREVIOUS_REFINED:
      return InputRole::kPreviousRefined;
    case v1::INPUT_ROLE_I_REFINED:
      return InputRole::kIRefined;
    case v1::INPUT_ROLE_REFINED:
      return InputRole::kRefined;
    case v1::INPUT_ROLE_CONFIDENCE:
      return InputRole::kConfidence;
    default:
      return InvalidArgument("input role is " + std::to_string(role) + ", expected 1 to 10");
  }
}

v1::ArtifactInput InputToProto(const TaskInput& input) {
  v1::ArtifactInput proto;
  proto.set_key(DigestBytes(input.artifact.key));
  proto.set_stored_bytes(input.artifact.stored_bytes);
  proto.set_content_digest(DigestBytes(input.artifact.content_digest));
  proto.set_role(RoleToProto(input.role));
  proto.set_view(static_cast<std::uint32_t>(input.view));
  for (const ArtifactLocation& location : input.locations) *proto.add_locations() = ToProto(location);
  return proto;
}

Result<TaskInput> InputFromProto(const v1::ArtifactInput& proto) {
  TaskInput input;
  DEPTHFARM_ASSIGN_OR_RETURN(input.artifact.key, DigestFromBytes("input key", proto.key()));
  DEPTHFARM_ASSIGN_OR_RETURN(input.artifact.content_digest, DigestFromBytes("input digest", proto.content_digest()));
  if (proto.stored_bytes() == 0 || proto.stored_bytes() > kMaxArtifactBytes) {
    return InvalidArgument("input size is " + std::to_string(proto.stored_bytes()) + " bytes, expected 1 to " +
                           std::to_string(kMaxArtifactBytes));
  }
  input.artifact.stored_bytes = proto.stored_bytes();
  DEPTHFARM_ASSIGN_OR_RETURN(input.role, RoleFromProto(proto.role()));
  DEPTHFARM_ASSIGN_OR_RETURN(input.view, BoundedInt("input view", proto.view(), kMaxViews - 1));
  DEPTHFARM_RETURN_IF_ERROR(CheckCount("input locations", proto.locations_size(), kMaxLocations));
  for (const v1::ArtifactLocation& location : proto.locations()) {
    DEPTHFARM_ASSIGN_OR_RETURN(ArtifactLocation parsed, FromProto(location));
    input.locations.push_back(std::move(parsed));
  }
  return input;
}

double Plausible(double value) { return std::isfinite(value) && value > 0 ? value : 0; }

Status ReadLists(const v1::TaskSpec& proto, TaskSpec& spec) {
  DEPTHFARM_RETURN_IF_ERROR(CheckCount("inputs", proto.inputs_size(), kMaxInputs));
  for (const v1::ArtifactInput& input : proto.inputs()) {
    DEPTHFARM_ASSIGN_OR_RETURN(TaskInput parsed, InputFromProto(input));
    spec.inputs.push_back(std::move(parsed));
  }
  if (proto.has_known()) {
    DEPTHFARM_ASSIGN_OR_RETURN(spec.known, InputFromProto(proto.known()));
  }
  for (const v1::OutputFile& file : proto.files()) {
    DEPTHFARM_ASSIGN_OR_RETURN(OutputFile parsed, FromProto(file));
    spec.files.push_back(std::move(parsed));
  }
  for (const std::string& digest : proto.picture_digests()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const ContentDigest parsed, DigestFromBytes("picture digest", digest));
    spec.picture_digests.push_back(parsed);
  }
  DEPTHFARM_ASSIGN_OR_RETURN(spec.views, ViewsFromProto(proto.views()));
  return {};
}

}  // namespace

v1::TaskKind ToProto(TaskKind kind) {
  switch (kind) {
    case TaskKind::kPrepare:
      return v1::TASK_KIND_PREPARE;
    case TaskKind::kAnalyse:
      return v1::TASK_KIND_ANALYSE;
    case TaskKind::kEstimate:
      return v1::TASK_KIND_ESTIMATE;
    case TaskKind::kMerge:
      return v1::TASK_KIND_MERGE;
    case TaskKind::kRefine:
      return v1::TASK_KIND_REFINE;
    case TaskKind::kAssess:
      return v1::TASK_KIND_ASSESS;
    case TaskKind::kRender:
      return v1::TASK_KIND_RENDER;
    case TaskKind::kEmit:
      return v1::TASK_KIND_EMIT;
    case TaskKind::kCommit:
      return v1::TASK_KIND_COMMIT;
    case TaskKind::kManifest:
      return v1::TASK_KIND_MANIFEST;
    case TaskKind::kCleanup:
      return v1::TASK_KIND_CLEANUP;
  }
  return v1::TASK_KIND_UNSPECIFIED;
}

Result<TaskKind> FromProto(v1::TaskKind kind) {
  switch (kind) {
    case v1::TASK_KIND_PREPARE:
      return TaskKind::kPrepare;
    case v1::TASK_KIND_ANALYSE:
      return TaskKind::kAnalyse;
    case v1::TASK_KIND_ESTIMATE:
      return TaskKind::kEstimate;
    case v1::TASK_KIND_MERGE:
      return TaskKind::kMerge;
    case v1::TASK_KIND_REFINE:
      return TaskKind::kRefine;
    case v1::TASK_KIND_ASSESS:
      return TaskKind::kAssess;
    case v1::TASK_KIND_RENDER:
      return TaskKind::kRender;
    case v1::TASK_KIND_EMIT:
      return TaskKind::kEmit;
    case v1::TASK_KIND_COMMIT:
      return TaskKind::kCommit;
    case v1::TASK_KIND_MANIFEST:
      return TaskKind::kManifest;
    case v1::TASK_KIND_CLEANUP:
      return TaskKind::kCleanup;
    default:
      return InvalidArgument("task kind is " + std::to_string(kind) + ", expected 1 to 11");
  }
}

v1::TaskId ToProto(const TaskId& id) {
  v1::TaskId proto;
  proto.set_job_id(id.job.value());
  proto.set_frame(static_cast<std::uint32_t>(id.frame));
  proto.set_kind(ToProto(id.kind));
  proto.set_index(static_cast<std::uint32_t>(id.index));
  proto.set_pair(static_cast<std::uint32_t>(id.pair));
  return proto;
}

Result<TaskId> FromProto(const v1::TaskId& proto) {
  TaskId id;
  id.job = JobId(proto.job_id());
  DEPTHFARM_ASSIGN_OR_RETURN(id.frame, BoundedInt("task frame", proto.frame(), kMaxFrames));
  DEPTHFARM_ASSIGN_OR_RETURN(id.kind, FromProto(proto.kind()));
  DEPTHFARM_ASSIGN_OR_RETURN(id.index, BoundedInt("task index", proto.index(), kMaxIndex));
  DEPTHFARM_ASSIGN_OR_RETURN(id.pair, BoundedInt("task pair", proto.pair(), kMaxIndex));
  return id;
}

v1::ArtifactInfo ToProto(const ArtifactInfo& artifact) {
  v1::ArtifactInfo proto;
  proto.set_key(DigestBytes(artifact.key));
  proto.set_stored_bytes(artifact.stored_bytes);
  proto.set_content_digest(DigestBytes(artifact.content_digest));
  return proto;
}

Result<ArtifactInfo> FromProto(const v1::ArtifactInfo& proto) {
  ArtifactInfo artifact;
  DEPTHFARM_ASSIGN_OR_RETURN(artifact.key, DigestFromBytes("artifact key", proto.key()));
  DEPTHFARM_ASSIGN_OR_RETURN(artifact.content_digest, DigestFromBytes("artifact digest", proto.content_digest()));
  if (proto.stored_bytes() == 0 || proto.stored_bytes() > kMaxArtifactBytes) {
    return InvalidArgument("artifact size is " + std::to_string(proto.stored_bytes()) + " bytes, expected 1 to " +
                           std::to_string(kMaxArtifactBytes));
  }
  artifact.stored_bytes = proto.stored_bytes();
  return artifact;
}

v1::ArtifactLocation ToProto(const ArtifactLocation& location) {
  v1::ArtifactLocation proto;
  proto.set_endpoint(location.endpoint);
  proto.set_public_key(location.public_key);
  return proto;
}

Result<ArtifactLocation> FromProto(const v1::ArtifactLocation& proto) {
  DEPTHFARM_RETURN_IF_ERROR(CheckText("artifact endpoint", proto.endpoint(), kMaxEndpointBytes));
  if (proto.endpoint().empty()) return InvalidArgument("artifact endpoint is empty");
  if (!proto.public_key().empty() && proto.public_key().size() != kKeyCharacters) {
    return InvalidArgument("artifact server's key has " + std::to_string(proto.public_key().size()) +
                           " characters, expected 40 or none");
  }
  return ArtifactLocation{proto.endpoint(), proto.public_key()};
}

v1::OutputFile ToProto(const OutputFile& file) {
  v1::OutputFile proto;
  proto.set_path(file.path);
  proto.set_sha256(DigestBytes(file.sha256));
  proto.set_bytes(file.bytes);
  return proto;
}

Result<OutputFile> FromProto(const v1::OutputFile& proto) {
  OutputFile file;
  const std::string& path = proto.path();
  const auto slashes = std::count(path.begin(), path.end(), '/');
  if (slashes < 1 || slashes > 2 || !DepthFormatOfFile(path)) {
    return InvalidArgument("output file is '" + path.substr(0, kMaxNameBytes) +
                           "', expected views/NUMBER.png or MAP/CAMERA/NUMBER and .png, .pfm, .exr or .yuv");
  }
  std::istringstream names(path);
  for (std::string name; std::getline(names, name, '/');) DEPTHFARM_RETURN_IF_ERROR(CheckFileName("output file", name));
  file.path = path;
  DEPTHFARM_ASSIGN_OR_RETURN(file.sha256, DigestFromBytes("output digest", proto.sha256()));
  file.bytes = proto.bytes();
  return file;
}

v1::TaskStats ToProto(const TaskStats& stats) {
  v1::TaskStats proto;
  proto.set_wall_seconds(stats.wall_seconds);
  proto.set_cpu_seconds(stats.cpu_seconds);
  proto.set_peak_memory_bytes(stats.peak_memory_bytes);
  proto.set_fetch_seconds(stats.fetch_seconds);
  proto.set_fetched_bytes(stats.fetched_bytes);
  proto.set_sweeps(stats.sweeps);
  proto.set_energy(stats.energy);
  proto.set_nodes(stats.nodes);
  proto.set_segments(stats.segments);
  proto.set_reused(stats.reused);
  proto.set_left_aside(stats.left_aside);
  return proto;
}

TaskStats FromProto(const v1::TaskStats& proto) {
  TaskStats stats;
  stats.wall_seconds = Plausible(proto.wall_seconds());
  stats.cpu_seconds = Plausible(proto.cpu_seconds());
  stats.peak_memory_bytes = proto.peak_memory_bytes();
  stats.fetch_seconds = Plausible(proto.fetch_seconds());
  stats.fetched_bytes = proto.fetched_bytes();
  stats.sweeps = proto.sweeps();
  stats.energy = proto.energy();
  stats.nodes = proto.nodes();
  stats.segments = proto.segments();
  stats.reused = proto.reused();
  stats.left_aside = proto.left_aside();
  return stats;
}

v1::TaskLog ToProto(const TaskLog& log) {
  v1::TaskLog proto;
  for (const std::string& line : log.lines) proto.add_lines(line);
  proto.set_left_out(log.left_out);
  return proto;
}

TaskLog FromProto(const v1::TaskLog& proto) {
  TaskLog log;
  std::size_t bytes = 0;
  for (int i = proto.lines_size(); i > 0 && log.lines.size() < kMaxTaskLogLines; --i) {
    std::string line = CleanLine(proto.lines(i - 1), kMaxTaskLogLineBytes);
    bytes += line.size();
    if (bytes > kMaxTaskLogBytes) break;
    log.lines.push_back(std::move(line));
  }
  std::reverse(log.lines.begin(), log.lines.end());
  log.left_out = proto.left_out() + static_cast<std::uint64_t>(proto.lines_size()) - log.lines.size();
  return log;
}

namespace {

void UploadsToProto(const UploadedSources& uploads, v1::TaskSpec& proto) {
  *proto.mutable_picture_upload() = ToProto(uploads.files.picture);
  if (uploads.files.mask) *proto.mutable_mask_upload() = ToProto(*uploads.files.mask);
  if (uploads.files.prior) *proto.mutable_prior_upload() = ToProto(*uploads.files.prior);
  if (uploads.files.prior_confidence)
    *proto.mutable_prior_confidence_upload() = ToProto(*uploads.files.prior_confidence);
  *proto.mutable_uploads_from() = ToProto(uploads.from);
}

// A file that the task names has a digest, another one has none.
Status UploadFromProto(const std::string& path, bool present, const v1::UploadedFile& proto,
                       std::optional<UploadedFile>& file) {
  if (path.empty() == present) return InvalidArgument("an uploaded file without a name or a digest");
  if (!present) return {};
  DEPTHFARM_ASSIGN_OR_RETURN(file, FromProto(proto));
  return {};
}

Status UploadsFromProto(const v1::TaskSpec& proto, TaskSpec& spec) {
  UploadedSources uploads;
  DEPTHFARM_ASSIGN_OR_RETURN(uploads.from, FromProto(proto.uploads_from()));
  DEPTHFARM_ASSIGN_OR_RETURN(uploads.files.picture, FromProto(proto.picture_upload()));
  DEPTHFARM_RETURN_IF_ERROR(
      UploadFromProto(spec.guides.mask, proto.has_mask_upload(), proto.mask_upload(), uploads.files.mask));
  DEPTHFARM_RETURN_IF_ERROR(
      UploadFromProto(spec.guides.prior, proto.has_prior_upload(), proto.prior_upload(), uploads.files.prior));
  DEPTHFARM_RETURN_IF_ERROR(UploadFromProto(spec.guides.prior_confidence, proto.has_prior_confidence_upload(),
                                            proto.prior_confidence_upload(), uploads.files.prior_confidence));
  spec.uploads = std::move(uploads);
  return {};
}

}  // namespace

v1::TaskSpec ToProto(const TaskSpec& spec) {
  v1::TaskSpec proto;
  *proto.mutable_id() = ToProto(spec.id);
  if (spec.output_key) proto.set_output_key(DigestBytes(*spec.output_key));
  for (const TaskInput& input : spec.inputs) *proto.add_inputs() = InputToProto(input);
  if (spec.known) *proto.mutable_known() = InputToProto(*spec.known);
  proto.set_picture(spec.picture);
  proto.set_mask(spec.guides.mask);
  proto.set_prior(spec.guides.prior);
  proto.set_prior_confidence(spec.guides.prior_confidence);
  if (spec.uploads) UploadsToProto(*spec.uploads, proto);
  proto.set_staging(spec.staging);
  for (const OutputFile& file : spec.files) *proto.add_files() = ToProto(file);
  for (const ContentDigest& digest : spec.picture_digests) proto.add_picture_digests(DigestBytes(digest));
  for (const VirtualPicture& view : spec.views) *proto.add_views() = ToProto(view);
  return proto;
}

namespace {

Status ReadFilesOfAnalyse(const v1::TaskSpec& proto, TaskSpec& spec) {
  DEPTHFARM_RETURN_IF_ERROR(CheckAbsolutePath("picture", proto.picture()));
  spec.picture = proto.picture();
  spec.guides = {.mask = proto.mask(), .prior = proto.prior(), .prior_confidence = proto.prior_confidence()};
  for (const auto& [field, path] : {std::pair{"mask", &spec.guides.mask}, std::pair{"prior", &spec.guides.prior},
                                    std::pair{"confidence of the prior", &spec.guides.prior_confidence}})
    if (!path->empty()) DEPTHFARM_RETURN_IF_ERROR(CheckAbsolutePath(field, *path));
  return proto.has_uploads_from() ? UploadsFromProto(proto, spec) : Status();
}

}  // namespace

Result<TaskSpec> FromProto(const v1::TaskSpec& proto) {
  TaskSpec spec;
  DEPTHFARM_ASSIGN_OR_RETURN(spec.id, FromProto(proto.id()));
  const bool keeps = spec.id.kind == TaskKind::kEmit && proto.staging().empty();
  const bool has_key = spec.id.kind == TaskKind::kEstimate || spec.id.kind == TaskKind::kMerge ||
                       spec.id.kind == TaskKind::kRefine || spec.id.kind == TaskKind::kAssess || keeps;
  if (has_key != !proto.output_key().empty()) {
    return InvalidArgument(TaskName(spec.id) + (has_key ? " has no output key" : " has an output key, expected none"));
  }
  if (has_key) {
    DEPTHFARM_ASSIGN_OR_RETURN(spec.output_key, DigestFromBytes("output key", proto.output_key()));
  }
  DEPTHFARM_RETURN_IF_ERROR(ReadLists(proto, spec));
  if (spec.id.kind == TaskKind::kAnalyse) DEPTHFARM_RETURN_IF_ERROR(ReadFilesOfAnalyse(proto, spec));
  const bool stages = (spec.id.kind == TaskKind::kEmit && !keeps) || spec.id.kind == TaskKind::kRender ||
                      spec.id.kind == TaskKind::kCommit;
  if (stages) DEPTHFARM_RETURN_IF_ERROR(CheckFileName("staging folder", proto.staging()));
  spec.staging = stages ? proto.staging() : "";
  return spec;
}

}  // namespace depthfarm
