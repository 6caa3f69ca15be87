#include "common/sequence/ground_truth_fields.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "common/sequence/read_sequence.h"

namespace depthfarm {
namespace {

constexpr std::string_view kDepthPfmEncoding = "z-pfm";
constexpr std::string_view kNonoccludedMask = "nonocc.png";

// Consumes a text from the left; a step that does not fit leaves `ok` false for good.
class TextScanner {
 public:
  explicit TextScanner(std::string_view text) : rest_(text) {}

  // Whether the rest begins with `literal`, which is then consumed.
  bool Try(std::string_view literal) {
    if (!ok_ || !rest_.starts_with(literal)) return false;
    rest_.remove_prefix(literal.size());
    return true;
  }
  TextScanner& Expect(std::string_view literal) {
    ok_ = Try(literal);
    return *this;
  }
  // A number > 0.
  TextScanner& ExpectPositive(double* number) {
    const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), *number);
    ok_ = ok_ && error == std::errc() && std::isfinite(*number) && *number > 0;
    if (ok_) rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
    return *this;
  }
  [[nodiscard]] bool AtEnd() const { return ok_ && rest_.empty(); }

 private:
  std::string_view rest_;
  bool ok_ = true;
};

bool ParseEncoding(std::string_view text, GroundTruthView* view) {
  if (text == kDepthPfmEncoding) {
    view->encoding = GroundTruthView::Encoding::kDepthPfm;
    return true;
  }
  TextScanner scanner(text);
  if (scanner.Try("PFM float32, pixels per grid step")) {
    view->encoding = GroundTruthView::Encoding::kDisparityPfm;
    (void)scanner.Try(", bottom row first as PFM prescribes");
    return scanner.AtEnd();
  }
  view->encoding = GroundTruthView::Encoding::kDisparityPng;
  if (!scanner.Try("8-bit") && !scanner.Try("16-bit")) return false;
  scanner.Expect(", disparity = value");
  if (scanner.Try("/")) scanner.ExpectPositive(&view->divisor);
  return scanner.Expect(", 0 = unknown").AtEnd();
}

bool ParseDepthFormula(std::string_view text, std::optional<double> disparity_offset, GroundTruthView* view) {
  TextScanner scanner(text);
  scanner.Expect("z = ").ExpectPositive(&view->scale).Expect("/");
  if (scanner.Try("disparity")) return scanner.AtEnd();
  scanner.Expect("(disparity + ");
  if (scanner.Try("disparityOffset")) {
    if (!disparity_offset) return false;
    view->offset = *disparity_offset;
  } else {
    scanner.ExpectPositive(&view->offset);
  }
  return scanner.Expect(")").AtEnd();
}

Status CheckView(const std::string& view, const std::string& where, const Sequence& sequence) {
  const bool known = std::any_of(sequence.cameras.begin(), sequence.cameras.end(),
                                 [&](const SequenceCamera& camera) { return camera.camera.name == view; });
  if (!known) return InvalidArgument(where + ": 'view' is '" + view + "', expected the name of a camera");
  const bool twice = std::any_of(sequence.ground_truth.begin(), sequence.ground_truth.end(),
                                 [&](const GroundTruthView& other) { return other.view == view; });
  if (twice) return InvalidArgument(where + ": view '" + view + "' is given twice");
  return {};
}

Status ReadWordedForm(const Json& value, const GroundTruthContext& context, Sequence* sequence) {
  static constexpr std::array<std::string_view, 5> kKeys = {"view", "file", "encoding", "depth", "masks"};
  DEPTHFARM_ASSIGN_OR_RETURN(const JsonFields fields, JsonFields::Of(value, context.where, kKeys));
  GroundTruthView view;
  DEPTHFARM_ASSIGN_OR_RETURN(view.view, fields.String("view"));
  DEPTHFARM_RETURN_IF_ERROR(CheckView(view.view, context.where, *sequence));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string file, fields.String("file"));
  DEPTHFARM_ASSIGN_OR_RETURN(std::string path, context.resolve(file, context.where + ": 'file'"));
  view.depth.push_back(std::move(path));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string encoding, fields.String("encoding"));
  std::string formula;
  if (fields.Has("depth")) {
    DEPTHFARM_ASSIGN_OR_RETURN(formula, fields.String("depth"));
  }
  if (fields.Has("masks")) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::string masks, fields.String("masks"));
    if (masks.find(kNonoccludedMask) != std::string::npos) {
      DEPTHFARM_ASSIGN_OR_RETURN(view.nonoccluded_mask,
                                 context.resolve(std::string(kNonoccludedMask), context.where + ": 'masks'"));
    }
  }
  const auto warn = [&](const std::string& what) {
    sequence->warnings.push_back(context.where + ": " + what + "; the ground truth of view '" + view.view +
                                 "' is left out, estimation is not affected");
    return Status();
  };
  if (!ParseEncoding(encoding, &view)) {
    return warn("the encoding " + Shortened(Json(encoding)) + " is not understood");
  }
  if (view.encoding == GroundTruthView::Encoding::kDepthPfm) {
    if (!formula.empty()) return warn("the formula " + Shortened(Json(formula)) + " contradicts the encoding z-pfm");
  } else if (!ParseDepthFormula(formula, context.disparity_offset, &view)) {
    return warn("the depth formula " + Shortened(Json(formula)) + " is not understood");
  }
  sequence->ground_truth.push_back(std::move(view));
  return {};
}

Result<std::vector<std::string>> ResolvedList(const JsonFields& fields, std::string_view key,
                                              const GroundTruthContext& context) {
  DEPTHFARM_ASSIGN_OR_RETURN(std::vector<std::string> paths, fields.Strings(key, kMaxFrames));
  if (context.num_frames > 0 && paths.size() != context.num_frames) {
    return fields.Bad("'" + std::string(key) + "' has " + std::to_string(paths.size()) +
                      " entries, expected one per frame, " + std::to_string(context.num_frames));
  }
  for (std::size_t frame = 0; frame < paths.size(); ++frame) {
    DEPTHFARM_ASSIGN_OR_RETURN(paths[frame], context.resolve(paths[frame], fields.where() + ": '" + std::string(key) +
                                                                               "' of frame " + std::to_string(frame)));
  }
  return paths;
}

Status ReadListedView(const Json& value, const std::string& where, const GroundTruthContext& context,
                      Sequence* sequence) {
  static constexpr std::array<std::string_view, 3> kKeys = {"view", "depth", "zones"};
  DEPTHFARM_ASSIGN_OR_RETURN(JsonFields fields, JsonFields::Of(value, where, kKeys));
  GroundTruthView view;
  DEPTHFARM_ASSIGN_OR_RETURN(view.view, fields.String("view"));
  DEPTHFARM_RETURN_IF_ERROR(CheckView(view.view, where, *sequence));
  fields.set_where(where + " (view '" + view.view + "')");
  DEPTHFARM_ASSIGN_OR_RETURN(view.depth, ResolvedList(fields, "depth", context));
  if (fields.Has("zones")) {
    DEPTHFARM_ASSIGN_OR_RETURN(view.zones, ResolvedList(fields, "zones", context));
    if (view.zones.size() != view.depth.size()) return fields.Bad("'depth' and 'zones' differ in length");
  }
  sequence->ground_truth.push_back(std::move(view));
  return {};
}

Status CheckZoneNames(const Json& zones, const std::string& where) {
  if (!zones.is_object()) return InvalidArgument(where + ": is " + Shortened(zones) + ", expected {name: value, ...}");
  for (const auto& [name, value] : zones.items()) {
    if (!value.is_number_integer() || value.get<double>() < 0 || value.get<double>() > 255) {
      return InvalidArgument(where + ": '" + name + "' is " + Shortened(value) +
                             ", expected a whole number from 0 to 255");
    }
  }
  return {};
}

Status ReadListedForm(const Json& value, const GroundTruthContext& context, Sequence* sequence) {
  static constexpr std::array<std::string_view, 3> kKeys = {"encoding", "zones", "views"};
  DEPTHFARM_ASSIGN_OR_RETURN(const JsonFields fields, JsonFields::Of(value, context.where, kKeys));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string encoding, fields.String("encoding"));
  if (fields.Has("zones")) {
    DEPTHFARM_ASSIGN_OR_RETURN(const Json* zones, fields.Value("zones"));
    DEPTHFARM_RETURN_IF_ERROR(CheckZoneNames(*zones, context.where + ": zones"));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const Json* views, fields.Array("views", kMaxCameras));
  if (encoding != kDepthPfmEncoding) {
    sequence->warnings.push_back(context.where + ": the encoding " + Shortened(Json(encoding)) +
                                 " is not understood, expected z-pfm; the ground truth is left out, estimation is not "
                                 "affected");
    return {};
  }
  for (std::size_t i = 0; i < views->size(); ++i) {
    DEPTHFARM_RETURN_IF_ERROR(
        ReadListedView((*views)[i], context.where + ": views[" + std::to_string(i) + "]", context, sequence));
  }
  return {};
}

}  // namespace

Status ReadGroundTruthFields(const Json& value, const GroundTruthContext& context, Sequence* sequence) {
  if (value.is_object() && value.contains("views")) return ReadListedForm(value, context, sequence);
  return ReadWordedForm(value, context, sequence);
}

}  // namespace depthfarm
