// What we compare ourselves with; built where OpenCV's calib3d is there, never installed.
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>

#include "tests/experiments/baseline_command.h"
#include "tests/experiments/per_view.h"

int main(int argc, char** argv) {
  struct Method {
    const char* name;
    const char* summary;
    depthfarm::FrameMethod estimate;
  };
  const Method methods[] = {
      {"sgbm", "OpenCV StereoSGBM of each view with its two neighbours, merged", depthfarm::SgbmOfFrame},
      {"pixel-cut", "Graph cut over the pixels of each view, with the structure of DERS", depthfarm::PixelCutOfFrame},
      {"per-view", "Segment graph cut as in depthfarm run --refine 0, each view on its own",
       depthfarm::PerViewOfFrame}};

  CLI::App app("Depth by other methods, in the form that `depthfarm evaluate` reads.", "depthfarm-experiments");
  app.require_subcommand(1);
  depthfarm::BaselineCommandOptions options;
  for (const Method& method : methods) {
    CLI::App* command = app.add_subcommand(method.name, method.summary);
    command->add_option("sequence", options.sequence, "Sequence file")->required()->type_name("SEQUENCE");
    command->add_option("-o,--output", options.output, "Folder for depth.json and depth/")
        ->required()
        ->type_name("DIR");
    command->add_option("--views", options.views, "Cameras to estimate (default: all)")
        ->delimiter(',')
        ->type_name("A,B");
    command->add_option("--first-frame", options.first_frame, "First frame")->capture_default_str();
    command->add_option("--end-frame", options.end_frame, "One past the last frame; -1: to the end")
        ->capture_default_str();
    command->add_option("--downscale", options.downscale, "1, 2 or 4")->capture_default_str();
  }
  CLI11_PARSE(app, argc, argv);
  const std::string chosen = app.get_subcommands().front()->get_name();
  depthfarm::Status status;
  for (const Method& method : methods) {
    if (method.name == chosen) status = depthfarm::RunBaseline(options, chosen, method.estimate, std::cout);
  }
  if (status.ok()) return 0;
  std::cerr << "depthfarm-experiments: " << status.message() << "\n";
  return status.code() == depthfarm::ErrorCode::kInvalidArgument ? 2 : 1;
}
