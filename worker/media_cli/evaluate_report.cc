#include "worker/media_cli/evaluate_report.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>

#include "common/text/text_table.h"

namespace depthfarm {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

template <typename T>
double MeanMember(const std::vector<T>& list, double T::*member) {
  double sum = 0;
  int count = 0;
  for (const T& item : list) {
    if (std::isnan(item.*member)) continue;
    sum += item.*member;
    ++count;
  }
  return count > 0 ? sum / count : kNaN;
}

std::string Joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : " ") + name;
  return text;
}

std::vector<std::string> Row(const std::string& view, const std::string& from, const std::string& depth,
                             const PictureFigures& f) {
  return {view,
          from,
          depth,
          Decimal(f.psnr, 2),
          Decimal(f.psnr_full_range, 2),
          Decimal(f.psnr_non_hole, 2),
          Decimal(f.psnr_outside_panels, 2),
          Decimal(f.iv_psnr, 2),
          Decimal(f.ssim, 4),
          Decimal(f.holes_percent, 2)};
}

PictureFigures Difference(const PictureFigures& a, const PictureFigures& b) {
  return {a.psnr - b.psnr,
          a.psnr_full_range - b.psnr_full_range,
          a.psnr_non_hole - b.psnr_non_hole,
          a.psnr_outside_panels - b.psnr_outside_panels,
          a.ssim - b.ssim,
          a.iv_psnr - b.iv_psnr,
          a.holes_percent - b.holes_percent};
}

PictureFigures MeanExact(const EvaluateReport& report) {
  std::vector<PictureFigures> means;
  for (const TargetReport& target : report.targets) means.push_back(MeanOf(target.exact));
  return MeanOf(means);
}

void PrintTargets(const EvaluateReport& report, std::ostream& out) {
  out << "\nVirtual views, each from its sources' pictures and depth (forward warping with z-buffer, blending by\n"
         "nearness, holes filled from the background), against the real picture. Means over frames.\n"
         "PSNR: dB of luma in 16-235 (BT.601), peak 255; full: of full-range luma; IV-PSNR: Y, Cb, Cr in 16-235,\n"
         "shifts of 2 px and 1 % of offset forgiven; SSIM: 11x11 Gaussian window.\n"
         "best plane: synthesis with the best single depth plane, first frame.\n";
  TextTable table({"view", "from", "depth", "PSNR", "full", "non-hole", "off-panel", "IV-PSNR", "SSIM", "holes %"}, 3);
  for (const TargetReport& target : report.targets) {
    const PictureFigures estimated = MeanOf(target.estimated);
    table.Add(Row(target.view, Joined(target.from), "estimated", estimated));
    if (!target.exact.empty()) {
      const PictureFigures exact = MeanOf(target.exact);
      table.Add(Row("", "", "exact", exact));
      table.Add(Row("", "", "difference", Difference(estimated, exact)));
    }
    table.Add({"", "", "best plane", Decimal(target.single_plane_psnr, 2)});
  }
  if (report.targets.size() > 1) {
    table.Add(Row("mean", "", "estimated", report.MeanEstimated()));
    const PictureFigures exact = MeanExact(report);
    if (!std::isnan(exact.psnr)) table.Add(Row("", "", "exact", exact));
  }
  table.Print(out);
}

void PrintAgreement(const EvaluateReport& report, std::ostream& out) {
  out << "\nAgreement of the two sources' depth within one level, % (non-occluded: "
      << (report.agreement_by_exact_depth ? "visible by exact depth"
                                          : "nothing nearer in the other view's estimated depth")
      << ").\n";
  TextTable table({"views", "in view", "non-occluded", "mean levels apart"}, 1);
  for (const TargetReport& target : report.targets) {
    if (!target.agreement) continue;
    table.Add({Joined(target.from), Decimal(target.agreement->InViewPercent(), 1),
               Decimal(target.agreement->NonOccludedPercent(), 1),
               Decimal(target.agreement->MeanLevelDifference(), 2)});
  }
  table.Print(out);
}

std::vector<DepthErrorGroup> SumOfViews(const EvaluateReport& report) {
  std::vector<DepthErrorGroup> sum;
  for (const ViewDepthReport& view : report.depth) AddGroups(view.groups, sum);
  return sum;
}

void AddDepthRows(const std::string& name, const std::vector<DepthErrorGroup>& groups, bool all_groups,
                  TextTable& table) {
  bool first = true;
  for (const DepthErrorGroup& group : groups) {
    if (!all_groups && group.name != "all" && group.name != "non-occluded") continue;
    const DepthErrorFigures& f = group.figures;
    const double pixels = static_cast<double>(groups.front().figures.pixels);
    table.Add({first ? name : "", group.name, Decimal(100.0 * static_cast<double>(f.pixels) / pixels, 1),
               Decimal(f.BadLevelsPercent(0), 1), Decimal(f.BadLevelsPercent(1), 1), Decimal(f.BadLevelsPercent(2), 1),
               Decimal(f.BadLevelsPercent(3), 1), Decimal(f.BadPxPercent(0), 1), Decimal(f.BadPxPercent(1), 1),
               Decimal(f.BadPxPercent(2), 1), Decimal(f.BadPxPercent(3), 1), Decimal(f.MeanPx(), 3),
               Decimal(f.RmsePx(), 3), Decimal(f.RmseLevels(), 2), Decimal(f.CompletenessPercent(), 1)});
    first = false;
  }
}

void PrintDepth(const EvaluateReport& report, std::ostream& out) {
  out << "\nDepth against exact depth: % of pixels off by more than N levels (lv) or N px in the nearest view; a "
         "pixel\n"
         "without depth is off. MAE: mean absolute error; it and RMSE over pixels with depth.\n";
  TextTable table({"view", "pixels", "share %", ">.5 lv", ">1 lv", ">2 lv", ">4 lv", ">.5 px", ">1 px", ">2 px",
                   ">4 px", "MAE px", "RMSE px", "RMSE lv", "depth %"},
                  2);
  for (const ViewDepthReport& view : report.depth) AddDepthRows(view.view, view.groups, false, table);
  AddDepthRows("all views", SumOfViews(report), true, table);
  table.Print(out);
}

Sparsification SumOfConfidence(const EvaluateReport& report) {
  Sparsification sum;
  for (const ViewConfidenceReport& view : report.confidence) sum.Add(view.figures);
  return sum;
}

// Shares of pixels that are kept, the most confident ones.
constexpr double kKept[] = {1, 0.99, 0.95, 0.9, 0.75, 0.5};

void PrintConfidence(const EvaluateReport& report, std::ostream& out) {
  out << "\nConfidence against exact depth: % of the N % most confident pixels that are off by more than 1 px.\n"
         "AUSE: area between that curve and the best possible one (rows best), in % and, of mean errors, in px; 0 is\n"
         "perfect. calib.: by how much confidence and the share of right pixels differ, %.\n";
  std::vector<std::string> header = {"view", "by"};
  for (const double kept : kKept) header.push_back(Decimal(100 * kept, 0) + " %");
  for (const char* name : {"AUSE %", "AUSE px", "calib. %"}) header.emplace_back(name);
  TextTable table(std::move(header), 2);
  const auto add = [&](const std::string& view, const Sparsification& figures) {
    std::vector<std::string> row = {view, "confidence"};
    for (const double kept : kKept) row.push_back(Decimal(figures.WrongPercent(kept), 3));
    row.push_back(Decimal(figures.AuseWrongPercent(), 3));
    row.push_back(Decimal(figures.AusePx(), 4));
    row.push_back(Decimal(figures.CalibrationErrorPercent(), 2));
    table.Add(std::move(row));
    row = {"", "best"};
    for (const double kept : kKept) row.push_back(Decimal(figures.BestWrongPercent(kept), 3));
    table.Add(std::move(row));
  };
  for (const ViewConfidenceReport& view : report.confidence) add(view.view, view.figures);
  if (report.confidence.size() > 1) add("all views", SumOfConfidence(report));
  table.Print(out);
}

StabilityFigures SumOfStability(const EvaluateReport& report) {
  StabilityFigures sum;
  for (const ViewStabilityReport& view : report.stability) sum.Add(view.figures);
  return sum;
}

void PrintStability(const EvaluateReport& report, std::ostream& out) {
  out << "\nDepth from frame to frame where the picture does not change (7x7 mean of Y, Cb, Cr within 3 grey "
         "levels).\n";
  TextTable table({"view", "changed by > 1 level, %", "mean change, levels"}, 1);
  const auto add = [&](const std::string& view, const StabilityFigures& figures) {
    table.Add({view, Decimal(figures.ChangedPercent(), 2), Decimal(figures.MeanLevelDifference(), 3)});
  };
  for (const ViewStabilityReport& view : report.stability) add(view.view, view.figures);
  add("all views", SumOfStability(report));
  table.Print(out);
}

void PrintRates(const EvaluateReport& report, std::ostream& out) {
  out << "\nHEVC, low delay (" << kRateEncoder << "): bits a picture (PSNR-Y of the coded picture, dB).\n";
  std::vector<std::string> header = {"video", "view"};
  for (const int qp : kRateQps) header.push_back("QP " + std::to_string(qp));
  if (report.against) header.emplace_back("BD rate %");
  TextTable table(std::move(header), 2);
  const auto add = [&](const char* video, const std::vector<RateCurve>& curves, const std::vector<double>* deltas) {
    for (std::size_t i = 0; i < curves.size(); ++i) {
      std::vector<std::string> row = {i == 0 ? video : "", curves[i].view};
      for (const HevcRate& rate : curves[i].rates) {
        row.push_back(Decimal(rate.bits_per_picture, 0) + " (" + Decimal(rate.psnr, 2) + ")");
      }
      if (deltas != nullptr) row.push_back(Decimal((*deltas)[i], 1));
      table.Add(std::move(row));
    }
  };
  add("virtual", report.rates->virtual_views, report.against ? &report.against->virtual_views_percent : nullptr);
  add("depth", report.rates->depth, report.against ? &report.against->depth_percent : nullptr);
  table.Print(out);
  if (report.against) {
    out << "BD rate: bits at equal PSNR against " << report.against->depth_dir
        << "; below 0: fewer. Mean of the virtual "
        << "views " << Decimal(MeanPercent(report.against->virtual_views_percent), 1) << " %, of the depth "
        << Decimal(MeanPercent(report.against->depth_percent), 1) << " %.\n";
  }
}

Json ToJson(const Sparsification& f) {
  Json curve = Json::array();
  for (const double kept : kKept) {
    curve.push_back({{"keptPercent", 100 * kept},
                     {"bad1PxPercent", f.WrongPercent(kept)},
                     {"bestBad1PxPercent", f.BestWrongPercent(kept)},
                     {"meanPx", f.MeanPx(kept)},
                     {"bestMeanPx", f.BestMeanPx(kept)}});
  }
  return {{"pixels", f.pixels()},
          {"auseBad1PxPercent", f.AuseWrongPercent()},
          {"auseMeanPx", f.AusePx()},
          {"calibrationErrorPercent", f.CalibrationErrorPercent()},
          {"curve", std::move(curve)}};
}

Json ToJson(const StabilityFigures& f) {
  return {
      {"stillPixels", f.still}, {"changedPercent", f.ChangedPercent()}, {"meanLevelChange", f.MeanLevelDifference()}};
}

Json ToJson(const std::vector<RateCurve>& curves) {
  Json result = Json::object();
  for (const RateCurve& curve : curves) {
    Json points = Json::array();
    for (const HevcRate& rate : curve.rates) {
      points.push_back({{"qp", rate.qp}, {"bitsPerPicture", rate.bits_per_picture}, {"psnrY", rate.psnr}});
    }
    result[curve.view] = std::move(points);
  }
  return result;
}

Json ToJson(const RateReport& report) {
  return {{"virtualViews", ToJson(report.virtual_views)}, {"depth", ToJson(report.depth)}};
}

Json PercentByView(const std::vector<RateCurve>& curves, const std::vector<double>& percent) {
  Json result = Json::object();
  for (std::size_t i = 0; i < curves.size(); ++i) result[curves[i].view] = percent[i];
  return result;
}

Json ToJson(const RateComparison& against, const RateReport& tested) {
  return {{"depth", against.depth_dir},
          {"rates", ToJson(against.anchor)},
          {"bdRateVirtualViewsPercent", PercentByView(tested.virtual_views, against.virtual_views_percent)},
          {"bdRateDepthPercent", PercentByView(tested.depth, against.depth_percent)},
          {"meanBdRateVirtualViewsPercent", MeanPercent(against.virtual_views_percent)},
          {"meanBdRateDepthPercent", MeanPercent(against.depth_percent)}};
}

Json ToJson(const PictureFigures& f) {
  return {{"psnrY", f.psnr},
          {"psnrYFullRange", f.psnr_full_range},
          {"psnrYNonHole", f.psnr_non_hole},
          {"psnrYOutsidePanels", f.psnr_outside_panels},
          {"ivPsnr", f.iv_psnr},
          {"ssim", f.ssim},
          {"holesPercent", f.holes_percent}};
}

Json ToJson(const std::vector<PictureFigures>& frames) {
  Json list = Json::array();
  for (const PictureFigures& frame : frames) list.push_back(ToJson(frame));
  return list;
}

Json ToJson(const AgreementFigures& f) {
  return {{"inViewPercent", f.InViewPercent()},
          {"nonOccludedPercent", f.NonOccludedPercent()},
          {"meanLevelDifference", f.MeanLevelDifference()}};
}

Json ToJson(const std::vector<DepthErrorGroup>& groups) {
  Json result = Json::object();
  for (const DepthErrorGroup& group : groups) {
    const DepthErrorFigures& f = group.figures;
    result[group.name] = {{"pixels", f.pixels},
                          {"completenessPercent", f.CompletenessPercent()},
                          {"badHalfLevelPercent", f.BadLevelsPercent(0)},
                          {"bad1LevelPercent", f.BadLevelsPercent(1)},
                          {"bad2LevelsPercent", f.BadLevelsPercent(2)},
                          {"bad4LevelsPercent", f.BadLevelsPercent(3)},
                          {"badHalfPxPercent", f.BadPxPercent(0)},
                          {"bad1PxPercent", f.BadPxPercent(1)},
                          {"bad2PxPercent", f.BadPxPercent(2)},
                          {"bad4PxPercent", f.BadPxPercent(3)},
                          {"meanPx", f.MeanPx()},
                          {"rmsePx", f.RmsePx()},
                          {"meanLevels", f.MeanLevels()},
                          {"rmseLevels", f.RmseLevels()}};
  }
  return result;
}

}  // namespace

PictureFigures MeanOf(const std::vector<PictureFigures>& figures) {
  return {
      MeanMember(figures, &PictureFigures::psnr),          MeanMember(figures, &PictureFigures::psnr_full_range),
      MeanMember(figures, &PictureFigures::psnr_non_hole), MeanMember(figures, &PictureFigures::psnr_outside_panels),
      MeanMember(figures, &PictureFigures::ssim),          MeanMember(figures, &PictureFigures::iv_psnr),
      MeanMember(figures, &PictureFigures::holes_percent)};
}

PictureFigures EvaluateReport::MeanEstimated() const {
  std::vector<PictureFigures> means;
  for (const TargetReport& target : targets) means.push_back(MeanOf(target.estimated));
  return MeanOf(means);
}

double EvaluateReport::AgreementPercent() const {
  AgreementFigures sum;
  for (const TargetReport& target : targets) {
    if (target.agreement) sum.Add(*target.agreement);
  }
  return sum.NonOccludedPercent();
}

double EvaluateReport::BadPxPercent() const {
  const std::vector<DepthErrorGroup> groups = SumOfViews(*this);
  return groups.empty() ? kNaN : groups.front().figures.BadPxPercent(1);  // "all" comes first
}

double EvaluateReport::FlickerPercent() const { return SumOfStability(*this).ChangedPercent(); }

void PrintReport(const EvaluateReport& report, std::ostream& out) {
  out << "sequence " << report.sequence << ", depth in " << report.depth_dir << ", frames " << report.first_frame
      << " to " << report.end_frame - 1;
  if (report.downscale > 1) out << ", pictures downscaled by " << report.downscale;
  out << "\n"
      << report.levels << " levels, one is at most " << Decimal(report.level_px, 3) << " px in the nearest view\n";
  for (const std::string& note : report.notes) out << "note: " << note << "\n";
  if (!report.targets.empty()) PrintTargets(report, out);
  bool any_agreement = false;
  for (const TargetReport& target : report.targets) any_agreement = any_agreement || target.agreement.has_value();
  if (any_agreement) PrintAgreement(report, out);
  if (!report.depth.empty()) PrintDepth(report, out);
  if (!report.confidence.empty()) PrintConfidence(report, out);
  if (!report.stability.empty()) PrintStability(report, out);
  if (report.rates) PrintRates(report, out);
}

void PrintReportAsJson(const EvaluateReport& report, std::ostream& out) {
  Json json = {{"sequence", report.sequence},
               {"depth", report.depth_dir},
               {"firstFrame", report.first_frame},
               {"endFrame", report.end_frame},
               {"downscale", report.downscale},
               {"levels", report.levels},
               {"levelPx", report.level_px},
               {"psnrScale", "luma 16-235 BT.601, peak 255"},
               {"ivPsnrScale", "Y, Cb, Cr 16-235 BT.601, 4:4:4, 8 bits, peak 255"},
               {"ssimWindow", "11x11 Gaussian, sigma 1.5, full-range luma"},
               {"notes", report.notes}};
  Json targets = Json::array();
  for (const TargetReport& target : report.targets) {
    Json entry = {{"view", target.view}, {"from", target.from}, {"estimated", ToJson(MeanOf(target.estimated))}};
    if (!target.exact.empty()) {
      entry["exact"] = ToJson(MeanOf(target.exact));
      entry["difference"] = ToJson(Difference(MeanOf(target.estimated), MeanOf(target.exact)));
    }
    entry["singlePlanePsnrY"] = target.single_plane_psnr;
    if (target.agreement) entry["agreement"] = ToJson(*target.agreement);
    entry["frames"] = ToJson(target.estimated);
    targets.push_back(std::move(entry));
  }
  json["virtualViews"] = std::move(targets);
  json["mean"] = ToJson(report.MeanEstimated());
  json["nonOccludedBy"] = report.agreement_by_exact_depth ? "exact depth" : "estimated depth";
  if (!report.depth.empty()) {
    Json views = Json::object();
    for (const ViewDepthReport& view : report.depth) views[view.view] = ToJson(view.groups);
    json["depthError"] = {{"views", std::move(views)}, {"allViews", ToJson(SumOfViews(report))}};
  }
  if (!report.confidence.empty()) {
    Json views = Json::object();
    for (const ViewConfidenceReport& view : report.confidence) views[view.view] = ToJson(view.figures);
    json["confidence"] = {{"views", std::move(views)}, {"allViews", ToJson(SumOfConfidence(report))}};
  }
  if (!report.stability.empty()) {
    Json views = Json::object();
    for (const ViewStabilityReport& view : report.stability) views[view.view] = ToJson(view.figures);
    json["stability"] = {{"views", std::move(views)}, {"allViews", ToJson(SumOfStability(report))}};
  }
  if (report.rates) {
    json["rateEncoder"] = kRateEncoder;
    json["rates"] = ToJson(*report.rates);
  }
  if (report.against) json["against"] = ToJson(*report.against, *report.rates);
  // JSON has no infinities and no NaN: both become null.
  out << json.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
}

}  // namespace depthfarm
