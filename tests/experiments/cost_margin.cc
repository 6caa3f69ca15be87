#include "tests/experiments/cost_margin.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <vector>

#include "common/digest/sha256.h"
#include "common/files/atomic_file.h"
#include "common/geometry/neighbours.h"
#include "common/media/depth_file.h"
#include "tests/experiments/pixel_cut.h"
#include "worker/rendering/sequence_with_depth.h"

namespace depthfarm {
namespace {

constexpr double kHalf = 640;  // the margin whose code is the middle one: 10 grey levels

Status WriteFile(const std::string& folder, const std::string& name, const std::string& bytes,
                 std::vector<DepthManifestFile>& files) {
  const std::string path = folder + "/" + name;
  DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(std::filesystem::path(path).parent_path().string()));
  files.push_back({name, Hex(Sha256(bytes))});
  return WriteFileAtomically(path, bytes);
}

Status CopyDepth(const std::string& from, const std::string& to, const DepthManifestCamera& camera) {
  constexpr std::uint64_t kMaxBytes = std::uint64_t{1} << 30;
  std::vector<DepthManifestFile> copied;
  for (const DepthManifestFile& file : camera.files) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, ReadFileBytes(from + "/" + file.path, kMaxBytes));
    DEPTHFARM_RETURN_IF_ERROR(WriteFile(to, file.path, bytes, copied));
  }
  return {};
}

}  // namespace

Grid<std::uint16_t> CostMargins(const PixelLabelling& problem) {
  Grid<std::uint16_t> codes(problem.width, problem.height);
  std::vector<int> costs(static_cast<std::size_t>(problem.num_levels));
  for (std::size_t pixel = 0; pixel < codes.size(); ++pixel) {
    for (int level = 0; level < problem.num_levels; ++level)
      costs[static_cast<std::size_t>(level)] = problem.CostsOf(level)[pixel];
    constexpr int kNone = std::numeric_limits<std::uint16_t>::max();
    int best = kNone;
    int second = kNone;
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const bool falls = i == 0 || costs[i] < costs[i - 1];  // a plateau is one minimum
      const bool rises = i + 1 == costs.size() || costs[i] <= costs[i + 1];
      if (!falls || !rises) continue;
      second = std::min(second, std::max(best, costs[i]));
      best = std::min(best, costs[i]);
    }
    const double margin = second == kNone ? 0 : second - best;
    codes.values()[pixel] = static_cast<std::uint16_t>(65535 * margin / (margin + kHalf));
  }
  return codes;
}

Status WriteWithCostMargins(const std::string& sequence_file, const std::string& depth_dir, const std::string& output) {
  SequenceWithDepth input;
  DEPTHFARM_RETURN_IF_ERROR(ReadSequenceWithDepth(sequence_file, depth_dir, input));
  std::vector<Camera> cameras;
  for (const SequenceWithDepth::View& view : input.views) cameras.push_back(view.camera);
  const std::vector<std::vector<int>> neighbours_of = ChooseNeighbours(cameras, *input.levels, 2);
  DepthManifest manifest = input.manifest;
  for (DepthManifestCamera& camera : manifest.cameras) {
    DEPTHFARM_RETURN_IF_ERROR(CopyDepth(depth_dir, output, camera));
    camera.confidence.clear();
    DEPTHFARM_ASSIGN_OR_RETURN(const int view, FindView(input, camera.camera.name));
    const std::vector<int>& others = neighbours_of[static_cast<std::size_t>(view)];
    for (int frame = input.first_frame; frame < input.end_frame; ++frame) {
      DEPTHFARM_ASSIGN_OR_RETURN(const YcbcrImage picture, ReadPictureOf(input, view, frame));
      std::vector<YcbcrImage> pictures;
      std::vector<StereoView> neighbours;
      for (const int other : others) {
        DEPTHFARM_ASSIGN_OR_RETURN(YcbcrImage of_other, ReadPictureOf(input, other, frame));
        pictures.push_back(std::move(of_other));
      }
      for (std::size_t i = 0; i < others.size(); ++i)
        neighbours.push_back({&pictures[i], input.views[static_cast<std::size_t>(others[i])].camera});
      const PixelLabelling problem = PixelCutProblem({&picture, camera.camera}, neighbours, *input.levels, {});
      DEPTHFARM_ASSIGN_OR_RETURN(const std::string png, EncodeDepthPng(CostMargins(problem)));
      DEPTHFARM_RETURN_IF_ERROR(
          WriteFile(output, ConfidenceFileName(camera.camera.name, frame), png, camera.confidence));
    }
  }
  return WriteDepthManifest(output, manifest);
}

}  // namespace depthfarm
