#include "common/job/resolved_job.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>

#include "common/geometry/neighbours.h"

namespace depthfarm {
namespace {

constexpr int kUsualPixels = 1024 * 768;    // of a larger view that is refined segments grow
constexpr double kLevelPixels = 1;          // refinement finds what lies between levels a pixel apart,
constexpr double kFinalLevelPixels = 0.25;  // without it they must be finer
// Segments x levels of all views. With the full search, below kSmallProblem splitting costs more than it saves.
constexpr long long kSmallProblem = 2'000'000;
constexpr long long kLargeProblem = 20'000'000;
// What of them takes memory in the sparse search: beliefs, and each match that has a reward.
constexpr long long kBeliefBytes = 4;
constexpr long long kMatchBytes = 8;
constexpr long long kMostParts = 4096;

// Of planes that are refined fewer are enough where pictures are large (docs/results.md, Segments of large pictures).
int AutoSegments(int pixels, int pixels_of_one, bool refined) {
  const double segments = static_cast<double>(pixels) / pixels_of_one;
  const double usual = static_cast<double>(kUsualPixels) / pixels;
  return std::max(1, static_cast<int>(refined && usual < 1 ? segments * std::sqrt(usual) : segments));
}

// For messages: the first few, with commas.
std::string CameraNames(const Sequence& sequence) {
  constexpr std::size_t kMost = 12;
  std::string names;
  for (std::size_t i = 0; i < std::min(sequence.cameras.size(), kMost); ++i)
    names += (i == 0 ? "" : ", ") + sequence.cameras[i].camera.name;
  return names + (sequence.cameras.size() > kMost ? ", ..." : "");
}

Result<std::vector<const SequenceCamera*>> SelectViews(const Sequence& sequence, const EstimationParams& params) {
  std::vector<const SequenceCamera*> selected;
  for (const SequenceCamera& camera : sequence.cameras) {
    const bool named = std::find(params.views.begin(), params.views.end(), camera.camera.name) != params.views.end();
    if (named && camera.images.empty()) {
      return InvalidArgument("camera '" + camera.camera.name + "' is asked for by views but has no pictures");
    }
    if (params.views.empty() ? !camera.images.empty() : named) selected.push_back(&camera);
  }
  for (const std::string& name : params.views) {
    const bool known = std::any_of(sequence.cameras.begin(), sequence.cameras.end(),
                                   [&](const SequenceCamera& camera) { return camera.camera.name == name; });
    if (!known) {
      return InvalidArgument("views names '" + name + "', which is no camera of the sequence: it has " +
                             CameraNames(sequence));
    }
  }
  if (selected.size() < 2) {
    return InvalidArgument("depth needs at least two views with pictures, there are " +
                           std::to_string(selected.size()));
  }
  return selected;
}

// The camera whose image plane the level planes are parallel to; it may be one without pictures.
Result<const SequenceCamera*> ReferenceCamera(const Sequence& sequence,
                                              const std::vector<const SequenceCamera*>& views) {
  if (!sequence.reference.empty()) {
    for (const SequenceCamera& camera : sequence.cameras) {
      if (camera.camera.name == sequence.reference) return &camera;
    }
    return InvalidArgument("reference is '" + sequence.reference + "', which is no camera of the sequence");
  }
  std::vector<Camera> cameras;
  cameras.reserve(views.size());
  for (const SequenceCamera* view : views) cameras.push_back(view->camera);
  return views[static_cast<std::size_t>(CentreCamera(cameras))];
}

Status ResolveRange(const Sequence& sequence, const SequenceCamera& reference, EstimationParams& params) {
  const auto choose = [](double asked, std::optional<double> own, std::optional<double> common) {
    if (asked > 0) return asked;
    return own ? *own : common.value_or(0);
  };
  params.z_near = choose(params.z_near, reference.z_near, sequence.z_near);
  params.z_far = choose(params.z_far, reference.z_far, sequence.z_far);
  if (params.z_near <= 0 || params.z_far <= 0) {
    return InvalidArgument("the sequence gives no depth range: state zNear and zFar, or use --z-near and --z-far");
  }
  return {};
}

// How far points travel over the depth range, pixels: between the median view and its nearest neighbour, or half as far
// as at the widest baseline in use, whichever is more.
double PixelsOfRange(const ResolvedJob& job, const DepthLevels& planes) {
  std::vector<double> nearest;
  double widest = 0;
  for (const JobView& view : job.views) {
    for (std::size_t i = 0; i < view.neighbours.size(); ++i) {
      const Camera& neighbour = job.views[static_cast<std::size_t>(view.neighbours[i])].camera;
      const double range = DisparityRange(view.camera, neighbour, planes);
      if (i == 0) nearest.push_back(range);
      widest = std::max(widest, range);
    }
  }
  if (nearest.empty()) return 0;
  std::sort(nearest.begin(), nearest.end());
  return std::max(nearest[nearest.size() / 2], widest / 2);
}

// Steps between levels that refinement needs.
double StepsToRefine(double pixels) {
  return std::min(std::ceil(pixels / kFinalLevelPixels),
                  std::max(kFewAutoLevels - 1.0, std::ceil(pixels / kLevelPixels)));
}

int AutoLevels(const ResolvedJob& job, const DepthLevels& planes) {
  const double pixels = PixelsOfRange(job, planes);
  const double steps = job.params.refine_rounds > 0 ? StepsToRefine(pixels) : std::ceil(pixels / kFinalLevelPixels);
  return static_cast<int>(std::clamp(steps + 1, 2.0, static_cast<double>(kMostAutoLevels)));
}

// SearchStep of a job in one part.
int StepOfWhole(const ResolvedJob& job) {
  const auto has_neighbours = [](const JobView& view) { return !view.neighbours.empty(); };
  if (job.params.search != Search::kSparse || job.params.refine_rounds == 0 ||
      std::none_of(job.views.begin(), job.views.end(), has_neighbours))
    return 1;
  const double needed = std::max(1.0, StepsToRefine(PixelsOfRange(job, job.Levels())));
  return std::max(1, static_cast<int>((job.params.levels - 1) / needed));
}

// Of `num_blocks` parts, whose levels are farther apart if they are interleaved.
int StepOfPart(int step_of_whole, const ResolvedJob& job, int num_blocks) {
  return job.params.partition == Partition::kInterleaved ? (step_of_whole + num_blocks - 1) / num_blocks
                                                         : step_of_whole;
}

void ResolveBlocks(ResolvedJob& job) {
  if (job.params.level_blocks > 0) {
    job.level_blocks_i = job.level_blocks_p = job.params.level_blocks;
    return;
  }
  long long entries = 0;
  for (const JobView& view : job.views) entries += static_cast<long long>(view.segments) * job.params.levels;
  if (job.params.search == Search::kSparse) {
    std::size_t matches = 0;
    for (const JobView& view : job.views) matches = std::max(matches, view.neighbours.size());
    const long long of_matches = kMatchBytes * static_cast<long long>(matches) / (job.params.uniqueness > 0 ? 4 : 1);
    const auto most = static_cast<int>(std::clamp<long long>(job.params.levels / 8, 1, kMostParts));
    job.level_blocks_i = 1;
    const int step = StepOfWhole(job);
    const auto bytes = [&](int parts) {
      return entries * (kBeliefBytes + of_matches) / (1LL * parts * StepOfPart(step, job, parts));
    };
    while (job.level_blocks_i < most && bytes(job.level_blocks_i) > kMostBytesOfPart) ++job.level_blocks_i;
    job.level_blocks_p = (job.level_blocks_i + 1) / 2;
    job.params.level_blocks = job.level_blocks_i;
    return;
  }
  job.level_blocks_i = entries < kSmallProblem ? 1 : std::clamp(job.params.levels / 8, 1, 8);
  job.level_blocks_p = entries < kLargeProblem ? 1 : std::min(2, job.level_blocks_i);
  job.params.level_blocks = job.level_blocks_i;
}

// Refinement samples pictures between pixels, by columns and rows.
Status CheckRefinable(const Camera& camera, const EstimationParams& params) {
  if (params.refine_rounds == 0 || (camera.width >= 2 && camera.height >= 2)) return {};
  std::string message = "camera '" + camera.name + "' is " + std::to_string(camera.width) + "x" +
                        std::to_string(camera.height) + (params.downscale > 1 ? " after downscale" : "") +
                        ": refinement needs pictures of at least 2x2 pixels: use --refine 0";
  return InvalidArgument(message + (params.downscale > 1 ? " or a smaller --downscale" : ""));
}

Status ResolveFrames(const std::vector<const SequenceCamera*>& views, ResolvedJob& job) {
  int available = static_cast<int>(views.front()->images.size());
  for (const SequenceCamera* view : views) {
    if (static_cast<int>(view->images.size()) != available) {
      return InvalidArgument("camera '" + view->camera.name + "' has " + std::to_string(view->images.size()) +
                             " pictures, camera '" + views.front()->camera.name + "' has " + std::to_string(available));
    }
  }
  EstimationParams& params = job.params;
  if (params.end_frame == -1) params.end_frame = available;
  if (params.first_frame >= available || params.end_frame > available) {
    return InvalidArgument("frames " + std::to_string(params.first_frame) + ":" + std::to_string(params.end_frame) +
                           " are asked for, the sequence has 0:" + std::to_string(available));
  }
  job.num_frames = params.end_frame - params.first_frame;
  if (params.gop == 0) params.gop = job.num_frames;
  return {};
}

}  // namespace

DepthLevels ResolvedJob::Levels() const {
  Result<DepthLevels> levels = DepthLevels::Create(reference, params.z_near, params.z_far, params.levels);
  if (!levels.ok()) std::abort();  // ResolveJob and the wire check the range before anybody can ask
  return std::move(levels).value();
}

int SearchStep(const ResolvedJob& job, int num_blocks) { return StepOfPart(StepOfWhole(job), job, num_blocks); }

ResolvedJob PartsOnly(int num_parts) {
  ResolvedJob job;
  job.params.gop = 1;
  job.params.refine_rounds = 0;
  job.params.end_frame = num_parts;
  job.num_frames = num_parts;
  job.level_blocks_i = 0;
  job.level_blocks_p = 0;
  return job;
}

Result<ResolvedJob> ResolveJob(const Sequence& sequence, const EstimationParams& params) {
  DEPTHFARM_RETURN_IF_ERROR(params.Validate());
  ResolvedJob job;
  job.params = params;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<const SequenceCamera*> selected, SelectViews(sequence, params));
  DEPTHFARM_ASSIGN_OR_RETURN(const SequenceCamera* reference, ReferenceCamera(sequence, selected));
  DEPTHFARM_RETURN_IF_ERROR(ValidateCamera(reference->camera));
  job.reference = Downscaled(reference->camera, params.downscale);
  DEPTHFARM_RETURN_IF_ERROR(ResolveRange(sequence, *reference, job.params));
  DEPTHFARM_RETURN_IF_ERROR(ResolveFrames(selected, job));

  std::vector<Camera> cameras;
  for (const SequenceCamera* view : selected) {
    DEPTHFARM_RETURN_IF_ERROR(ValidateCamera(view->camera));
    JobView job_view;
    job_view.camera = Downscaled(view->camera, params.downscale);
    job_view.source_width = view->camera.width;
    job_view.source_height = view->camera.height;
    job_view.format = view->format;
    if (AnyFile(view->prior)) job_view.prior = view->prior_format;
    job_view.masked = AnyFile(view->masks);
    DEPTHFARM_RETURN_IF_ERROR(ValidateCamera(job_view.camera));
    DEPTHFARM_RETURN_IF_ERROR(CheckRefinable(job_view.camera, params));
    const int pixels = job_view.camera.width * job_view.camera.height;
    const int automatic = AutoSegments(pixels, params.segment_pixels, params.refine_rounds > 0);
    job_view.segments = std::min(params.segments > 0 ? params.segments : automatic, pixels);
    cameras.push_back(job_view.camera);
    job.views.push_back(job_view);
  }
  // Whom a view sees and how far points travel depends on the ends of the range alone, but a view may stand between the
  // planes: it sees those that there will be at most.
  const int most_levels = params.levels > 0 ? params.levels : kMostAutoLevels;
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthLevels planes,
                             DepthLevels::Create(job.reference, job.params.z_near, job.params.z_far, most_levels));
  const std::vector<std::vector<int>> neighbours = ChooseNeighbours(cameras, planes, params.neighbours);
  for (std::size_t i = 0; i < job.views.size(); ++i) {
    const Status seen = OwnDepthRange(cameras[i], planes).status();
    if (!seen.ok()) return Status(seen.code(), seen.message() + "; the reference is '" + job.reference.name + "'");
    job.views[i].neighbours = neighbours[i];
    if (neighbours[i].empty()) {
      return InvalidArgument("camera '" + cameras[i].name +
                             "' has no neighbour that sees the same part of the scene from another place: leave it out "
                             "with --views, or check its calibration");
    }
  }
  if (params.levels == 0) {
    job.params.levels = AutoLevels(job, planes);
  }
  if (job.params.level_blocks > job.params.levels) {
    return InvalidArgument("level-blocks is " + std::to_string(job.params.level_blocks) +
                           ", expected at most the number of levels, " + std::to_string(job.params.levels));
  }
  const DepthLevels levels = job.Levels();
  const std::vector<std::vector<int>> compared = ChooseNeighbours(cameras, levels, params.compared);
  for (std::size_t i = 0; i < job.views.size(); ++i) {
    job.views[i].compared = compared[i];
    DEPTHFARM_ASSIGN_OR_RETURN(job.views[i].own_range, OwnDepthRange(cameras[i], levels));
  }
  ResolveBlocks(job);
  return job;
}

}  // namespace depthfarm
