#include "tests/experiments/baseline_command.h"

#include <algorithm>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <ostream>
#include <utility>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/image/depth_code.h"
#include "common/job/resolved_job.h"
#include "common/media/depth_file.h"
#include "common/media/picture_reader.h"
#include "common/sequence/read_sequence.h"
#include "tests/experiments/two_pair_sgbm.h"

namespace depthfarm {
namespace {

constexpr std::size_t kPairs = 2;

Result<std::vector<YcbcrImage>> ReadFrame(const Sequence& sequence, const ResolvedJob& job, int frame,
                                          std::vector<DepthManifestCamera>& cameras) {
  std::vector<YcbcrImage> pictures;
  for (std::size_t v = 0; v < job.views.size(); ++v) {
    const JobView& view = job.views[v];
    for (const SequenceCamera& camera : sequence.cameras) {
      if (camera.camera.name != view.camera.name) continue;
      const PictureFile file{camera.images[static_cast<std::size_t>(frame)], view.format, view.source_width,
                             view.source_height, frame};
      DEPTHFARM_ASSIGN_OR_RETURN(const PictureBytes read, ReadPictureBytes(file));
      auto picture =
          DecodePicture(read.bytes, read.format, view.source_width, view.source_height, job.params.downscale);
      if (!picture.ok()) return picture.status().WithContext(file.path);
      pictures.push_back(std::move(*picture));
      cameras[v].input_sha256.push_back(Hex(DigestOf(file, read)));
    }
  }
  return pictures;
}

// The two views to pair with: the neighbours, and where there is one only (the end of an arc) the next nearest.
std::vector<int> Partners(const JobView& view) {
  std::vector<int> partners = view.neighbours;
  for (const int other : view.compared) {
    if (partners.size() >= kPairs) break;
    if (std::find(partners.begin(), partners.end(), other) == partners.end()) partners.push_back(other);
  }
  return partners;
}

Status WriteDepth(const std::string& output, int frame, const DepthMap& depth, DepthManifestCamera& camera) {
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthCode code, DepthCode::Create(camera.z_near, camera.z_far));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string png, EncodeDepthPng(depth, code));
  const std::string name = DepthFileName(camera.camera.name, frame);
  const std::string path = output + "/" + name;
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(std::filesystem::path(path).parent_path().string()));
  camera.files.push_back({name, Hex(Sha256(png))});
  return WriteFileAtomically(path, png);
}

double CpuSeconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// Calls `of_view` with each view and its partners.
template <typename Function>
Result<std::vector<DepthMap>> ViewByView(const ResolvedJob& job, const std::vector<YcbcrImage>& pictures,
                                         const Function& of_view) {
  const auto stereo = [&](std::size_t i) { return StereoView{&pictures[i], job.views[i].camera}; };
  std::vector<DepthMap> depths;
  for (std::size_t v = 0; v < job.views.size(); ++v) {
    std::vector<StereoView> neighbours;
    for (const int other : Partners(job.views[v])) neighbours.push_back(stereo(static_cast<std::size_t>(other)));
    DEPTHFARM_ASSIGN_OR_RETURN(DepthMap depth, of_view(stereo(v), neighbours, job.views[v]));
    depths.push_back(std::move(depth));
  }
  return depths;
}

}  // namespace

Result<std::vector<DepthMap>> SgbmOfFrame(const ResolvedJob& job, const std::vector<YcbcrImage>& pictures) {
  return ViewByView(job, pictures,
                    [](const StereoView& view, const std::vector<StereoView>& neighbours, const JobView& of_job) {
                      return EstimateBySgbm(view, neighbours, of_job.own_range);
                    });
}

Result<std::vector<DepthMap>> PixelCutOfFrame(const ResolvedJob& job, const std::vector<YcbcrImage>& pictures,
                                              const PixelCutParams& params) {
  const DepthLevels levels = job.Levels();
  return ViewByView(job, pictures,
                    [&](const StereoView& view, const std::vector<StereoView>& neighbours, const JobView& /*of_job*/) {
                      return EstimateByPixelCut(view, neighbours, levels, params);
                    });
}

Status RunBaseline(const BaselineCommandOptions& options, const BaselineMethod& method, std::ostream& out) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Sequence sequence, ReadSequence(options.sequence));
  DEPTHFARM_ASSIGN_OR_RETURN(const ResolvedJob job, ResolveJob(sequence, options.params));
  DepthManifest manifest;
  manifest.sequence = sequence.name;
  manifest.first_frame = job.params.first_frame;
  manifest.parameters = method.parameters;
  manifest.parameters.merge(
      std::map<std::string, ManifestNumberOrText>{{"method", method.name},
                                                  {"reference", job.reference.name},
                                                  {"levels", std::int64_t{job.params.levels}},
                                                  {"zNear", job.params.z_near},
                                                  {"zFar", job.params.z_far},
                                                  {"downscale", std::int64_t{job.params.downscale}}});
  for (const JobView& view : job.views)
    manifest.cameras.push_back({view.camera, view.own_range.z_near, view.own_range.z_far, {}, {}, {}});

  double seconds = 0;
  for (int frame = job.params.first_frame; frame < job.params.end_frame; ++frame) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<YcbcrImage> pictures,
                               ReadFrame(sequence, job, frame, manifest.cameras));
    const double start = CpuSeconds();
    DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<DepthMap> depths, method.estimate(job, pictures));
    seconds += CpuSeconds() - start;
    for (std::size_t v = 0; v < depths.size(); ++v) {
      DEPTHFARM_RETURN_IF_ERROR(WriteDepth(options.output, frame, depths[v], manifest.cameras[v]));
    }
  }
  out << method.name << ": " << job.num_frames << " frames of " << job.num_views() << " views, "
      << seconds / (job.num_frames * job.num_views()) << " CPU s a view\n";
  return WriteDepthManifest(options.output, manifest);
}

}  // namespace depthfarm
