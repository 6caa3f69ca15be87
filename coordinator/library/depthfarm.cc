#include "coordinator/library/depthfarm.h"

#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>
#include <utility>

#include "common/files/atomic_file.h"
#include "common/media/depth_file.h"
#include "common/media/picture_png.h"
#include "common/sequence/depth_manifest.h"
#include "common/wire/job_wire.h"
#include "common/wire/sequence_wire.h"
#include "coordinator/cli/job_request.h"
#include "coordinator/cli/private_folder.h"
#include "coordinator/library/in_process_farm.h"
#include "coordinator/service/submission.h"

namespace depthfarm::library {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr int kMostThreads = 1024;
constexpr float kCertain = 65535;

ordered_json Rows(const std::array<double, 9>& matrix) {
  ordered_json rows = ordered_json::array();
  for (std::size_t row = 0; row < 3; ++row) rows.push_back({matrix[3 * row], matrix[3 * row + 1], matrix[3 * row + 2]});
  return rows;
}

std::string NumberedFile(std::size_t camera, std::size_t frame) {
  return std::to_string(camera) + "-" + std::to_string(frame) + ".png";
}

// Writes the pictures and the sequence file that names them, and returns the latter.
depthfarm::Result<std::string> WriteSequence(const Scene& scene, const fs::path& folder) {
  ordered_json json = {{"name", "library"}, {"zNear", scene.z_near}, {"zFar", scene.z_far}};
  if (!scene.reference.empty()) json["reference"] = scene.reference;
  if (scene.frames.empty()) return InvalidArgument("the scene has no frames");
  json["cameras"] = ordered_json::array();
  for (std::size_t c = 0; c < scene.cameras.size(); ++c) {
    const Camera& camera = scene.cameras[c];
    ordered_json images = ordered_json::array();
    for (std::size_t f = 0; f < scene.frames.size(); ++f) {
      const std::string where = "camera '" + camera.name + "', frame " + std::to_string(f);
      if (scene.frames[f].size() != scene.cameras.size()) {
        return InvalidArgument("frame " + std::to_string(f) + " has " + std::to_string(scene.frames[f].size()) +
                               " pictures, the scene " + std::to_string(scene.cameras.size()) + " cameras");
      }
      const Picture& picture = scene.frames[f][c];
      const depthfarm::Result<std::string> png = EncodePicturePng({.width = camera.width,
                                                                   .height = camera.height,
                                                                   .channels = picture.channels,
                                                                   .bytes_per_sample = picture.bytes_per_sample,
                                                                   .data = picture.samples,
                                                                   .row_bytes = picture.row_bytes});
      if (!png.ok()) return png.status().WithContext(where);
      images.push_back(NumberedFile(c, f));
      DEPTHFARM_RETURN_IF_ERROR(WriteFileAtomically((folder / NumberedFile(c, f)).string(), *png));
    }
    json["cameras"].push_back({{"name", camera.name},
                               {"width", camera.width},
                               {"height", camera.height},
                               {"K", Rows(camera.K)},
                               {"R", Rows(camera.R)},
                               {"t", camera.t},
                               {"images", std::move(images)}});
  }
  std::string file = (folder / "sequence.json").string();
  DEPTHFARM_RETURN_IF_ERROR(WriteFileAtomically(file, json.dump()));
  return file;
}

depthfarm::Result<PlannedJob> Plan(const std::string& sequence, const fs::path& output, const Options& options) {
  JobArguments arguments;
  arguments.sequence = sequence;
  arguments.output_dir = output.string();
  for (const auto& [name, value] : options.estimation) {
    if (name == "preset") {
      arguments.estimation.preset = value;
    } else if (name == "params") {
      arguments.estimation.params_file = value;
    } else {
      const auto known = EstimationOptions();
      if (std::ranges::none_of(known, [&](const EstimationOption& option) { return option.name == name; })) {
        return InvalidArgument("there is no option '" + name + "': depthfarm run --help lists them");
      }
      arguments.estimation.values.emplace_back(name, value);
    }
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const JobRequest request, PrepareJobRequest(arguments));
  v1::SubmitJob submission;
  *submission.mutable_sequence() = ToProto(request.sequence);
  *submission.mutable_params() = ToProto(request.params);
  submission.set_output_dir(request.output_dir);
  submission.set_name(request.sequence.name);
  DEPTHFARM_ASSIGN_OR_RETURN(PlannedJob job, PlanSubmission(submission, JobId(1)));
  std::random_device device;
  job.config.claim = (std::uint64_t{device()} << 32U) | device();
  return job;
}

Progress ProgressOf(const JobSnapshot& job) {
  std::uint64_t done = 0;
  std::uint64_t total = 0;
  for (const StageSnapshot& stage : job.stages) {
    done += stage.tasks_done;
    total += stage.tasks_total;
  }
  return {job.frames_done, job.frames_total, total == 0 ? 0 : static_cast<double>(done) / static_cast<double>(total)};
}

depthfarm::Result<DepthMap> ReadMap(const std::string& folder, const DepthManifestCamera& camera, std::size_t frame) {
  DepthMap map{camera.camera.width, camera.camera.height, {}, {}};
  DEPTHFARM_ASSIGN_OR_RETURN(const depthfarm::DepthMap depth, ReadDepthOf(folder, camera, static_cast<int>(frame)));
  map.z.assign(depth.values().begin(), depth.values().end());
  if (!camera.confidence.empty()) {
    const std::string file = folder + "/" + camera.confidence[frame].path;
    DEPTHFARM_ASSIGN_OR_RETURN(const Grid<std::uint16_t> codes, ReadCodesFile(file, map.width, map.height));
    map.confidence.reserve(codes.size());
    for (const std::uint16_t code : codes.values()) map.confidence.push_back(static_cast<float>(code) / kCertain);
  }
  return map;
}

// [frame][camera]. Cameras that are not estimated (option views) have maps of no size.
depthfarm::Result<std::vector<std::vector<DepthMap>>> ReadMaps(const Scene& scene, const std::string& folder) {
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthManifest manifest, ReadDepthManifest(folder));
  const std::size_t frames = manifest.cameras.empty() ? 0 : manifest.cameras.front().files.size();
  std::vector<std::vector<DepthMap>> depth(frames, std::vector<DepthMap>(scene.cameras.size()));
  for (const DepthManifestCamera& camera : manifest.cameras) {
    const auto of_scene = std::ranges::find(scene.cameras, camera.camera.name, &Camera::name);
    for (std::size_t f = 0; f < frames; ++f) {
      DEPTHFARM_ASSIGN_OR_RETURN(depth[f][static_cast<std::size_t>(of_scene - scene.cameras.begin())],
                                 ReadMap(folder, camera, f));
    }
  }
  return depth;
}

Result Failure(const Status& status) {
  switch (status.code()) {
    case ErrorCode::kInvalidArgument:
      return {Code::kBadInput, status.message(), {}};
    case ErrorCode::kCancelled:
      return {Code::kCancelled, status.message(), {}};
    default:
      return {Code::kFailed, status.message(), {}};
  }
}

depthfarm::Result<std::vector<std::vector<DepthMap>>> Estimate(const Scene& scene, const Options& options) {
  if (options.threads < 0 || options.threads > kMostThreads) {
    return InvalidArgument("threads are " + std::to_string(options.threads) + ", expected 0 to " +
                           std::to_string(kMostThreads));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const PrivateFolder scratch, PrivateFolder::Make(options.scratch));
  for (const char* folder : {"pictures", "store"}) {
    DEPTHFARM_RETURN_IF_ERROR(MakeDirectories((scratch.path() / folder).string()));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string sequence, WriteSequence(scene, scratch.path() / "pictures"));
  const fs::path output = scratch.path() / "depth";
  DEPTHFARM_ASSIGN_OR_RETURN(const PlannedJob job, Plan(sequence, output, options));
  InProcessOptions farm{.store = scratch.path() / "store",
                        .slots = options.threads > 0
                                     ? options.threads
                                     : std::max(1, static_cast<int>(std::thread::hardware_concurrency()))};
  if (options.progress) farm.go_on = [&options](const JobSnapshot& now) { return options.progress(ProgressOf(now)); };
  DEPTHFARM_ASSIGN_OR_RETURN(const JobSnapshot ended, RunInProcess(job, farm));
  if (ended.state == JobState::kCancelled) return Cancelled();
  if (ended.state != JobState::kDone) return ended.error;
  return ReadMaps(scene, output.string());
}

}  // namespace

Result EstimateDepth(const Scene& scene, const Options& options) {
  depthfarm::Result<std::vector<std::vector<DepthMap>>> depth = Estimate(scene, options);
  if (!depth.ok()) return Failure(depth.status());
  return {Code::kDone, {}, std::move(*depth)};
}

const char* Version() { return DEPTHFARM_VERSION; }

}  // namespace depthfarm::library
