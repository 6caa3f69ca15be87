#include "worker/media_cli/evaluate_command.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>
#include <ostream>
#include <string>

#include "common/files/atomic_file.h"
#include "common/geometry/neighbours.h"
#include "common/media/colour_map.h"
#include "common/quality/iv_psnr.h"
#include "common/quality/masks.h"
#include "common/quality/psnr.h"
#include "common/quality/single_plane.h"
#include "common/quality/ssim.h"
#include "common/quality/stability.h"
#include "common/scene/zone.h"
#include "common/sequence/frame_name.h"
#include "common/synthesis/synthesize_view.h"
#include "common/text/text_table.h"
#include "worker/media_cli/evaluate_rates.h"
#include "worker/media_cli/evaluate_report.h"
#include "worker/media_cli/evaluate_targets.h"
#include "worker/rendering/sequence_with_depth.h"

namespace depthfarm {
namespace {

// Wrong depth around a plain panel shows this far beyond it; inside, no method has anything to match.
constexpr int kPanelReachPx = 24;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

PictureFigures Compare(const SynthesizedView& view, const YcbcrImage& real, const GroundTruthFrame* truth) {
  const PixelMask seen = Inverted(view.holes);
  const LumaError whole = MeasureLumaError(view.picture, real);
  PictureFigures figures;
  figures.psnr = PsnrVideoRange(whole);
  figures.psnr_full_range = PsnrFullRange(whole);
  figures.psnr_non_hole = PsnrVideoRange(MeasureLumaError(view.picture, real, &seen));
  figures.psnr_outside_panels = kNaN;
  figures.ssim = Ssim(view.picture, real);
  figures.iv_psnr = IvPsnr(view.picture, real);
  figures.holes_percent = 100 * ShareSet(view.holes);
  if (truth != nullptr && !truth->zones.empty()) {
    const PixelMask panels = PixelsOfZone(truth->zones, static_cast<std::uint8_t>(Zone::kPanel));
    if (ShareSet(panels) > 0) {
      const PixelMask outside = Inverted(Dilated(panels, kPanelReachPx));
      figures.psnr_outside_panels = PsnrVideoRange(MeasureLumaError(view.picture, real, &outside));
    }
  }
  return figures;
}

YcbcrImage AmplifiedDifference(const YcbcrImage& a, const YcbcrImage& b) {
  YcbcrImage result(a.width(), a.height());
  for (std::size_t i = 0; i < a.size(); ++i) {
    const int difference = std::abs(static_cast<int>(a.values()[i].y) - static_cast<int>(b.values()[i].y));
    result.values()[i].y = static_cast<std::uint8_t>(std::min(4 * difference, 255));
  }
  return result;
}

// Writes DIR/<camera>/<frame>_<what>.png.
class PictureWriter {
 public:
  explicit PictureWriter(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] bool on() const { return !folder_.empty(); }
  [[nodiscard]] Status Write(const std::string& camera, int frame, const std::string& what,
                             const RgbImage& picture) const {
    const std::string folder = folder_ + "/" + camera;
    DEPTHFARM_RETURN_IF_ERROR(MakeDirectories(folder));
    DEPTHFARM_ASSIGN_OR_RETURN(const std::string png, EncodeRgbPng(picture));
    return WriteFileAtomically(folder + "/" + FrameName(frame) + "_" + what + ".png", png);
  }

 private:
  std::string folder_;
};

Status WriteDepthPicture(const SequenceWithDepth& input, int view, FrameWithDepth& frame, const PictureWriter& writer) {
  const DepthManifestCamera& camera = *input.views[static_cast<std::size_t>(view)].depth;
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthMap* depth, frame.Depth(view));
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthCode code, DepthCode::Create(camera.z_near, camera.z_far));
  DEPTHFARM_ASSIGN_OR_RETURN(const RgbImage colours, ColourMapped(*depth, code));
  return writer.Write(camera.camera.name, frame.frame(), "depth", colours);
}

Status MeasureTarget(const SequenceWithDepth& input, const EvaluateTarget& target, FrameWithDepth& frame,
                     const PictureWriter& writer, TargetReport& report) {
  const Camera& camera = CameraOf(input, target.view);
  DEPTHFARM_ASSIGN_OR_RETURN(const YcbcrImage* real, frame.Picture(target.view));
  DEPTHFARM_ASSIGN_OR_RETURN(const GroundTruthFrame* truth, frame.Truth(target.view));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<SourceView> sources, SourcesOf(input, target, false, frame));
  DEPTHFARM_ASSIGN_OR_RETURN(const SynthesizedView estimated, SynthesizeView(sources, camera));
  report.estimated.push_back(Compare(estimated, *real, truth));
  if (writer.on()) {
    const int f = frame.frame();
    DEPTHFARM_RETURN_IF_ERROR(writer.Write(camera.name, f, "synthesised", ToRgb(estimated.picture)));
    DEPTHFARM_RETURN_IF_ERROR(writer.Write(camera.name, f, "real", ToRgb(*real)));
    DEPTHFARM_RETURN_IF_ERROR(
        writer.Write(camera.name, f, "difference", ToRgb(AmplifiedDifference(estimated.picture, *real))));
    for (const int source : target.from) DEPTHFARM_RETURN_IF_ERROR(WriteDepthPicture(input, source, frame, writer));
  }

  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<SourceView> exact_sources, SourcesOf(input, target, true, frame));
  if (!exact_sources.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const SynthesizedView exact, SynthesizeView(exact_sources, camera));
    report.exact.push_back(Compare(exact, *real, truth));
    if (writer.on()) {
      DEPTHFARM_RETURN_IF_ERROR(writer.Write(camera.name, frame.frame(), "exact", ToRgb(exact.picture)));
    }
  }
  if (frame.frame() == input.first_frame) {
    std::vector<PictureView> pictures;
    pictures.reserve(sources.size());
    for (const SourceView& source : sources) pictures.push_back({source.picture, source.camera});
    DEPTHFARM_ASSIGN_OR_RETURN(const SinglePlane plane, BestSinglePlane(pictures, {real, camera}, *input.levels));
    report.single_plane_psnr = PsnrVideoRange(plane.error);
  }
  return {};
}

// Agreement of two views, both directions. With exact depth of both, that says which pixels are occluded.
Status MeasureSourceAgreement(const SequenceWithDepth& input, const EvaluateTarget& target, FrameWithDepth& frame,
                              AgreementFigures& sum, bool& by_exact_depth) {
  for (const auto& [from, to] : {std::pair{target.from[0], target.from[1]}, {target.from[1], target.from[0]}}) {
    ViewDepth view{nullptr, CameraOf(input, from)};
    ViewDepth other{nullptr, CameraOf(input, to)};
    DEPTHFARM_ASSIGN_OR_RETURN(view.depth, frame.Depth(from));
    DEPTHFARM_ASSIGN_OR_RETURN(other.depth, frame.Depth(to));
    DEPTHFARM_ASSIGN_OR_RETURN(const GroundTruthFrame* view_truth, frame.Truth(from));
    DEPTHFARM_ASSIGN_OR_RETURN(const GroundTruthFrame* other_truth, frame.Truth(to));
    if (view_truth != nullptr && other_truth != nullptr) {
      const PixelMask visible =
          VisibleInAny({&view_truth->depth, view.camera}, {{&other_truth->depth, other.camera}}, *input.levels);
      sum.Add(MeasureAgreement(view, other, *input.levels, &visible));
      by_exact_depth = true;
    } else {
      sum.Add(MeasureAgreement(view, other, *input.levels, nullptr));
    }
  }
  return {};
}

// Pixels of a view that others see: by the exact depth of its two nearest views, else by the sequence's mask; empty if
// neither is known.
Result<PixelMask> NonOccluded(const SequenceWithDepth& input, int view, const std::vector<std::vector<int>>& neighbours,
                              const GroundTruthFrame& truth, FrameWithDepth& frame) {
  std::vector<ViewDepth> others;
  for (const int other : neighbours[static_cast<std::size_t>(view)]) {
    DEPTHFARM_ASSIGN_OR_RETURN(const GroundTruthFrame* other_truth, frame.Truth(other));
    if (other_truth != nullptr) others.push_back({&other_truth->depth, CameraOf(input, other)});
  }
  if (others.empty()) return truth.nonoccluded;
  return VisibleInAny({&truth.depth, CameraOf(input, view)}, others, *input.levels);
}

// The entry of a view, made if there is none.
template <typename ViewReport>
ViewReport& EntryOf(const std::string& view, std::vector<ViewReport>& reports) {
  const auto same =
      std::find_if(reports.begin(), reports.end(), [&](const auto& report) { return report.view == view; });
  return same == reports.end() ? reports.emplace_back(ViewReport{view, {}}) : *same;
}

Status MeasureDepths(const SequenceWithDepth& input, FrameWithDepth& frame, EvaluateReport& report) {
  std::vector<Camera> cameras;
  for (const SequenceWithDepth::View& view : input.views) cameras.push_back(view.camera);
  const std::vector<std::vector<int>> neighbours = ChooseNeighbours(cameras, *input.levels, 2);
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    const int view = static_cast<int>(i);
    if (input.views[i].depth == nullptr || input.nearest[i] < 0) continue;
    DEPTHFARM_ASSIGN_OR_RETURN(const GroundTruthFrame* truth, frame.Truth(view));
    if (truth == nullptr) continue;
    DEPTHFARM_ASSIGN_OR_RETURN(const DepthMap* depth, frame.Depth(view));
    DEPTHFARM_ASSIGN_OR_RETURN(const PixelMask non_occluded, NonOccluded(input, view, neighbours, *truth, frame));
    DepthErrorInput error;
    error.estimated = depth;
    error.exact = &truth->depth;
    error.camera = input.views[i].camera;
    error.levels = &*input.levels;
    error.neighbour = CameraOf(input, input.nearest[i]);
    if (!non_occluded.empty()) error.non_occluded = &non_occluded;
    if (!truth->zones.empty()) {
      error.zones = &truth->zones;
      error.zone_names.emplace_back(ZoneName(Zone::kUnknown));
      for (const Zone zone : kSurfaceZones) error.zone_names.emplace_back(ZoneName(zone));
    }
    DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<DepthErrorGroup> groups, MeasureDepthError(error));
    AddGroups(groups, EntryOf(error.camera.name, report.depth).groups);
    DEPTHFARM_ASSIGN_OR_RETURN(const auto confidence, ReadConfidenceOf(input, view, frame.frame()));
    if (!confidence) continue;
    DEPTHFARM_RETURN_IF_ERROR(AddConfidence(error, *confidence, EntryOf(error.camera.name, report.confidence).figures));
  }
  return {};
}

// Depth of every view with pictures against that of the frame before.
Status MeasureStabilities(const SequenceWithDepth& input, FrameWithDepth& before, FrameWithDepth& now,
                          std::vector<ViewStabilityReport>& reports) {
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    const int view = static_cast<int>(i);
    if (input.views[i].depth == nullptr || input.views[i].in_sequence->images.empty()) continue;
    DEPTHFARM_ASSIGN_OR_RETURN(const YcbcrImage* old_picture, before.Picture(view));
    DEPTHFARM_ASSIGN_OR_RETURN(const YcbcrImage* picture, now.Picture(view));
    DEPTHFARM_ASSIGN_OR_RETURN(const DepthMap* old_depth, before.Depth(view));
    DEPTHFARM_ASSIGN_OR_RETURN(const DepthMap* depth, now.Depth(view));
    const PixelMask still = StillPixels(*old_picture, *picture);
    EntryOf(CameraOf(input, view).name, reports)
        .figures.Add(MeasureStability(*old_depth, {depth, CameraOf(input, view)}, still, *input.levels));
  }
  return {};
}

// Bit rates, and those of the folder to compare with, of the same views and frames.
Status MeasureAllRates(const EvaluateCommandOptions& options, const SequenceWithDepth& input,
                       const std::vector<EvaluateTarget>& targets, EvaluateReport& report) {
  DEPTHFARM_ASSIGN_OR_RETURN(report.rates, MeasureRates(input, targets, input));
  if (options.against.empty()) return {};
  SequenceWithDepth other;
  DEPTHFARM_RETURN_IF_ERROR(ReadSequenceWithDepth(options.sequence, options.against, other));
  if (other.downscale != input.downscale) {
    return InvalidArgument(options.against + " has depth of pictures downscaled by " + std::to_string(other.downscale) +
                           ", " + options.depth_dir + " by " + std::to_string(input.downscale) +
                           ": their bits cannot be compared");
  }
  EvaluateCommandOptions frames = options;
  frames.first_frame = input.first_frame;
  frames.end_frame = input.end_frame;
  DEPTHFARM_RETURN_IF_ERROR(RestrictFrames(frames, other));
  for (const EvaluateTarget& target : targets) {
    for (const int source : target.from) {
      if (other.views[static_cast<std::size_t>(source)].depth != nullptr) continue;
      return InvalidArgument("there is no depth of camera '" + CameraOf(input, source).name + "' in " +
                             options.against);
    }
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const RateReport anchor, MeasureRates(other, targets, input));
  report.against = Compare(options.against, anchor, *report.rates);
  return {};
}

double LargestLevelPx(const SequenceWithDepth& input) {
  double largest = 0;
  for (std::size_t i = 0; i < input.views.size(); ++i) {
    if (input.nearest[i] < 0 || input.views[i].depth == nullptr) continue;
    largest =
        std::max(largest, DisparityRange(input.views[i].camera, CameraOf(input, input.nearest[i]), *input.levels));
  }
  return largest / (input.levels->count() - 1);
}

// What a script may ask of the figures. All violations in one message.
Status CheckBounds(const EvaluateCommandOptions& options, const EvaluateReport& report) {
  const PictureFigures views = report.MeanEstimated();
  struct Bound {
    const char* name;
    double value;
    double bound;
    bool at_least;
  };
  const Bound bounds[] = {
      {"PSNR-Y of the virtual views, dB", views.psnr, options.min_psnr, true},
      {"IV-PSNR of the virtual views, dB", views.iv_psnr, options.min_iv_psnr, true},
      {"share of non-occluded pixels that agree, %", report.AgreementPercent(), options.min_agreement, true},
      {"share of pixels off by more than 1 px, %", report.BadPxPercent(), options.max_bad_px, false},
      {"share of still pixels whose depth changed, %", report.FlickerPercent(), options.max_flicker, false}};
  std::string violations;
  for (const Bound& bound : bounds) {
    if (std::isnan(bound.bound)) continue;
    const bool holds = bound.at_least ? bound.value >= bound.bound : bound.value <= bound.bound;
    if (holds) continue;  // a figure that was not measured, NaN, never does
    violations += (violations.empty() ? "" : "; ") + std::string(bound.name) + ": " +
                  (std::isnan(bound.value) ? "not measured" : Decimal(bound.value, 2)) + ", expected at " +
                  (bound.at_least ? "least " : "most ") + Decimal(bound.bound, 2);
  }
  return violations.empty() ? Status() : Internal(violations);
}

}  // namespace

Status RunEvaluate(const EvaluateCommandOptions& options, std::ostream& out) {
  SequenceWithDepth input;
  DEPTHFARM_RETURN_IF_ERROR(ReadSequenceWithDepth(options.sequence, options.depth_dir, input));
  DEPTHFARM_RETURN_IF_ERROR(RestrictFrames(options, input));
  EvaluateReport report;
  report.sequence = input.sequence.name;
  report.depth_dir = options.depth_dir;
  report.first_frame = input.first_frame;
  report.end_frame = input.end_frame;
  report.downscale = input.downscale;
  report.levels = input.levels->count();
  report.level_px = LargestLevelPx(input);
  report.notes = input.sequence.warnings;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<EvaluateTarget> targets, ChooseTargets(options, input, report.notes));
  for (const EvaluateTarget& target : targets) {
    TargetReport entry;
    entry.view = CameraOf(input, target.view).name;
    for (const int source : target.from) entry.from.push_back(CameraOf(input, source).name);
    if (target.from.size() == 2) entry.agreement.emplace();
    report.targets.push_back(std::move(entry));
  }

  const PictureWriter writer(options.pictures_dir);
  std::unique_ptr<FrameWithDepth> before;
  for (int f = input.first_frame; f < input.end_frame; ++f) {
    auto frame = std::make_unique<FrameWithDepth>(input, f);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      TargetReport& entry = report.targets[i];
      DEPTHFARM_RETURN_IF_ERROR(MeasureTarget(input, targets[i], *frame, writer, entry));
      if (!entry.agreement) continue;
      DEPTHFARM_RETURN_IF_ERROR(
          MeasureSourceAgreement(input, targets[i], *frame, *entry.agreement, report.agreement_by_exact_depth));
    }
    DEPTHFARM_RETURN_IF_ERROR(MeasureDepths(input, *frame, report));
    if (before != nullptr) DEPTHFARM_RETURN_IF_ERROR(MeasureStabilities(input, *before, *frame, report.stability));
    before = std::move(frame);
  }
  if (report.targets.empty() && report.depth.empty()) {
    return InvalidArgument("nothing can be measured: no camera of " + input.sequence.file +
                           " lies between two that have depth, and none has both depth and ground truth");
  }
  if (options.bit_rate || !options.against.empty()) {
    DEPTHFARM_RETURN_IF_ERROR(MeasureAllRates(options, input, targets, report));
  }

  options.json ? PrintReportAsJson(report, out) : PrintReport(report, out);
  return CheckBounds(options, report);
}

}  // namespace depthfarm
