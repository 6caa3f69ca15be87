#include "coordinator/planning/artifact_keys.h"

#include <bit>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/digest/sha256.h"
#include "common/job/artifact_versions.h"

namespace depthfarm {
namespace {

// Fields one after the other, each of a length that its kind fixes or states: different fields never read the same.
class KeyBuilder {
 public:
  explicit KeyBuilder(std::string_view operation) { Add(operation); }

  KeyBuilder& Add(std::string_view text) {
    Add(text.size());
    bytes_.append(text);
    return *this;
  }
  KeyBuilder& Add(std::integral auto number) {
    auto rest = static_cast<std::uint64_t>(number);
    for (int i = 0; i < 8; ++i, rest >>= 8U) bytes_ += static_cast<char>(rest & 0xffU);
    return *this;
  }
  KeyBuilder& Add(double number) { return Add(std::bit_cast<std::uint64_t>(number)); }
  KeyBuilder& Add(const ArtifactKey& key) {
    bytes_.append(key.begin(), key.end());
    return *this;
  }
  KeyBuilder& Add(std::span<const ArtifactKeys::Input> inputs) {
    Add(inputs.size());
    for (const auto& input : inputs) Add(static_cast<int>(input.role)).Add(input.key);
    return *this;
  }
  KeyBuilder& Add(const Camera& camera) {
    Add(camera.width).Add(camera.height);
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col) Add(camera.intrinsics(row, col)).Add(camera.cam_from_world_rotation(row, col));
      Add(camera.cam_from_world_translation[row]);
    }
    return *this;
  }
  [[nodiscard]] ArtifactKey Build() const { return Sha256(bytes_); }

 private:
  std::string bytes_;
};

ArtifactKey JobPart(const JobConfig& config) {
  const ResolvedJob& job = config.resolved;
  const EstimationParams& params = job.params;
  KeyBuilder builder("job");
  builder.Add(config.algorithm_version).Add(params.levels).Add(params.z_near).Add(params.z_far).Add(params.smoothing);
  builder.Add(params.matching_window).Add(params.matching_offset).Add(params.p_threshold).Add(params.i_threshold);
  builder.Add(params.uniqueness)
      .Add(static_cast<int>(params.search))
      .Add(params.max_sweeps)
      .Add(job.reference)
      .Add(job.views.size());
  for (const JobView& view : job.views) {
    builder.Add(view.camera).Add(view.neighbours.size());
    for (const int neighbour : view.neighbours) builder.Add(neighbour);
  }
  return builder.Build();
}

ArtifactKey RefinePart(const JobConfig& config) {
  KeyBuilder builder("refinement");
  builder.Add(kRefinedViewVersion);
  builder.Add(config.resolved.params.refine_rounds).Add(config.resolved.params.choice_rounds);
  for (const JobView& view : config.resolved.views) {
    builder.Add(view.own_range.z_near).Add(view.own_range.z_far).Add(view.compared.size());
    for (const int other : view.compared) builder.Add(other);
  }
  return builder.Build();
}

ArtifactKey FilesPart(const JobConfig& config) {
  const EstimationParams& params = config.resolved.params;
  KeyBuilder builder("files");
  builder.Add(params.confidence ? 1 : 0).Add(params.assesses() ? params.holes : 0.0);
  builder.Add(static_cast<int>(params.output_format));
  for (const JobView& view : config.resolved.views) builder.Add(view.camera.name);
  return builder.Build();
}

}  // namespace

ArtifactKeys::ArtifactKeys(const JobConfig& config)
    : partition_(config.resolved.params.partition),
      search_step_(config.render ? 1 : SearchStep(config.resolved, 1)),
      job_(JobPart(config)),
      refined_(RefinePart(config)),
      files_(FilesPart(config)) {}

ArtifactKey ArtifactKeys::Estimate(int num_blocks, int block, std::span<const Input> inputs) const {
  // One block holds all levels, however they are spread.
  const int partition = num_blocks == 1 ? 0 : 1 + static_cast<int>(partition_);
  return KeyBuilder("estimate")
      .Add(job_)
      .Add(partition)
      .Add(num_blocks)
      .Add(block)
      .Add(search_step_)
      .Add(inputs)
      .Build();
}

ArtifactKey ArtifactKeys::Merge(std::span<const Input> inputs) const {
  return KeyBuilder("merge").Add(job_).Add(inputs).Build();
}

ArtifactKey ArtifactKeys::Refine(int round, int view, std::span<const Input> inputs) const {
  return KeyBuilder("refine").Add(job_).Add(refined_).Add(round).Add(view).Add(inputs).Build();
}

ArtifactKey ArtifactKeys::AnalysisRequest(const JobConfig& config, int view, const std::string& picture,
                                          const GuideFiles& guides, std::span<const Input> inputs) {
  const JobView& of = config.resolved.views[static_cast<std::size_t>(view)];
  const EstimationParams& params = config.resolved.params;
  KeyBuilder builder("analysis request");
  builder.Add(config.algorithm_version)
      .Add(kViewAnalysisVersion)
      .Add(static_cast<int>(of.format.kind))
      .Add(of.format.bits)
      .Add(static_cast<int>(of.format.full_range))
      .Add(static_cast<int>(of.format.bt709))
      .Add(of.source_width)
      .Add(of.source_height)
      .Add(params.downscale)
      .Add(of.segments)
      .Add(params.snic_compactness)
      .Add(static_cast<int>(of.prior.holds))
      .Add(of.prior.unit)
      .Add(of.prior.z_near)
      .Add(of.prior.z_far)
      .Add(picture)
      .Add(guides.mask)
      .Add(guides.prior)
      .Add(guides.prior_confidence)
      .Add(inputs);
  // As AnalysisKey (worker/execution/analysis_key.cc): only of a P frame, which reads the analysis before it.
  if (!inputs.empty()) builder.Add(params.p_threshold);
  return builder.Build();
}

ArtifactKey ArtifactKeys::Emit(int frame_of_sequence, std::span<const Input> inputs) const {
  return KeyBuilder("emit").Add(job_).Add(refined_).Add(files_).Add(frame_of_sequence).Add(inputs).Build();
}

ArtifactKey ArtifactKeys::Assess(int view, std::span<const Input> inputs) const {
  return KeyBuilder("assess").Add(job_).Add(refined_).Add(view).Add(inputs).Build();
}

}  // namespace depthfarm
