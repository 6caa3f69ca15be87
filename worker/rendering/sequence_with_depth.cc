#include "worker/rendering/sequence_with_depth.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>
#include <variant>

#include "common/geometry/neighbours.h"
#include "common/media/depth_file.h"
#include "common/media/picture_reader.h"
#include "common/sequence/read_sequence.h"

namespace depthfarm {
namespace {

constexpr int kPaperLevels = 250;
constexpr double kSameCalibration = 1e-6;  // of a focal length, a rotation's entry, the size of the translation
constexpr double kSameWay = 0.5;           // cosine of two axes: 60 degrees, as ChooseNeighbours
constexpr float kSameSurface = 0.02F;      // depths within this share of each other are averaged when downscaling

std::optional<double> NumberParameter(const DepthManifest& manifest, const std::string& key) {
  const auto found = manifest.parameters.find(key);
  if (found == manifest.parameters.end()) return std::nullopt;
  if (const auto* whole = std::get_if<std::int64_t>(&found->second)) return static_cast<double>(*whole);
  if (const auto* number = std::get_if<double>(&found->second)) return *number;
  return std::nullopt;
}

std::string TextParameter(const DepthManifest& manifest, const std::string& key) {
  const auto found = manifest.parameters.find(key);
  if (found == manifest.parameters.end()) return "";
  const auto* text = std::get_if<std::string>(&found->second);
  return text != nullptr ? *text : "";
}

bool SameCalibration(const Camera& a, const Camera& b) {
  const double focal = std::max(a.intrinsics(0, 0), a.intrinsics(1, 1));
  if ((a.intrinsics - b.intrinsics).cwiseAbs().maxCoeff() > kSameCalibration * focal) return false;
  if ((a.cam_from_world_rotation - b.cam_from_world_rotation).cwiseAbs().maxCoeff() > kSameCalibration) return false;
  const double size = a.cam_from_world_translation.cwiseAbs().maxCoeff();
  return (a.cam_from_world_translation - b.cam_from_world_translation).cwiseAbs().maxCoeff() <= kSameCalibration * size;
}

std::string Size(const Camera& camera) { return std::to_string(camera.width) + "x" + std::to_string(camera.height); }

// How many times smaller than its picture the depth of a camera is: 1, 2 or 4.
Result<int> DownscaleOf(const SequenceCamera& in_sequence, const Camera& of_depth) {
  for (const int factor : {1, 2, 4}) {
    const Camera scaled = Downscaled(in_sequence.camera, factor);
    if (scaled.width != of_depth.width || scaled.height != of_depth.height) continue;
    if (SameCalibration(scaled, of_depth)) return factor;
    return InvalidArgument("camera '" + of_depth.name +
                           "': depth.json has another calibration than the sequence; estimate the depth again");
  }
  return InvalidArgument("camera '" + of_depth.name + "': the depth is " + Size(of_depth) + ", the picture " +
                         Size(in_sequence.camera) + "; expected it 1, 2 or 4 times smaller");
}

Status AddViews(SequenceWithDepth& input) {
  std::optional<int> downscale;
  for (const DepthManifestCamera& depth : input.manifest.cameras) {
    const auto same_name = [&](const SequenceCamera& camera) { return camera.camera.name == depth.camera.name; };
    const auto found = std::find_if(input.sequence.cameras.begin(), input.sequence.cameras.end(), same_name);
    if (found == input.sequence.cameras.end()) {
      return InvalidArgument(input.depth_dir + ": depth.json has camera '" + depth.camera.name +
                             "', which the sequence " + input.sequence.file + " has not");
    }
    DEPTHFARM_ASSIGN_OR_RETURN(const int factor, DownscaleOf(*found, depth.camera));
    if (downscale && *downscale != factor) {
      return InvalidArgument("camera '" + depth.camera.name + "': its depth is " + std::to_string(factor) +
                             " times smaller than its picture, that of other cameras " + std::to_string(*downscale));
    }
    downscale = factor;
  }
  input.downscale = downscale.value_or(1);
  for (const SequenceCamera& camera : input.sequence.cameras) {
    SequenceWithDepth::View view;
    view.camera = Downscaled(camera.camera, input.downscale);
    view.in_sequence = &camera;
    for (const DepthManifestCamera& depth : input.manifest.cameras) {
      if (depth.camera.name == view.camera.name) view.depth = &depth;
    }
    for (const GroundTruthView& truth : input.sequence.ground_truth) {
      if (truth.view == view.camera.name) view.truth = &truth;
    }
    input.views.push_back(view);
  }
  return {};
}

// The planes that the depth was estimated on.
Status SetLevels(SequenceWithDepth& input) {
  double z_near = NumberParameter(input.manifest, "zNear").value_or(input.sequence.z_near.value_or(0));
  double z_far = NumberParameter(input.manifest, "zFar").value_or(input.sequence.z_far.value_or(0));
  std::vector<Camera> cameras;
  for (const DepthManifestCamera& camera : input.manifest.cameras) {
    cameras.push_back(camera.camera);
    if (z_near > 0 && z_far > 0) continue;
    z_near = z_near > 0 ? std::min(z_near, camera.z_near) : camera.z_near;
    z_far = std::max(z_far, camera.z_far);
  }
  std::string reference = TextParameter(input.manifest, "reference");
  if (reference.empty()) reference = input.sequence.reference;
  if (reference.empty()) reference = cameras[static_cast<std::size_t>(CentreCamera(cameras))].name;
  DEPTHFARM_ASSIGN_OR_RETURN(const int index, FindView(input, reference));
  const double recorded = NumberParameter(input.manifest, "levels").value_or(0);
  const int count = recorded >= 2 ? static_cast<int>(std::min<double>(recorded, kMaxLevels)) : kPaperLevels;
  DEPTHFARM_ASSIGN_OR_RETURN(
      const DepthLevels levels,
      DepthLevels::Create(input.views[static_cast<std::size_t>(index)].camera, z_near, z_far, count));
  input.levels = levels;
  return {};
}

void FindNearest(SequenceWithDepth& input) {
  std::vector<Camera> cameras;
  for (const SequenceWithDepth::View& view : input.views) cameras.push_back(view.camera);
  for (const std::vector<int>& list : ChooseNeighbours(cameras, *input.levels, 1)) {
    input.nearest.push_back(list.empty() ? -1 : list.front());
  }
}

// The depth at the middle of `factor` x `factor` pixels: an even factor puts it between four of them.
float MiddleDepth(const DepthMap& depth, int x, int y) {
  float least = depth(x, y);
  float most = least;
  float inverse = 0;
  for (const auto& [px, py] : {std::pair{x, y}, {x + 1, y}, {x, y + 1}, {x + 1, y + 1}}) {
    const float z = depth(px, py);
    least = std::min(least, z);
    most = std::max(most, z);
    inverse += z > 0 ? 0.25F / z : 0;
  }
  if (!(least > 0) || most - least > kSameSurface * most) return depth(x, y);
  return 1.0F / inverse;
}

template <typename T>
Grid<T> Subsampled(const Grid<T>& grid, int factor) {
  if (grid.empty()) return {};
  Grid<T> result(grid.width() / factor, grid.height() / factor);
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      result(x, y) = grid(x * factor + factor / 2 - 1, y * factor + factor / 2 - 1);
    }
  }
  return result;
}

GroundTruthFrame Downscaled(const GroundTruthFrame& truth, int factor) {
  GroundTruthFrame result;
  result.depth = Subsampled(truth.depth, factor);
  for (int y = 0; y < result.depth.height(); ++y) {
    for (int x = 0; x < result.depth.width(); ++x) {
      result.depth(x, y) = MiddleDepth(truth.depth, x * factor + factor / 2 - 1, y * factor + factor / 2 - 1);
    }
  }
  result.zones = Subsampled(truth.zones, factor);
  result.nonoccluded = Subsampled(truth.nonoccluded, factor);
  return result;
}

// The views with pictures and depth that a target may be synthesised from; views are indices into `views`.
class Candidates {
 public:
  Candidates(const SequenceWithDepth& input, const Camera& target, int except) : input_(input), cameras_{target} {
    for (std::size_t i = 0; i < input.views.size(); ++i) {
      const SequenceWithDepth::View& view = input.views[i];
      if (view.depth == nullptr || view.in_sequence->images.empty() || static_cast<int>(i) == except) continue;
      cameras_.push_back(view.camera);
      views_.push_back(static_cast<int>(i));
    }
  }

  // ChooseNeighbours of the target.
  [[nodiscard]] std::vector<int> Choose(int most) const {
    std::vector<int> chosen = ChooseNeighbours(cameras_, *input_.levels, most).front();
    for (int& index : chosen) index = views_[static_cast<std::size_t>(index - 1)];
    return chosen;
  }
  // Those that ChooseNeighbours leaves out because they show no parallax, though they see the scene.
  [[nodiscard]] std::vector<int> InTheSamePlace() const {
    std::vector<int> result;
    for (const int view : views_) {
      const Eigen::Vector3d step = Baseline(view);
      const Camera& camera = input_.views[static_cast<std::size_t>(view)].camera;
      const double cosine = OrderedDot(OpticalAxisInWorld(camera), OpticalAxisInWorld(cameras_.front()));
      if (OrderedDot(step, step) == 0 && cosine > kSameWay) result.push_back(view);
    }
    return result;
  }
  [[nodiscard]] Eigen::Vector3d Baseline(int view) const {
    return CenterInWorld(input_.views[static_cast<std::size_t>(view)].camera) - CenterInWorld(cameras_.front());
  }

 private:
  const SequenceWithDepth& input_;
  std::vector<Camera> cameras_;  // the target, then the candidates
  std::vector<int> views_;       // of the candidates
};

}  // namespace

Status ReadSequenceWithDepth(const std::string& sequence_file, const std::string& depth_dir, SequenceWithDepth& input) {
  input.depth_dir = depth_dir;
  DEPTHFARM_ASSIGN_OR_RETURN(input.sequence, ReadSequence(sequence_file));
  DEPTHFARM_ASSIGN_OR_RETURN(input.manifest, ReadDepthManifest(depth_dir));
  if (input.manifest.cameras.empty() || input.manifest.cameras.front().files.empty()) {
    return InvalidArgument(depth_dir + ": depth.json lists no depth maps");
  }
  input.first_frame = input.manifest.first_frame;
  input.end_frame = input.first_frame + static_cast<int>(input.manifest.cameras.front().files.size());
  DEPTHFARM_RETURN_IF_ERROR(AddViews(input));
  DEPTHFARM_RETURN_IF_ERROR(SetLevels(input));
  FindNearest(input);
  return {};
}

Result<int> FindView(const SequenceWithDepth& input, const std::string& name) {
  std::string names;
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    if (input.views[i].camera.name == name) return static_cast<int>(i);
    names += (i == 0 ? "" : ", ") + input.views[i].camera.name;
  }
  return InvalidArgument("there is no camera '" + name + "' in " + input.sequence.file + "; it has " + names);
}

std::vector<int> SidesOf(const SequenceWithDepth& input, int target) {
  const Candidates candidates(input, input.views[static_cast<std::size_t>(target)].camera, target);
  std::vector<int> chosen = candidates.Choose(2);
  if (chosen.size() != 2) return {};
  const Eigen::Vector3d first = candidates.Baseline(chosen[0]);
  const Eigen::Vector3d second = candidates.Baseline(chosen[1]);
  if (OrderedDot(first, second) >= 0) return {};  // both on one side, e.g. at the corner of a grid
  return chosen;
}

std::vector<int> SourcesFor(const SequenceWithDepth& input, const Camera& target, int count, int except) {
  const Candidates candidates(input, target, except);
  std::vector<int> sources = candidates.InTheSamePlace();
  std::vector<int> chosen = candidates.Choose(count);
  if (static_cast<int>(chosen.size()) < count)
    chosen = candidates.Choose(std::max(count, 3));  // beyond the array: all on one side
  sources.insert(sources.end(), chosen.begin(), chosen.end());
  if (static_cast<int>(sources.size()) > count) sources.resize(static_cast<std::size_t>(count));
  return sources;
}

Result<YcbcrImage> ReadPictureOf(const SequenceWithDepth& input, int view, int frame) {
  const SequenceCamera& camera = *input.views[static_cast<std::size_t>(view)].in_sequence;
  if (frame < 0 || static_cast<std::size_t>(frame) >= camera.images.size()) {
    return InvalidArgument("camera '" + camera.camera.name + "' has " + std::to_string(camera.images.size()) +
                           " pictures, frame " + std::to_string(frame) + " is beyond them");
  }
  return ReadPicture(
      {camera.images[static_cast<std::size_t>(frame)], camera.format, camera.camera.width, camera.camera.height, frame},
      input.downscale, input.videos.get());
}

Result<DepthMap> ReadDepthOf(const SequenceWithDepth& input, int view, int frame) {
  const SequenceWithDepth::View& of = input.views[static_cast<std::size_t>(view)];
  if (of.depth == nullptr) {
    return InvalidArgument("there is no depth of camera '" + of.camera.name + "' in " + input.depth_dir);
  }
  return ReadDepthOf(input.depth_dir, *of.depth, static_cast<std::size_t>(frame - input.manifest.first_frame));
}

Result<std::optional<Grid<std::uint16_t>>> ReadConfidenceOf(const SequenceWithDepth& input, int view, int frame) {
  const DepthManifestCamera* depth = input.views[static_cast<std::size_t>(view)].depth;
  const auto position = static_cast<std::size_t>(frame - input.manifest.first_frame);
  if (depth == nullptr || position >= depth->confidence.size()) return std::optional<Grid<std::uint16_t>>();
  const std::string path = (std::filesystem::path(input.depth_dir) / depth->confidence[position].path).string();
  DEPTHFARM_ASSIGN_OR_RETURN(Grid<std::uint16_t> codes, ReadCodesFile(path, depth->camera.width, depth->camera.height));
  return std::optional(std::move(codes));
}

Result<const YcbcrImage*> FrameWithDepth::Picture(int view) {
  const auto found = pictures_.find(view);
  if (found != pictures_.end()) return &found->second;
  DEPTHFARM_ASSIGN_OR_RETURN(YcbcrImage picture, ReadPictureOf(input_, view, frame_));
  return &pictures_.emplace(view, std::move(picture)).first->second;
}

Result<const DepthMap*> FrameWithDepth::Depth(int view) {
  const auto found = depths_.find(view);
  if (found != depths_.end()) return &found->second;
  DEPTHFARM_ASSIGN_OR_RETURN(DepthMap depth, ReadDepthOf(input_, view, frame_));
  return &depths_.emplace(view, std::move(depth)).first->second;
}

Result<const GroundTruthFrame*> FrameWithDepth::Truth(int view) {
  const auto found = truths_.find(view);
  if (found != truths_.end()) return &found->second;
  const SequenceWithDepth::View& of = input_.views[static_cast<std::size_t>(view)];
  if (of.truth == nullptr || static_cast<std::size_t>(frame_) >= of.truth->depth.size()) return nullptr;
  const Camera& full_size = of.in_sequence->camera;
  DEPTHFARM_ASSIGN_OR_RETURN(GroundTruthFrame truth,
                             ReadGroundTruth(*of.truth, frame_, full_size.width, full_size.height));
  if (input_.downscale > 1) truth = Downscaled(truth, input_.downscale);
  return &truths_.emplace(view, std::move(truth)).first->second;
}

}  // namespace depthfarm
