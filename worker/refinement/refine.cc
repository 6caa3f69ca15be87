#include "worker/refinement/refine.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "common/base/parallel.h"
#include "worker/refinement/data_term.h"
#include "worker/refinement/free_pixels.h"
#include "worker/refinement/pixel_choice.h"
#include "worker/refinement/plain_regions.h"
#include "worker/refinement/plane_solver.h"
#include "worker/refinement/prior_field.h"
#include "worker/refinement/region_plane.h"
#include "worker/refinement/start_view.h"
#include "worker/refinement/view_geometry.h"

namespace depthfarm {
namespace {

constexpr int kBlurredRounds = 1;  // on smoothed pictures: a wider basin while levels are coarse
constexpr int kPlainRound = 1;     // surfaces without texture are decided as a whole
constexpr double kFirstGapScale = 1;
constexpr double kLastGapScale = 0.2;
constexpr double kLeftAside = 0.1;  // trusted at a smaller share of its segments a prior does next to nothing

Status CheckPicture(const Camera& camera, const ViewAnalysis& analysis) {
  const YcbcrImage& picture = analysis.picture;
  const SegmentMap& segments = analysis.segments;
  const auto fits = [&](int width, int height) { return width == camera.width && height == camera.height; };
  if (camera.width < 2 || camera.height < 2) {
    return InvalidArgument("camera '" + camera.name + "' is " + std::to_string(camera.width) + "x" +
                           std::to_string(camera.height) + ": refinement needs pictures of at least 2x2 pixels");
  }
  if (fits(picture.width(), picture.height()) && fits(segments.labels.width(), segments.labels.height())) return {};
  return InvalidArgument("the analysis of camera '" + camera.name + "' is " + std::to_string(picture.width()) + "x" +
                         std::to_string(picture.height()) + ", expected " + std::to_string(camera.width) + "x" +
                         std::to_string(camera.height));
}

Status CheckView(const ResolvedJob& job, int view) {
  if (view >= 0 && view < job.num_views()) return {};
  return InvalidArgument("view " + std::to_string(view) + " of a job with " + std::to_string(job.num_views()) +
                         " views is to be refined");
}

// How far a level is from the next one at the centre of each segment, pixels of u. `of_level`: PlanesOfLevels.
std::vector<double> LengthsOfLevels(std::span<const SlantedPlane> of_level, std::span<const Level> levels,
                                    std::span<const PixelPosition> centers) {
  std::vector<double> lengths;
  lengths.reserve(levels.size());
  for (std::size_t s = 0; s < levels.size(); ++s) {
    const std::size_t nearer = std::max<std::size_t>(1, levels[s]);
    const auto u = [&](std::size_t level) { return of_level[level].At(centers[s].x, centers[s].y); };
    lengths.push_back(of_level.size() > 1 ? std::abs(u(nearer) - u(nearer - 1)) : 0);
  }
  return lengths;
}

// The view and those it is compared with, in the order of `geometry`; of what is listed by view.
template <typename T>
std::vector<T> InOrder(const std::vector<T>& of_views, int view, const ViewGeometry& geometry) {
  std::vector<T> listed{of_views[static_cast<std::size_t>(view)]};
  for (const PairGeometry& pair : geometry.pairs) listed.push_back(of_views[static_cast<std::size_t>(pair.other)]);
  return listed;
}

// What the view's prior says, if it has one that can be used.
std::optional<PriorField> PriorOf(const ResolvedJob& job, std::size_t view, const ViewAnalysis& analysis,
                                  double pixels_per_inverse_depth, std::span<const std::uint8_t> plain,
                                  const RefinedView& refined) {
  if (analysis.prior.empty()) return std::nullopt;
  std::vector<std::uint8_t> told(plain.size());
  for (std::size_t s = 0; s < told.size(); ++s) told[s] = plain[s] == 0 ? 1 : 0;
  const bool relative = job.views[view].prior.holds == PriorFormat::Holds::kRelativeDepth;
  const PriorScale scale{.scale = relative ? 1 : pixels_per_inverse_depth, .fit = relative};
  return FitPrior(analysis.prior, scale, analysis.segments, told, refined);
}

// Surfaces without texture, each as a whole; then, with a prior (null: none), all other segments. `analysis` and
// `smoothed`: InOrder.
void DecideRegions(const FrameAnalysis& analysis, const ViewMemory::Smoothed& smoothed, const PictureColours& own,
                   std::span<const OtherView> others, const PriorField* prior, RefinedView& refined,
                   const std::stop_token& stop, int threads) {
  const SegmentMap& segments = analysis[0]->segments;
  const std::vector<std::uint8_t>& plain = smoothed[0]->plain;
  const std::vector<PlainRegion> regions = FindPlainRegions(segments, plain, refined);
  std::vector<std::uint8_t> decided(segments.centers.size());
  for (const PlainRegion& region : regions)
    for (const SegmentIndex s : region.segments) decided[s] = 1;
  if (prior != nullptr) TakePrior(own, segments, *prior, decided, others, refined);
  if (regions.empty()) return;
  std::vector<InverseDepthMap> occluders(others.size());
  ParallelFor(others.size(), threads, [&](std::size_t i) {
    occluders[i] = Occluders(*others[i].map, analysis[i + 1]->segments.labels, smoothed[i + 1]->plain);
  });
  std::vector<OtherView> in_front(others.begin(), others.end());
  for (std::size_t i = 0; i < in_front.size(); ++i) in_front[i].map = &occluders[i];
  DecidePlainRegions(own, segments, regions, in_front, prior, refined, stop, threads);
}

}  // namespace

Status CheckViewInputs(const ResolvedJob& job, int view, const FrameAnalysis& analysis,
                       const FrameRefinement& refined) {
  DEPTHFARM_RETURN_IF_ERROR(CheckView(job, view));
  if (analysis.size() != job.views.size() || refined.size() != job.views.size()) {
    return InvalidArgument("there are " + std::to_string(analysis.size()) + " analyses and " +
                           std::to_string(refined.size()) + " refined views for " + std::to_string(job.views.size()) +
                           " views");
  }
  std::vector<int> read = job.views[static_cast<std::size_t>(view)].compared;
  read.push_back(view);
  for (const int other : read) {
    const auto o = static_cast<std::size_t>(other);
    const Camera& camera = job.views[o].camera;
    if (analysis[o] == nullptr || refined[o] == nullptr) {
      return InvalidArgument("camera '" + camera.name + "' has no analysis or no refined depth");
    }
    DEPTHFARM_RETURN_IF_ERROR(CheckPicture(camera, *analysis[o]));
    DEPTHFARM_RETURN_IF_ERROR(CheckRefined(*analysis[o], *refined[o]).WithContext("camera '" + camera.name + "'"));
  }
  return {};
}

Status CheckRefined(const ViewAnalysis& analysis, const RefinedView& refined) {
  const Grid<SegmentIndex>& labels = analysis.segments.labels;
  if (refined.plane_of_pixel.width() == labels.width() && refined.plane_of_pixel.height() == labels.height() &&
      refined.num_segments() == analysis.segments.centers.size() && refined.planes.size() >= refined.num_segments())
    return {};
  return InvalidArgument("refined depth of " + std::to_string(refined.plane_of_pixel.width()) + "x" +
                         std::to_string(refined.plane_of_pixel.height()) + " pixels, " +
                         std::to_string(refined.num_segments()) + " segments does not fit an analysis of " +
                         std::to_string(labels.width()) + "x" + std::to_string(labels.height()) + ", " +
                         std::to_string(analysis.segments.centers.size()));
}

Result<RefinedView> StartRefinement(const ResolvedJob& job, int view, const ViewAnalysis& analysis,
                                    const ViewLabels& labels, const RefinementReferences* references) {
  DEPTHFARM_RETURN_IF_ERROR(CheckView(job, view));
  const auto v = static_cast<std::size_t>(view);
  DEPTHFARM_RETURN_IF_ERROR(CheckPicture(job.views[v].camera, analysis));
  const std::vector<SlantedPlane> of_level = PlanesOfLevels(job, view, RefinementGeometry(job, view));
  if (labels.levels.size() != analysis.segments.centers.size()) {
    return InvalidArgument("camera '" + job.views[v].camera.name + "' has " + std::to_string(labels.levels.size()) +
                           " labels for " + std::to_string(analysis.segments.centers.size()) + " segments");
  }
  std::vector<SlantedPlane> planes;
  planes.reserve(labels.levels.size());
  for (const Level level : labels.levels) {
    if (level >= of_level.size()) {
      return InvalidArgument("camera '" + job.views[v].camera.name + "' has label " + std::to_string(level) + " of " +
                             std::to_string(of_level.size()) + " levels");
    }
    planes.push_back(of_level[level]);
  }
  RefinedView start = StartView(analysis.segments, planes);
  if (references == nullptr) return start;
  for (const ReferenceView* reference : {&references->previous, &references->i_frame}) {
    DEPTHFARM_RETURN_IF_ERROR(CheckPicture(job.views[v].camera, *reference->analysis).WithContext("reference frame"));
    DEPTHFARM_RETURN_IF_ERROR(CheckRefined(*reference->analysis, *reference->refined).WithContext("reference frame"));
  }
  const auto& [previous, i_frame] = *references;
  const RefinedReference before{previous.analysis.get(), previous.refined.get()};
  KeepUnchanged(analysis, before, {i_frame.analysis.get(), i_frame.refined.get()}, job.params.p_threshold,
                job.params.i_threshold, start);
  StartFromAround(analysis.segments, before, LengthsOfLevels(of_level, labels.levels, analysis.segments.centers),
                  start);
  return start;
}

Result<RefinedView> RefineView(const ResolvedJob& job, int view, int round, const FrameAnalysis& analysis,
                               const FrameRefinement& before, const RefinementRun& run) {
  ViewMemory memory;
  return RefineView(job, view, round, analysis, before, memory, run);
}

Result<RefinedView> RefineView(const ResolvedJob& job, int view, int round, const FrameAnalysis& analysis,
                               const FrameRefinement& before, ViewMemory& memory, const RefinementRun& run) {
  const int rounds = job.params.refine_rounds;
  if (round < 1 || round > rounds) {
    return InvalidArgument("refinement round " + std::to_string(round) + " of " + std::to_string(rounds) +
                           " is asked for");
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckViewInputs(job, view, analysis, before));
  const auto v = static_cast<std::size_t>(view);
  const auto& kept = before[v]->kept;
  if (std::find(kept.begin(), kept.end(), 0) == kept.end()) return *before[v];  // nothing may move
  const ViewGeometry geometry = RefinementGeometry(job, view);
  const bool agree = round > rounds - job.params.choice_rounds;  // with the other views' depth, a choice for each pixel
  const bool blur = round <= kBlurredRounds && !agree;           // edges are chosen on the pictures as they are
  const bool has_prior = !analysis[v]->prior.empty();
  // The view itself first.
  const FrameAnalysis analyses = InOrder(analysis, view, geometry);
  ViewMemory::Smoothed smoothed;
  if (blur || round == kPlainRound || has_prior) {
    smoothed = memory.SmoothedOf(blur || round == kPlainRound ? analyses : FrameAnalysis{analysis[v]}, run.threads);
  } else {
    memory.ForgetSmoothed();
  }
  const ViewMemory::Maps maps = memory.MapsOf(InOrder(before, view, geometry), run.threads);
  const auto colours = [&](std::size_t i) -> PictureColours {
    if (blur) return smoothed[i]->colours;
    return analyses[i]->picture;
  };
  const PictureColours own = colours(0);
  std::vector<OtherView> others(geometry.pairs.size());
  ParallelFor(others.size(), run.threads, [&](std::size_t i) {
    OtherView other{.pair = &geometry.pairs[i], .colour = colours(i + 1), .map = maps[i + 1].get()};
    other.sigma = MeasureNoise(own, *maps[0], other);
    others[i] = other;
  });
  if (run.stop.stop_requested()) return Cancelled();

  RefinedView refined = *before[v];
  const SegmentMap& segments = analysis[v]->segments;
  std::optional<PriorField> prior;
  if (has_prior) prior = PriorOf(job, v, *analysis[v], geometry.pixels_per_inverse_depth, smoothed[0]->plain, refined);
  const PriorField* prior_or_null = prior.has_value() ? &*prior : nullptr;
  if (run.stats != nullptr && has_prior && round == rounds)
    run.stats->prior_left_aside = TrustedShare(prior_or_null) < kLeftAside;
  const FreePixels free(refined);
  InverseDepthMap map = *maps[0];
  if (round == kPlainRound) {
    DecideRegions(analyses, smoothed, own, others, prior_or_null, refined, run.stop, run.threads);
    if (run.stop.stop_requested()) return Cancelled();
    UpdateMap(refined, free, map, run.threads);
  }
  std::vector<NormalEquations> data =
      DataTerm(own, refined, free, map, segments.centers, others, blur, run.stop, run.threads);
  if (prior_or_null != nullptr) AddPrior(*prior_or_null, refined, segments.centers, data);
  if (agree) AddAgreement(*before[v], segments.centers, others, data, run.threads);
  if (run.stop.stop_requested()) return Cancelled();
  const double progress = rounds > 1 ? static_cast<double>(round - 1) / (rounds - 1) : 1;
  SolvePlanes(segments, data, kFirstGapScale + (kLastGapScale - kFirstGapScale) * progress, refined, run.threads);
  if (run.stop.stop_requested()) return Cancelled();
  if (agree) {
    UpdateMap(refined, free, map, run.threads);
    ChoosePlanes(analysis[v]->picture, segments.labels, map, others, prior_or_null, refined, run.stop, run.threads);
  }
  if (run.stop.stop_requested()) return Cancelled();
  return refined;
}

}  // namespace depthfarm
