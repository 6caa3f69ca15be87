#include "coordinator/cli/estimation_options.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "common/files/atomic_file.h"
#include "common/sequence/json_fields.h"

namespace depthfarm {
namespace {

constexpr std::uint64_t kMaxParamsFileBytes = 1 << 20;

Status Refuse(std::string_view option, std::string_view text, std::string_view expected) {
  return InvalidArgument(std::string(option) + " is '" + std::string(text) + "', expected " + std::string(expected));
}

template <typename T>
bool ParseNumber(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

Status ParseInteger(std::string_view option, std::string_view text, int& value) {
  return ParseNumber(text, value) ? Status() : Refuse(option, text, "a whole number");
}

// "auto" is 0 in EstimationParams, so a literal 0 is refused: it would silently mean something else.
Status ParseAutoOrInteger(std::string_view option, std::string_view text, int& value) {
  if (text == "auto") {
    value = 0;
    return {};
  }
  if (!ParseNumber(text, value) || value < 1) return Refuse(option, text, "auto or a whole number from 1");
  return {};
}

Status ParseReal(std::string_view option, std::string_view text, double& value) {
  if (!ParseNumber(text, value) || !std::isfinite(value)) return Refuse(option, text, "a number");
  return {};
}

Status ParsePositive(std::string_view option, std::string_view text, double& value) {
  if (!ParseNumber(text, value) || !std::isfinite(value) || value <= 0) return Refuse(option, text, "a number > 0");
  return {};
}

Status ParseSwitch(std::string_view option, std::string_view text, bool& value) {
  if (text != "on" && text != "off") return Refuse(option, text, "on or off");
  value = text == "on";
  return {};
}

Status ParseFolder(std::string_view option, std::string_view text, std::string& folder) {
  if (text.empty()) return Refuse(option, text, "a folder");
  folder = text;
  return {};
}

// How levels are searched: sparsely, or in full sweeps, so many or until nothing changes.
Status ParseSweeps(std::string_view text, EstimationParams& params) {
  if (text == "sparse") {
    params.search = Search::kSparse;
    params.max_sweeps = 1;
    return {};
  }
  params.search = Search::kFull;
  int sweeps = 0;
  if (text != "auto" && (!ParseNumber(text, sweeps) || sweeps < 1)) {
    return Refuse("sweeps", text, "sparse, auto or a whole number > 0");
  }
  params.max_sweeps = sweeps;
  return {};
}

Status ParseGop(std::string_view text, int& gop) {
  if (text == "all") {
    gop = 0;
    return {};
  }
  if (!ParseNumber(text, gop) || gop < 1) return Refuse("gop", text, "all or a whole number > 0");
  return {};
}

Status ParseAnchor(std::string_view text, Anchor& anchor) {
  if (text != "gop" && text != "shared") return Refuse("anchor", text, "gop or shared");
  anchor = text == "shared" ? Anchor::kShared : Anchor::kGop;
  return {};
}

Status ParsePartition(std::string_view text, Partition& partition) {
  if (text == "blocks") {
    partition = Partition::kContiguous;
  } else if (text == "interleaved") {
    partition = Partition::kInterleaved;
  } else {
    return Refuse("partition", text, "blocks or interleaved");
  }
  return {};
}

Status ParseOutputFormat(std::string_view text, EstimationParams& params) {
  const std::optional<DepthFormat> format = DepthFormatOfName(text);
  if (!format) return Refuse("output-format", text, DepthFormatNames());
  params.output_format = *format;
  return {};
}

Status ParseViews(std::string_view text, std::vector<std::string>& views) {
  views.clear();
  std::istringstream names{std::string(text)};
  for (std::string name; std::getline(names, name, ',');) {
    if (name.empty()) return Refuse("views", text, "camera names separated by commas");
    views.push_back(std::move(name));
  }
  if (views.empty() || text.back() == ',') return Refuse("views", text, "camera names separated by commas");
  return {};
}

// "A:B", "A:", ":B": frames A to B - 1 of the sequence.
Status ParseFrames(std::string_view text, EstimationParams& params) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return Refuse("frames", text, "A:B, frames A to B - 1, e.g. 0:50");
  const std::string_view first = text.substr(0, colon);
  const std::string_view end = text.substr(colon + 1);
  params.first_frame = 0;
  params.end_frame = -1;
  const bool first_ok = first.empty() || (ParseNumber(first, params.first_frame) && params.first_frame >= 0);
  const bool end_ok = end.empty() || (ParseNumber(end, params.end_frame) && params.end_frame > params.first_frame);
  if (!first_ok || !end_ok) return Refuse("frames", text, "A:B with 0 <= A < B, e.g. 0:50");
  return {};
}

constexpr auto kOptions = std::to_array<EstimationOption>({
    {"segments", "auto|N",
     "Superpixels per view; auto: one per --segment-pixels, with refinement larger above 1024x768",
     [](std::string_view text, EstimationParams& params) {
       return ParseAutoOrInteger("segments", text, params.segments);
     }},
    {"segment-pixels", "P", "With --segments auto: pixels of a superpixel, 1 to 10000; default 20",
     [](std::string_view text, EstimationParams& params) {
       return ParseInteger("segment-pixels", text, params.segment_pixels);
     }},
    {"levels", "auto|L", "Depth levels, uniform in 1/z; auto: a pixel apart, a quarter with --refine 0, at most 250",
     [](std::string_view text, EstimationParams& params) { return ParseAutoOrInteger("levels", text, params.levels); }},
    {"z-near", "Z", "Nearest depth of the reference camera, in the sequence's unit; default: the sequence's zNear",
     [](std::string_view text, EstimationParams& params) { return ParsePositive("z-near", text, params.z_near); }},
    {"z-far", "Z", "Farthest depth of the reference camera; default: the sequence's zFar",
     [](std::string_view text, EstimationParams& params) { return ParsePositive("z-far", text, params.z_far); }},
    {"smoothing", "B", "Smoothing beta_0 per 1/249 of the depth range, 0 to 100; default 1",
     [](std::string_view text, EstimationParams& params) { return ParseReal("smoothing", text, params.smoothing); }},
    {"matching-window", "W", "Side of the matching window in pixels, odd, 1 to 15; default 3",
     [](std::string_view text, EstimationParams& params) {
       return ParseInteger("matching-window", text, params.matching_window);
     }},
    {"matching-offset", "K",
     "Colour difference up to which a match is rewarded, grey levels over Y, Cb, Cr; default 30",
     [](std::string_view text, EstimationParams& params) {
       return ParseReal("matching-offset", text, params.matching_offset);
     }},
    {"uniqueness", "P",
     "A match is rewarded by how much it beats P % of its epipolar line, 0 to 99; 0: in full, as the paper; default 75",
     [](std::string_view text, EstimationParams& params) {
       return ParseInteger("uniqueness", text, params.uniqueness);
     }},
    {"snic-compactness", "M", "Compactness of the superpixels, > 0; larger is rounder; default 5",
     [](std::string_view text, EstimationParams& params) {
       return ParseReal("snic-compactness", text, params.snic_compactness);
     }},
    {"gop", "N|all", "Frames from one I frame to the next; 1: every frame on its own; all: one I frame; default 10",
     [](std::string_view text, EstimationParams& params) { return ParseGop(text, params.gop); }},
    {"anchor", "gop|shared", "Each GOP has an I frame of its own, or all refer to that of the first; default gop",
     [](std::string_view text, EstimationParams& params) { return ParseAnchor(text, params.anchor); }},
    {"p-threshold", "T", "Colour change below which a segment keeps its depth of the frame before; default 3",
     [](std::string_view text, EstimationParams& params) {
       return ParseInteger("p-threshold", text, params.p_threshold);
     }},
    {"i-threshold", "T", "Colour change below which a segment keeps its depth of the I frame; default 1",
     [](std::string_view text, EstimationParams& params) {
       return ParseInteger("i-threshold", text, params.i_threshold);
     }},
    {"level-blocks", "auto|N", "Parts n the levels of a frame are split into, each a task; auto: from the job alone",
     [](std::string_view text, EstimationParams& params) {
       return ParseAutoOrInteger("level-blocks", text, params.level_blocks);
     }},
    {"partition", "blocks|interleaved", "How levels are dealt to the parts; default interleaved",
     [](std::string_view text, EstimationParams& params) { return ParsePartition(text, params.partition); }},
    {"views", "A,B,...", "Cameras to estimate; default: every camera that has pictures",
     [](std::string_view text, EstimationParams& params) { return ParseViews(text, params.views); }},
    {"frames", "A:B", "Frames A to B - 1 of the sequence; either may be left out; default: all",
     [](std::string_view text, EstimationParams& params) { return ParseFrames(text, params); }},
    {"downscale", "1|2|4", "Work on pictures this many times smaller; default 1",
     [](std::string_view text, EstimationParams& params) { return ParseInteger("downscale", text, params.downscale); }},
    {"neighbors", "N", "Views that each view is matched against, 1 to 16; default 2",
     [](std::string_view text, EstimationParams& params) {
       return ParseInteger("neighbors", text, params.neighbours);
     }},
    {"sweeps", "sparse|N|auto",
     "sparse: from a good start, every segment to some levels, then to near ones (default); N: every segment to every "
     "level, N times; auto: until nothing changes",
     [](std::string_view text, EstimationParams& params) { return ParseSweeps(text, params); }},
    {"refine", "N", "Rounds that turn levels into slanted planes after the cut; 0: levels as they are; default 4",
     [](std::string_view text, EstimationParams& params) {
       return ParseInteger("refine", text, params.refine_rounds);
     }},
    {"choice-rounds", "N", "Last rounds in which views agree and pixels at depth jumps choose their plane; default 2",
     [](std::string_view text, EstimationParams& params) {
       return ParseInteger("choice-rounds", text, params.choice_rounds);
     }},
    {"compared", "N", "Views that refinement compares each view with, 1 to 4; default 4",
     [](std::string_view text, EstimationParams& params) { return ParseInteger("compared", text, params.compared); }},
    {"confidence", "on|off",
     "Also write DIR/confidence: how likely each pixel's depth is right to a pixel of motion; default off",
     [](std::string_view text, EstimationParams& params) {
       return ParseSwitch("confidence", text, params.confidence);
     }},
    {"holes", "C", "Leave no depth where that is less likely than C, 0 to less than 1; default 0: depth everywhere",
     [](std::string_view text, EstimationParams& params) { return ParseReal("holes", text, params.holes); }},
    {"output-format", "FORMAT",
     "Depth files: png16: 16-bit codes (default); pfm, exr: depth in the sequence's unit; yuv420p16: codes as raw "
     "video",
     ParseOutputFormat},
    {"prior", "DIR", "Depth from elsewhere (a scanner, a network, another run), believed where pictures do not tell",
     [](std::string_view text, EstimationParams& params) { return ParseFolder("prior", text, params.prior); }},
    {"mask", "DIR|sequence", "Foreground masks, DIR/<camera>/<frame>.png, or those that SEQUENCE names",
     [](std::string_view text, EstimationParams& params) { return ParseFolder("mask", text, params.mask); }},
});

const EstimationOption* FindOption(std::string_view name) {
  const auto found = std::ranges::find(kOptions, name, &EstimationOption::name);
  return found == kOptions.end() ? nullptr : &*found;
}

std::string OptionNames() {
  std::string names = "preset";
  for (const EstimationOption& option : kOptions) names.append(", ").append(option.name);
  return names;
}

Status ApplyJsonValue(const EstimationOption& option, const Json& value, EstimationParams& params) {
  if (value.is_string()) return option.apply(value.get<std::string>(), params);
  if (value.is_number()) return option.apply(value.dump(), params);
  if (value.is_boolean()) return option.apply(value.get<bool>() ? "on" : "off", params);
  if (option.name == "views" && value.is_array() && !value.empty()) {
    params.views.clear();
    for (const Json& name : value) {
      if (!name.is_string()) return Refuse("views", value.dump(), "an array of camera names");
      params.views.push_back(name.get<std::string>());
    }
    return {};
  }
  return Refuse(option.name, value.dump(), std::string("a value such as ") + std::string(option.value));
}

}  // namespace

std::span<const EstimationOption> EstimationOptions() { return kOptions; }

Result<EstimationParams> ParseParamsJson(std::string_view text, const std::string& file, const std::string& preset) {
  Result<Json> object = ParseStrictJson(text);
  if (!object.ok()) return object.status().WithContext(file);
  if (!object->is_object()) return InvalidArgument(file + ": expected one JSON object of option names and values");
  std::string base = preset;
  if (const auto own = object->find("preset"); own != object->end()) {
    if (!own->is_string()) return Refuse("preset", own->dump(), "default, best, fast or paper").WithContext(file);
    if (base.empty()) base = own->get<std::string>();
  }
  Result<EstimationParams> params = Preset(base.empty() ? "default" : base);
  if (!params.ok()) return params.status().WithContext(file);
  for (const auto& [key, value] : object->items()) {
    if (key == "preset") continue;
    const EstimationOption* option = FindOption(key);
    if (option == nullptr) {
      return InvalidArgument(file + ": unknown option '" + key + "', expected one of " + OptionNames());
    }
    if (Status applied = ApplyJsonValue(*option, value, *params); !applied.ok()) return applied.WithContext(file);
  }
  return params;
}

Result<EstimationParams> BuildEstimationParams(const EstimationArguments& arguments) {
  EstimationParams params;
  if (arguments.params_file.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(params, Preset(arguments.preset.empty() ? "default" : arguments.preset));
  } else {
    const Result<std::string> text = ReadFileBytes(arguments.params_file, kMaxParamsFileBytes);
    if (!text.ok()) return InvalidArgument("params file: " + text.status().message());  // the user named it
    DEPTHFARM_ASSIGN_OR_RETURN(params, ParseParamsJson(*text, arguments.params_file, arguments.preset));
  }
  for (const auto& [name, text] : arguments.values) {
    const EstimationOption* option = FindOption(name);
    if (option == nullptr) return InvalidArgument("unknown option '" + name + "', expected one of " + OptionNames());
    DEPTHFARM_RETURN_IF_ERROR(option->apply(text, params));
  }
  DEPTHFARM_RETURN_IF_ERROR(params.Validate());
  return params;
}

}  // namespace depthfarm
