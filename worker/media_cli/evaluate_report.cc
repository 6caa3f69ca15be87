#include "worker/media_cli/evaluate_report.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>

#include "worker/media_cli/text_table.h"

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
          Decimal(f.ssim, 4),
          Decimal(f.holes_percent, 2)};
}

PictureFigures Difference(const PictureFigures& a, const PictureFigures& b) {
  return {a.psnr - b.psnr,
          a.psnr_full_range - b.psnr_full_range,
          a.psnr_non_hole - b.psnr_non_hole,
          a.psnr_outside_panels - b.psnr_outside_panels,
          a.ssim - b.ssim,
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
         "PSNR: dB of luma in 16-235 (BT.601), peak 255; full: of full-range luma; SSIM: 11x11 Gaussian window.\n"
         "best plane: synthesis with the best single depth plane, first frame.\n";
  TextTable table({"view", "from", "depth", "PSNR", "full", "non-hole", "off-panel", "SSIM", "holes %"}, 3);
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
               Decimal(f.BadPxPercent(0), 1), Decimal(f.BadPxPercent(1), 1), Decimal(f.BadPxPercent(2), 1),
               Decimal(f.MeanPx(), 3), Decimal(f.RmsePx(), 3), Decimal(f.RmseLevels(), 2),
               Decimal(f.CompletenessPercent(), 1)});
    first = false;
  }
}

void PrintDepth(const EvaluateReport& report, std::ostream& out) {
  out << "\nDepth against exact depth. bad N: % of pixels off by more than N levels or N px (px in the nearest view; "
         "a\n"
         "pixel without depth is bad); mean and RMSE over pixels with depth.\n";
  TextTable table({"view", "pixels", "share %", "bad 1 lv", "bad 2 lv", "bad 4 lv", "bad .5 px", "bad 1 px", "bad 2 px",
                   "mean px", "RMSE px", "RMSE lv", "depth %"},
                  2);
  for (const ViewDepthReport& view : report.depth) AddDepthRows(view.view, view.groups, false, table);
  AddDepthRows("all views", SumOfViews(report), true, table);
  table.Print(out);
}

Json ToJson(const PictureFigures& f) {
  return {{"psnrY", f.psnr},
          {"psnrYFullRange", f.psnr_full_range},
          {"psnrYNonHole", f.psnr_non_hole},
          {"psnrYOutsidePanels", f.psnr_outside_panels},
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
                          {"bad1LevelPercent", f.BadLevelsPercent(0)},
                          {"bad2LevelsPercent", f.BadLevelsPercent(1)},
                          {"bad4LevelsPercent", f.BadLevelsPercent(2)},
                          {"badHalfPxPercent", f.BadPxPercent(0)},
                          {"bad1PxPercent", f.BadPxPercent(1)},
                          {"bad2PxPercent", f.BadPxPercent(2)},
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
      MeanMember(figures, &PictureFigures::ssim),          MeanMember(figures, &PictureFigures::holes_percent)};
}

PictureFigures EvaluateReport::MeanEstimated() const {
  std::vector<PictureFigures> means;
  for (const TargetReport& target : targets) means.push_back(MeanOf(target.estimated));
  return MeanOf(means);
}

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
  // JSON has no infinities and no NaN: both become null.
  out << json.dump(2, ' ', false, Json::error_handler_t::replace) << "\n";
}

}  // namespace depthfarm
