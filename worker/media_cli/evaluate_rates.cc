#include "worker/media_cli/evaluate_rates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>

#include "common/base/parallel.h"
#include "common/image/depth_code.h"
#include "common/media/raw_picture.h"
#include "common/quality/bjontegaard.h"
#include "common/synthesis/synthesize_view.h"
#include "worker/media_cli/even_picture.h"

namespace depthfarm {
namespace {

constexpr int kDepthBits = 10;

// The meters of one video, one per quantiser.
struct Video {
  std::string view;
  std::vector<HevcRateMeter> meters;
};

Result<Video> OpenVideo(const Camera& camera, int bits) {
  Video video;
  video.view = camera.name;
  for (const int qp : kRateQps) {
    Result<HevcRateMeter> meter = HevcRateMeter::Create(EvenSide(camera.width), EvenSide(camera.height), bits, qp);
    if (!meter.ok()) return meter.status().WithContext("bit rate of view '" + camera.name + "'");
    video.meters.push_back(*std::move(meter));
  }
  return video;
}

// Each quantiser on its own thread: the codecs share nothing.
Status PutPicture(const std::string& picture, Video& video) {
  std::vector<Status> failures(video.meters.size());
  const int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  ParallelFor(video.meters.size(), threads, [&](std::size_t i) { failures[i] = video.meters[i].Put(picture); });
  for (const Status& failure : failures) DEPTHFARM_RETURN_IF_ERROR(failure);
  return {};
}

Result<RateCurve> FinishVideo(Video& video) {
  RateCurve curve;
  curve.view = video.view;
  for (HevcRateMeter& meter : video.meters) {
    DEPTHFARM_ASSIGN_OR_RETURN(const HevcRate rate, meter.Finish());
    curve.rates.push_back(rate);
  }
  return curve;
}

// Depth as grey 4:2:0 of 10 bits, two bytes each, little-endian.
std::string DepthPicture(const DepthMap& depth, const DepthCode& code) {
  const Grid<std::uint16_t> codes = WithEvenSides(EncodeDepth(depth, code));
  std::string bytes;
  bytes.reserve(codes.size() * 3);
  const auto append = [&](int sample) {
    bytes += static_cast<char>(sample & 0xFF);
    bytes += static_cast<char>(sample >> 8);
  };
  for (const std::uint16_t value : codes.values()) append(value >> (16 - kDepthBits));
  for (std::size_t i = 0; i < codes.size() / 2; ++i) append(1 << (kDepthBits - 1));
  return bytes;
}

std::vector<int> SourcesOfAll(const std::vector<EvaluateTarget>& targets) {
  std::vector<int> sources;
  for (const EvaluateTarget& target : targets) {
    for (const int source : target.from) {
      if (std::find(sources.begin(), sources.end(), source) == sources.end()) sources.push_back(source);
    }
  }
  std::sort(sources.begin(), sources.end());
  return sources;
}

std::vector<RatePoint> Points(const RateCurve& curve) {
  std::vector<RatePoint> points;
  for (const HevcRate& rate : curve.rates) points.push_back({rate.bits_per_picture, rate.psnr});
  return points;
}

std::vector<double> Deltas(const std::vector<RateCurve>& anchor, const std::vector<RateCurve>& tested) {
  std::vector<double> percent;
  for (std::size_t i = 0; i < tested.size(); ++i) {
    const Result<double> delta = BjontegaardRatePercent(Points(anchor[i]), Points(tested[i]));
    percent.push_back(delta.ok() ? *delta : std::numeric_limits<double>::quiet_NaN());
  }
  return percent;
}

}  // namespace

double MeanPercent(const std::vector<double>& values) {
  double sum = 0;
  int count = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

Result<RateReport> MeasureRates(const SequenceWithDepth& input, const std::vector<EvaluateTarget>& targets,
                                const SequenceWithDepth& depth_range) {
  const std::vector<int> sources = SourcesOfAll(targets);
  std::vector<Video> views;
  std::vector<Video> depths;
  std::vector<DepthCode> codes;
  for (const EvaluateTarget& target : targets) {
    DEPTHFARM_ASSIGN_OR_RETURN(Video video, OpenVideo(CameraOf(input, target.view), 8));
    views.push_back(std::move(video));
  }
  for (const int source : sources) {
    DEPTHFARM_ASSIGN_OR_RETURN(Video video, OpenVideo(CameraOf(input, source), kDepthBits));
    depths.push_back(std::move(video));
    const DepthManifestCamera& camera = *depth_range.views[static_cast<std::size_t>(source)].depth;
    DEPTHFARM_ASSIGN_OR_RETURN(const DepthCode code, DepthCode::Create(camera.z_near, camera.z_far));
    codes.push_back(code);
  }
  for (int f = input.first_frame; f < input.end_frame; ++f) {
    FrameWithDepth frame(input, f);
    for (std::size_t i = 0; i < targets.size(); ++i) {
      DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<SourceView> from, SourcesOf(input, targets[i], false, frame));
      DEPTHFARM_ASSIGN_OR_RETURN(const SynthesizedView view, SynthesizeView(from, CameraOf(input, targets[i].view)));
      DEPTHFARM_RETURN_IF_ERROR(PutPicture(EncodeLimitedYuv420(WithEvenSides(view.picture)), views[i]));
    }
    for (std::size_t i = 0; i < sources.size(); ++i) {
      DEPTHFARM_ASSIGN_OR_RETURN(const DepthMap* depth, frame.Depth(sources[i]));
      DEPTHFARM_RETURN_IF_ERROR(PutPicture(DepthPicture(*depth, codes[i]), depths[i]));
    }
  }
  RateReport report;
  for (Video& video : views) {
    DEPTHFARM_ASSIGN_OR_RETURN(RateCurve curve, FinishVideo(video));
    report.virtual_views.push_back(std::move(curve));
  }
  for (Video& video : depths) {
    DEPTHFARM_ASSIGN_OR_RETURN(RateCurve curve, FinishVideo(video));
    report.depth.push_back(std::move(curve));
  }
  return report;
}

RateComparison Compare(const std::string& anchor_dir, const RateReport& anchor, const RateReport& tested) {
  return {anchor_dir, anchor, Deltas(anchor.virtual_views, tested.virtual_views), Deltas(anchor.depth, tested.depth)};
}

}  // namespace depthfarm
