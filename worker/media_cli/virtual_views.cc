#include "worker/media_cli/virtual_views.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "common/geometry/camera_path.h"
#include "common/sequence/read_cameras.h"

namespace depthfarm {
namespace {

constexpr int kStepsOfASingleFrame = 60;
constexpr int kMostSteps = 1'000'000;
constexpr int kMostSources = 8;

Status CheckOptions(const SynthesizeCommandOptions& options) {
  const int ways =
      (options.view.empty() ? 0 : 1) + (options.camera_file.empty() ? 0 : 1) + (options.path.empty() ? 0 : 1);
  if (ways != 1) return InvalidArgument("expected one of --view, --camera and --path");
  if (options.steps != 0 && options.path.empty()) return InvalidArgument("--steps goes with --path");
  if (options.steps < 0 || options.steps > kMostSteps) {
    return InvalidArgument("--steps is " + std::to_string(options.steps) + ", expected 1 to " +
                           std::to_string(kMostSteps));
  }
  if (options.sources < 1 || options.sources > kMostSources) {
    return InvalidArgument("--sources is " + std::to_string(options.sources) + ", expected 1 to " +
                           std::to_string(kMostSources));
  }
  return {};
}

struct Frames {
  int first = 0;
  int end = 0;
  [[nodiscard]] int count() const { return end - first; }
  // The frame that picture i of a path shows.
  [[nodiscard]] int At(int i) const { return std::min(first + i, end - 1); }
};

Result<Frames> FramesOf(const SynthesizeCommandOptions& options, const SequenceWithDepth& input) {
  const Frames frames = {options.first_frame < 0 ? input.first_frame : options.first_frame,
                         options.end_frame < 0 ? input.end_frame : options.end_frame};
  if (frames.first < input.first_frame || frames.end > input.end_frame || frames.count() < 1) {
    return InvalidArgument("frames " + std::to_string(frames.first) + ":" + std::to_string(frames.end) +
                           " are asked for, " + input.depth_dir + " has depth of " + std::to_string(input.first_frame) +
                           ":" + std::to_string(input.end_frame));
  }
  return frames;
}

Result<std::vector<int>> NamedSources(const SynthesizeCommandOptions& options, const SequenceWithDepth& input) {
  std::vector<int> sources;
  for (const std::string& name : options.from) {
    DEPTHFARM_ASSIGN_OR_RETURN(const int view, FindView(input, name));
    if (name == options.view) return InvalidArgument("camera '" + name + "' is both --view and one of --from");
    if (input.views[static_cast<std::size_t>(view)].depth == nullptr) {
      return InvalidArgument("there is no depth of camera '" + name + "' in " + input.depth_dir);
    }
    if (std::find(sources.begin(), sources.end(), view) != sources.end()) {
      return InvalidArgument("--from names camera '" + name + "' twice");
    }
    sources.push_back(view);
  }
  return sources;
}

// The cameras of the pictures; one alone is that of every frame.
Result<std::vector<Camera>> CamerasOf(const SynthesizeCommandOptions& options, const SequenceWithDepth& input,
                                      const Frames& frames) {
  if (!options.view.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const int view, FindView(input, options.view));
    return std::vector<Camera>{input.views[static_cast<std::size_t>(view)].camera};
  }
  if (!options.camera_file.empty()) {
    Result<std::vector<Camera>> read = ReadCameras(options.camera_file);
    if (!read.ok() && FindView(input, options.camera_file).ok()) {
      return InvalidArgument(read.status().message() + "; for the view of the sequence's camera '" +
                             options.camera_file + "' say --view " + options.camera_file);
    }
    DEPTHFARM_ASSIGN_OR_RETURN(std::vector<Camera> cameras, std::move(read));
    for (const Camera& camera : cameras) {
      if (camera.width == cameras.front().width && camera.height == cameras.front().height) continue;
      return InvalidArgument(options.camera_file + ": camera '" + camera.name + "' is " + std::to_string(camera.width) +
                             "x" + std::to_string(camera.height) + ", the first " +
                             std::to_string(cameras.front().width) + "x" + std::to_string(cameras.front().height) +
                             ": the pictures of a path must have one size");
    }
    return cameras;
  }
  std::vector<Camera> stops;
  for (const std::string& name : options.path) {
    DEPTHFARM_ASSIGN_OR_RETURN(const int view, FindView(input, name));
    stops.push_back(input.views[static_cast<std::size_t>(view)].camera);
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const CameraPath path, CameraPath::Create(std::move(stops)));
  if (options.steps > 0) return path.Sample(options.steps);
  return path.Sample(frames.count() > 1 ? frames.count() : kStepsOfASingleFrame);
}

}  // namespace

Result<std::vector<VirtualView>> PlanVirtualViews(const SynthesizeCommandOptions& options,
                                                  const SequenceWithDepth& input) {
  DEPTHFARM_RETURN_IF_ERROR(CheckOptions(options));
  DEPTHFARM_ASSIGN_OR_RETURN(const Frames frames, FramesOf(options, input));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<int> named, NamedSources(options, input));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<Camera> cameras, CamerasOf(options, input, frames));
  int itself = -1;
  if (!options.view.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(itself, FindView(input, options.view));
  }
  const bool moves = cameras.size() > 1;
  const int count = moves ? static_cast<int>(cameras.size()) : frames.count();
  std::vector<VirtualView> views;
  for (int i = 0; i < count; ++i) {
    VirtualView view;
    view.camera = cameras[moves ? static_cast<std::size_t>(i) : 0];
    view.frame = frames.At(i);
    view.number = options.view.empty() ? i : view.frame;
    if (!named.empty()) {
      view.sources = named;
    } else if (!moves && i > 0) {
      view.sources = views.front().sources;
    } else {
      view.sources = SourcesFor(input, view.camera, options.sources, itself);
    }
    if (view.sources.empty()) {
      return InvalidArgument("no camera with depth sees what '" + view.camera.name +
                             "' does: name its sources with --from, or place it elsewhere");
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace depthfarm
