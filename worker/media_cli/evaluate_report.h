#ifndef DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_REPORT_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_REPORT_H_

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

#include "common/quality/consistency.h"
#include "common/quality/depth_error.h"
#include "common/quality/sparsification.h"
#include "common/quality/stability.h"
#include "worker/media_cli/evaluate_rates.h"

namespace depthfarm {

// A synthesised picture against the real one; NaN = not measured. Also the mean of several.
struct PictureFigures {
  double psnr = 0;                 // PSNR-Y, dB, 16-235 BT.601
  double psnr_full_range = 0;      // PSNR-Y, dB, full-range luma
  double psnr_non_hole = 0;        // as `psnr`, over the pixels that a source saw
  double psnr_outside_panels = 0;  // as `psnr`, away from plain panels; NaN without zones or panels
  double ssim = 0;
  double iv_psnr = 0;  // dB, see IvPsnr
  double holes_percent = 0;
};

// NaN of an empty list; a figure that is NaN in some frames is averaged over the others.
[[nodiscard]] PictureFigures MeanOf(const std::vector<PictureFigures>& figures);

struct TargetReport {
  std::string view;
  std::vector<std::string> from;
  std::vector<PictureFigures> estimated;      // per frame
  std::vector<PictureFigures> exact;          // per frame; empty where the sources' exact depth isn't known
  double single_plane_psnr = 0;               // as `psnr`, first frame
  std::optional<AgreementFigures> agreement;  // of two sources
};

struct ViewDepthReport {
  std::string view;
  std::vector<DepthErrorGroup> groups;
};

struct ViewConfidenceReport {
  std::string view;
  Sparsification figures;
};

struct ViewStabilityReport {
  std::string view;
  StabilityFigures figures;
};

struct EvaluateReport {
  std::string sequence;
  std::string depth_dir;
  int first_frame = 0;
  int end_frame = 0;
  int downscale = 1;
  int levels = 0;
  double level_px = 0;             // largest step of one level in a nearest neighbour view
  std::vector<std::string> notes;  // sentences: what wasn't measured and why
  std::vector<TargetReport> targets;
  bool agreement_by_exact_depth = false;  // how non-occluded pixels were found
  std::vector<ViewDepthReport> depth;
  std::vector<ViewConfidenceReport> confidence;  // of views with exact depth and a confidence map
  std::vector<ViewStabilityReport> stability;    // empty for a single frame
  std::optional<RateReport> rates;
  std::optional<RateComparison> against;

  // Means over the targets; NaN without any.
  [[nodiscard]] PictureFigures MeanEstimated() const;
  // Over all targets' sources; all pixels of all views with exact depth; all views' still pixels. NaN where nothing is
  // measured.
  [[nodiscard]] double AgreementPercent() const;
  [[nodiscard]] double BadPxPercent() const;  // off by more than 1 px
  [[nodiscard]] double FlickerPercent() const;
};

void PrintReport(const EvaluateReport& report, std::ostream& out);
void PrintReportAsJson(const EvaluateReport& report, std::ostream& out);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_EVALUATE_REPORT_H_
