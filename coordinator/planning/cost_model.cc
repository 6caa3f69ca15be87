#include "coordinator/planning/cost_model.h"

#include <algorithm>
#include <cmath>

namespace depthfarm {
namespace {

// Where the constants come from: jobs of algorithm version 10 on one worker, CPU seconds of the stages as reported,
// peak memory of a worker that started afresh. The scenes are arcs that `depthfarm scene arc` renders: seed 301, 5
// views of 640x480; 113, 5 of 1024x768; 117, 6 of 1920x1080; each by default, the first one also with the presets best,
// fast and (320x240) paper, --level-blocks 4, --sweeps 1, --neighbors 4, --confidence on, --levels 25, one to four
// --compared, one to four rounds, none to two of choice, and four frames. Figures in the tests of this file. Sizes of
// artifacts are of version 8, with the label maps that came after (docs/benchmarks.md, Artifacts between workers).
//
// Photographs take longer where these scenes are easy: of six real sets (docs/benchmarks.md, Predicted times) Refine
// took 0.6 to 2 times as long as rendered scenes of the same sizes would, Estimate 1 to 2.5 times. Predictions stand
// between.
constexpr double kContent = 1.3;

constexpr double kNano = 1e-9;
constexpr double kMicro = 1e-6;

// Analyse. Reading, digest and decoding are of the picture as it is, all else of the downscaled one: 225 to 260 ns a
// pixel together, where nothing is downscaled.
constexpr double kDecodePixel = 25 * kNano;
constexpr double kAnalysePixel = 220 * kNano;
constexpr double kAnalysedShareOfPFrame = 0.45;  // segments of what stands still are kept

// Estimate, a segment: what every part does anew, and what it does for each of its levels. Sparse: 34 to 250 levels in
// one to four parts fit within 15 %; of few levels each is for everybody, which photographs ask twice as much of as
// scenes do (llff_fern, 25 levels, 22 us a segment, arc 301 8 us), so that 33 levels take less than 32. Where only each
// k-th level is tried first (SearchStep), the other levels cost no more than kNearLevel: 5 views of 1920x1080, 100,000
// segments and 250 levels, k = 3. Full: a sweep over 8 levels, and with every match in full (uniqueness 0) over 250.
constexpr double kSparseSegment = 2.8 * kMicro;
constexpr double kSparseLevel = 0.07 * kMicro;
constexpr double kFewLevels = 32;  // as in worker/optimization/level_search.cc
constexpr double kFewLevel = 0.27 * kMicro;
constexpr double kNearLevel = 0.02 * kMicro;
constexpr double kMatchLevel = 0.02 * kMicro;  // for each neighbour
constexpr double kFullSegment = 0.5 * kMicro;
constexpr double kSweptLevel = 0.38 * kMicro;
constexpr double kSweptLevelOfAllMatches = 0.2 * kMicro;
constexpr int kSweepsUntilNothingChanges = 6;  // measured with the preset paper

// Merge, a segment: 1.5 us with 34 levels, 2.7 us with 250.
constexpr double kMergeSegment = 1.35 * kMicro;
constexpr double kMergeLevel = 5 * kNano;

// So much of an I frame's work a P frame's search takes, and each of its rounds of refinement: what moves has jumps
// around it.
constexpr double kChangedShare = 0.12;
constexpr double kRefinedShare = 0.25;

// Refine, a pixel: in each round, and more for each view it is compared with. A round of choice looks closer at pixels
// near jumps; there are as many as jumps are long, which grows with the root of the pixels, and with fewer views to
// compare with there are more: that takes hardly less time.
constexpr double kStartPixel = 10 * kNano;
constexpr double kStartPixelOfPFrame = 30 * kNano;
constexpr double kRoundPixel = 43 * kNano;
constexpr double kRoundPixelOfCompared = 11.5 * kNano;
constexpr double kFirstRoundPixel = 20 * kNano;  // more: smoothed pictures, surfaces without texture
constexpr double kFirstRoundPixelOfCompared = 8 * kNano;
constexpr double kChoicePixel = 53 * kNano;        // more
constexpr double kChoiceJumpPixel = 141 * kMicro;  // times the root of the pixels
constexpr double kLaterChoice = 0.82;              // less is open after the first choice

constexpr double kAssessPixel = 140 * kNano;  // and a view it is compared with
constexpr double kEmitPixel = 34 * kNano;
constexpr double kEmitPixelOfExr = 115 * kNano;
constexpr double kEmitPixelOfLevels = 16 * kNano;  // depth of levels compresses better, with less work
constexpr double kFileSeconds = 0.8e-3;            // renamed into place; named in the manifest
constexpr double kFileInManifest = 20 * kMicro;
constexpr double kRenderPart = 1.5;  // a part of a rendering job (job_plan.h)

// Artifacts and files, stored bytes. 0.9 to 1.2 of what was measured.
constexpr double kAnalysisPixelStored = 1.6;
constexpr double kAnalysisSegmentStored = 1.5;
constexpr double kLabelStored = 0.27;
constexpr double kLabelLevelStored = 0.0011;
constexpr double kLabelOfPFrame = 1.6;  // also says which are unchanged
constexpr double kRefinedPixelStored = 0.09;
constexpr double kStartSegmentStored = 2.5;
constexpr double kRefinedSegmentStored = 12.7;
constexpr double kKeptPixelStored = 0.76;  // more, in P frames: what was kept has planes of its own
constexpr double kConfidencePixelStored = 1.15;
constexpr double kDepthPixelStored = 1.1;
constexpr double kLevelPixelStored = 0.33;
constexpr double kPfmPixelStored = 4;
constexpr double kExrPixelStored = 2.5;
constexpr double kRawPixelStored = 3;

// Memory of a worker beside that of the process, bytes.
constexpr double kAnalysisPixel = 8;     // colour, segment
constexpr double kAnalysisSegment = 48;  // centre, mean, three neighbours
constexpr double kRefinedPixel = 4;
constexpr double kRefinedSegment = 13;
constexpr double kAnalysingPixel = 65;
constexpr double kGraphSegment = 520;
constexpr double kBeliefLevel = 3;   // of a segment, sparse search
constexpr double kMatchOfAll = 6;    // of a segment, a level and a neighbour, every match in full
constexpr double kMatchOfFew = 1.5;  // a quarter has a reward
constexpr double kRefiningPixel = 110;
constexpr double kEmittingPixel = 8;
constexpr double kDecoderPixel = 14;  // of a coded video: what a picture refers to; H.264 of 1920x1080 has 27 MiB

// Checking, decompressing and decoding what another worker made, per stored byte: what jobs of two and four workers
// took more than those of one, 12 to 30 ns, which is in part what the views of a round share on one worker.
constexpr double kReadByte = 18 * kNano;

double PixelsOf(const JobView& view) {
  return static_cast<double>(view.camera.width) * static_cast<double>(view.camera.height);
}

double AnalysisBytes(double pixels, double segments) { return kAnalysisPixel * pixels + kAnalysisSegment * segments; }

TaskCost Cost(double seconds, double memory, double result) {
  return {seconds, kProcessMemoryBytes + static_cast<std::uint64_t>(memory), static_cast<std::uint64_t>(result)};
}

}  // namespace

CostModel::CostModel(const ResolvedJob& job) : job_(job) {
  for (const JobView& view : job.views) {
    pixels_ += PixelsOf(view);
    segments_ += view.segments;
  }
  if (job.num_views() == 0) return;  // a rendering job
  search_step_i_ = SearchStep(job, job.level_blocks_i);
  search_step_p_ = SearchStep(job, job.level_blocks_p);
}

double CostModel::SecondsToRead(std::uint64_t stored_bytes) { return kReadByte * static_cast<double>(stored_bytes); }

TaskCost CostModel::Of(const TaskId& id) const {
  const bool i_frame = job_.IsIFrame(id.frame);
  const auto view = [&](int index) -> const JobView& { return job_.views[static_cast<std::size_t>(index)]; };
  const double files = static_cast<double>(job_.num_views()) * (job_.params.confidence ? 2 : 1);
  switch (id.kind) {
    case TaskKind::kAnalyse:
      return Analyse(i_frame, view(id.index));
    case TaskKind::kEstimate:
      return Estimate(i_frame);
    case TaskKind::kMerge:
      return Merge(i_frame);
    case TaskKind::kRefine:
      return Refine(i_frame, id.index, view(id.pair));
    case TaskKind::kAssess:
      return Assess(view(id.index));
    case TaskKind::kEmit:
      return Emit(i_frame);
    case TaskKind::kRender:
      return Cost(kRenderPart, 0, 0);
    case TaskKind::kCommit:
      return Cost(kFileSeconds * files, 0, 0);
    case TaskKind::kManifest:
      return Cost(kFileSeconds + kFileInManifest * files * job_.num_frames, 0, 0);
    case TaskKind::kPrepare:
    case TaskKind::kCleanup:
      return Cost(kFileSeconds, 0, 0);
  }
  return {};
}

TaskCost CostModel::Analyse(bool i_frame, const JobView& view) const {
  const double pixels = PixelsOf(view);
  const double source = static_cast<double>(view.source_width) * static_cast<double>(view.source_height);
  return Cost(kDecodePixel * source + kAnalysePixel * pixels * (i_frame ? 1 : kAnalysedShareOfPFrame),
              kAnalysingPixel * pixels + AnalysisBytes(pixels, view.segments) +
                  (view.format.kind == PictureFormat::Kind::kVideo ? kDecoderPixel * source : 0),
              kAnalysisPixelStored * pixels + kAnalysisSegmentStored * view.segments);
}

TaskCost CostModel::Estimate(bool i_frame) const {
  const EstimationParams& params = job_.params;
  const double levels = static_cast<double>(params.levels) / (i_frame ? job_.level_blocks_i : job_.level_blocks_p);
  const double step = i_frame ? search_step_i_ : search_step_p_;
  const bool in_steps = step > 1 && levels > step;
  const double tried = in_steps ? levels / step : levels;
  const double neighbours = params.neighbours;
  const bool sparse = params.search == Search::kSparse;
  const bool all_matches = params.uniqueness == 0;
  const int sweeps = params.max_sweeps > 0 ? params.max_sweeps : kSweepsUntilNothingChanges;
  const double sparse_level = tried <= kFewLevels ? kFewLevel : kSparseLevel;
  const double level = sparse ? sparse_level : sweeps * (all_matches ? kSweptLevelOfAllMatches : kSweptLevel);
  const double segment = (sparse ? kSparseSegment : kFullSegment) + (level + kMatchLevel * neighbours) * tried +
                         (in_steps ? kNearLevel * levels : 0);
  const double nodes = segments_ * (i_frame ? 1 : kChangedShare);
  const double graph =
      kGraphSegment + tried * ((sparse ? kBeliefLevel : 0) + (all_matches ? kMatchOfAll : kMatchOfFew) * neighbours);
  const double frames_read = i_frame ? 1 : 3;  // itself, the one before, the I frame
  const double stored = (kLabelStored + kLabelLevelStored * levels) * (i_frame ? 1 : kLabelOfPFrame);
  return Cost(kContent * nodes * segment, frames_read * AnalysisBytes(pixels_, segments_) + nodes * graph,
              segments_ * stored);
}

TaskCost CostModel::Merge(bool i_frame) const {
  const double nodes = segments_ * (i_frame ? 1 : kChangedShare);
  const double stored = (kLabelStored + kLabelLevelStored * job_.params.levels) * (i_frame ? 1 : kLabelOfPFrame);
  return Cost(nodes * (kMergeSegment + kMergeLevel * job_.params.levels),
              AnalysisBytes(pixels_, segments_) + nodes * kGraphSegment, segments_ * stored);
}

double CostModel::ComparedBytes(const JobView& view) const {
  const auto bytes = [](const JobView& one) {
    const double pixels = PixelsOf(one);
    return AnalysisBytes(pixels, one.segments) + kRefinedPixel * pixels + kRefinedSegment * one.segments;
  };
  double sum = bytes(view);
  for (const int other : view.compared) sum += bytes(job_.views[static_cast<std::size_t>(other)]);
  return sum;
}

TaskCost CostModel::Refine(bool i_frame, int round, const JobView& view) const {
  const double pixels = PixelsOf(view);
  const double compared = static_cast<double>(view.compared.size());
  const double kept = i_frame ? 0 : kKeptPixelStored * pixels;
  if (round == 0) {
    const double frames_read = i_frame ? 1 : 3;
    return Cost((i_frame ? kStartPixel : kStartPixelOfPFrame) * pixels,
                frames_read * (AnalysisBytes(pixels, view.segments) + kRefinedPixel * pixels),
                kRefinedPixelStored * pixels + kStartSegmentStored * view.segments + kept);
  }
  const int first_choice = std::max(1, job_.params.refine_rounds - job_.params.choice_rounds + 1);
  double seconds = (kRoundPixel + kRoundPixelOfCompared * compared) * pixels;
  if (round == 1) seconds += (kFirstRoundPixel + kFirstRoundPixelOfCompared * compared) * pixels;
  if (round >= first_choice) {
    const double jumps = kChoicePixel * pixels + kChoiceJumpPixel * std::sqrt(pixels);
    seconds += jumps * (round == first_choice ? 1 : kLaterChoice);
  }
  return Cost(kContent * seconds * (i_frame ? 1 : kRefinedShare), ComparedBytes(view) + kRefiningPixel * pixels,
              kRefinedPixelStored * pixels + kRefinedSegmentStored * view.segments + kept);
}

TaskCost CostModel::Assess(const JobView& view) const {
  const double pixels = PixelsOf(view);
  return Cost(kAssessPixel * static_cast<double>(view.compared.size()) * pixels,
              ComparedBytes(view) + kRefiningPixel * pixels, kConfidencePixelStored * pixels);
}

TaskCost CostModel::Emit(bool i_frame) const {
  const bool refined = job_.params.refine_rounds > 0;
  const bool confidence = job_.params.confidence;
  double seconds = (refined ? kEmitPixel : kEmitPixelOfLevels) * pixels_;
  double stored = pixels_;
  switch (job_.params.output_format) {
    case DepthFormat::kPng16:
      stored *= refined ? kDepthPixelStored : kLevelPixelStored;
      break;
    case DepthFormat::kPfm:
      stored *= kPfmPixelStored;
      break;
    case DepthFormat::kExr:
      seconds = kEmitPixelOfExr * pixels_;
      stored *= kExrPixelStored;
      break;
    case DepthFormat::kYuv420p16:
      stored *= kRawPixelStored;
      break;
  }
  if (confidence) {
    seconds += kEmitPixel * pixels_;
    stored += kConfidencePixelStored * pixels_;
  }
  const double kept = i_frame ? 0 : kAnalysisSegment * segments_;
  const double of_views =
      refined ? kRefinedPixel * pixels_ + kRefinedSegment * segments_ + kept : AnalysisBytes(pixels_, segments_);
  const double largest = job_.views.empty() ? 0 : PixelsOf(*std::ranges::max_element(job_.views, {}, PixelsOf));
  return Cost(seconds, of_views + kEmittingPixel * largest, stored);
}

}  // namespace depthfarm
