#include "tests/support/rendered_sequence.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <utility>

#include "common/geometry/neighbours.h"
#include "common/job/level_partition.h"
#include "common/scene/render.h"
#include "common/scene/scene.h"
#include "worker/estimation/frame_problem.h"

namespace depthfarm::test {

RenderedSequence Render(ArrayKind kind, int cameras, int width, int height, int frames, std::uint64_t seed,
                        double noise) {
  RenderedSequence result;
  const std::vector<Camera> array = MakeArray(kind, cameras, width, height, seed);
  const Scene scene = MakeScene(seed);
  const Camera& reference = array[static_cast<std::size_t>(CentreCamera(array))];
  const DepthRange range = SceneDepthRange(scene, array, reference, frames).value();
  result.sequence.name = "rendered";
  result.sequence.z_near = range.z_near;
  result.sequence.z_far = range.z_far;
  for (const Camera& camera : array) {
    SequenceCamera entry;
    entry.camera = camera;
    entry.images.resize(static_cast<std::size_t>(frames), "/nowhere");
    result.sequence.cameras.push_back(entry);
  }
  RenderOptions options;
  options.noise = noise;
  for (int frame = 0; frame < frames; ++frame) {
    result.pictures.emplace_back();
    result.depth.emplace_back();
    result.zones.emplace_back();
    for (const Camera& camera : array) {
      RenderedView view = RenderView(scene, camera, frame, options);
      result.pictures.back().push_back(ToYcbcr(view.rgb));
      result.depth.back().push_back(std::move(view.depth));
      result.zones.back().push_back(std::move(view.zones));
    }
  }
  return result;
}

FrameAnalysis Analyse(const RenderedSequence& rendered, const ResolvedJob& job, int frame) {
  FrameAnalysis analysis;
  for (const JobView& view : job.views) {
    for (std::size_t i = 0; i < rendered.sequence.cameras.size(); ++i) {
      if (rendered.sequence.cameras[i].camera.name != view.camera.name) continue;
      Result<ViewAnalysis> result = AnalyseView(rendered.pictures[static_cast<std::size_t>(frame)][i], view.segments,
                                                job.params.snic_compactness);
      EXPECT_TRUE(result.ok()) << result.status().message();
      analysis.push_back(std::make_shared<ViewAnalysis>(std::move(result).value()));
    }
  }
  return analysis;
}

LabelField EstimateFrame(const ResolvedJob& job, const FrameAnalysis& analysis, const TemporalReferences* references,
                         int num_blocks, std::int64_t* energy) {
  const auto floors = std::make_shared<RewardFloors>();
  std::vector<LabelField> fields;
  EstimationStats stats;
  for (int block = 0; block < num_blocks; ++block) {
    stats = {};
    Result<LabelField> field =
        EstimateBlock(job, analysis, references, {num_blocks, block}, {.stats = &stats, .floors = floors});
    EXPECT_TRUE(field.ok()) << field.status().message();
    fields.push_back(std::move(field).value());
  }
  for (const std::vector<MergePair>& round : MergeRounds(num_blocks)) {
    std::vector<LabelField> merged;
    for (const MergePair& pair : round) {
      LabelField& first = fields[static_cast<std::size_t>(pair.first)];
      if (pair.second < 0) {
        merged.push_back(std::move(first));
        continue;
      }
      stats = {};
      Result<LabelField> field = MergeLabels(job, analysis, first, fields[static_cast<std::size_t>(pair.second)],
                                             {.stats = &stats, .floors = floors});
      EXPECT_TRUE(field.ok()) << field.status().message();
      merged.push_back(std::move(field).value());
    }
    fields = std::move(merged);
  }
  if (energy != nullptr) *energy = stats.energy;
  return fields.front();
}

std::int64_t EnergyOfField(const ResolvedJob& job, const FrameAnalysis& analysis, const LabelField& field) {
  const FrameProblem frame(job, analysis);
  LabellingProblem problem;
  problem.num_nodes = frame.num_nodes();
  problem.levels = LevelsOfBlock(job.params.levels, 1, Partition::kContiguous, 0);
  problem.matches_per_node = frame.matches_per_node();
  problem.smoothness = frame.smoothness();
  problem.matches = frame.MatchesOnLevels(problem.levels, {});
  problem.fixed.assign(frame.num_nodes(), 0);
  return TotalEnergy(problem, frame.ToNodes(field));
}

}  // namespace depthfarm::test
