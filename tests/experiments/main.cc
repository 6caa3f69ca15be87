// What we compare ourselves with; built where OpenCV's calib3d is there, never installed.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <exception>
#include <initializer_list>
#include <iostream>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "coordinator/cli/estimation_options.h"
#include "tests/experiments/baseline_command.h"
#include "tests/experiments/cost_margin.h"
#include "tests/experiments/per_view.h"

namespace {

using Parameters = std::map<std::string, depthfarm::ManifestNumberOrText>;

// Options of `depthfarm run`, with the same words, bounds and messages.
void AddRunOptions(CLI::App& command, std::initializer_list<std::string_view> names,
                   depthfarm::EstimationParams& params) {
  for (const depthfarm::EstimationOption& option : depthfarm::EstimationOptions()) {
    if (std::find(names.begin(), names.end(), option.name) == names.end()) continue;
    const auto apply = [&option, &params](const std::string& text) {
      const depthfarm::Status status = option.apply(text, params);
      if (!status.ok()) throw CLI::ValidationError(std::string(status.message()));
    };
    command.add_option_function<std::string>("--" + std::string(option.name), apply, std::string(option.help))
        ->type_name(std::string(option.value));
  }
}

void AddCommonOptions(CLI::App& command, depthfarm::BaselineCommandOptions& options) {
  command.add_option("sequence", options.sequence, "Sequence file")->required()->type_name("SEQUENCE");
  command.add_option("-o,--output", options.output, "Folder for depth.json and depth/")->required()->type_name("DIR");
  command.add_option("--first-frame", options.params.first_frame, "First frame")->capture_default_str();
  command.add_option("--end-frame", options.params.end_frame, "One past the last frame; -1: to the end")
      ->capture_default_str();
  AddRunOptions(command, {"levels", "z-near", "z-far", "views", "downscale"}, options.params);
}

void AddPixelCutOptions(CLI::App& command, depthfarm::PixelCutParams& params) {
  command.add_option("--window", params.window, "Side of the block that is compared, pixels, odd")
      ->capture_default_str();
  command.add_option("--most-difference", params.most_difference, "Grey levels beyond which a match is no worse")
      ->capture_default_str();
  command.add_option("--smoothing", params.smoothing, "Grey levels per 1/249 of the depth range and pair of pixels")
      ->capture_default_str();
  command.add_option("--most-jump", params.most_jump, "1/249 of the depth range beyond which a jump costs no more")
      ->capture_default_str();
  command.add_option("--sweeps", params.sweeps, "Sweeps over the levels; 0: until no move lowers the energy")
      ->capture_default_str();
}

Parameters ParametersOf(const depthfarm::PixelCutParams& params) {
  return {{"window", std::int64_t{params.window}},
          {"mostDifference", params.most_difference},
          {"smoothing", params.smoothing},
          {"mostJump", params.most_jump},
          {"sweeps", std::int64_t{params.sweeps}}};
}

// As `depthfarm run` calls them; segments: 0 = auto.
Parameters ParametersOf(const depthfarm::EstimationParams& params) {
  return {{"segments", std::int64_t{params.segments}},
          {"smoothing", params.smoothing},
          {"matchingWindow", std::int64_t{params.matching_window}},
          {"matchingOffset", params.matching_offset},
          {"uniqueness", std::int64_t{params.uniqueness}},
          {"snicCompactness", params.snic_compactness},
          {"neighbours", std::int64_t{params.neighbours}},
          {"maxSweeps", std::int64_t{params.max_sweeps}}};
}

int Run(int argc, char** argv) {
  CLI::App app("Depth by other methods, in the form that `depthfarm evaluate` reads.", "depthfarm-experiments");
  app.require_subcommand(1);
  depthfarm::BaselineCommandOptions options;
  depthfarm::PixelCutParams pixel_cut_params;
  CLI::App* sgbm = app.add_subcommand("sgbm", "OpenCV StereoSGBM of each view with its two neighbours, merged");
  CLI::App* pixel_cut =
      app.add_subcommand("pixel-cut", "Graph cut over the pixels of each view, with the structure of DERS");
  CLI::App* per_view =
      app.add_subcommand("per-view", "Segment graph cut as in depthfarm run --refine 0, each view on its own");
  std::string depth_dir;
  CLI::App* margin =
      app.add_subcommand("margin", "Depth as it is, with the margins of raw matching costs as confidence");
  margin->add_option("sequence", options.sequence, "Sequence file")->required()->type_name("SEQUENCE");
  margin->add_option("depth", depth_dir, "Folder with depth.json")->required()->type_name("DEPTH_DIR");
  margin->add_option("-o,--output", options.output, "Folder for depth.json, depth/ and confidence/")
      ->required()
      ->type_name("DIR");
  for (CLI::App* command : {sgbm, pixel_cut, per_view}) AddCommonOptions(*command, options);
  AddPixelCutOptions(*pixel_cut, pixel_cut_params);
  AddRunOptions(*per_view,
                {"segments", "smoothing", "matching-window", "matching-offset", "uniqueness", "snic-compactness",
                 "neighbors", "sweeps"},
                options.params);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;  // 0: --help
  }

  depthfarm::BaselineMethod method{app.get_subcommands().front()->get_name(), depthfarm::SgbmOfFrame, {}};
  if (pixel_cut->parsed()) {
    method.estimate = [&](const depthfarm::ResolvedJob& job, const std::vector<depthfarm::YcbcrImage>& pictures) {
      return depthfarm::PixelCutOfFrame(job, pictures, pixel_cut_params);
    };
    method.parameters = ParametersOf(pixel_cut_params);
  } else if (per_view->parsed()) {
    method.estimate = depthfarm::PerViewOfFrame;
    method.parameters = ParametersOf(options.params);
  }
  const depthfarm::Status status = margin->parsed()
                                       ? depthfarm::WriteWithCostMargins(options.sequence, depth_dir, options.output)
                                       : depthfarm::RunBaseline(options, method, std::cout);
  if (status.ok()) return 0;
  std::cerr << "depthfarm-experiments: " << status.message() << "\n";
  return status.code() == depthfarm::ErrorCode::kInvalidArgument ? 2 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return Run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "depthfarm-experiments: unexpected failure: " << error.what() << "\n";
    return 1;
  }
}
