// What we compare ourselves with; built where OpenCV's calib3d is there, never installed.
#include <CLI/CLI.hpp>
#include <iostream>

#include "tests/experiments/sgbm_command.h"

int main(int argc, char** argv) {
  CLI::App app("Depth by other methods, in the form that `depthfarm evaluate` reads.", "depthfarm-experiments");
  app.require_subcommand(1);
  depthfarm::SgbmCommandOptions options;
  CLI::App* sgbm = app.add_subcommand("sgbm", "OpenCV StereoSGBM of each view with its two neighbours, merged");
  sgbm->add_option("sequence", options.sequence, "Sequence file")->required()->type_name("SEQUENCE");
  sgbm->add_option("-o,--output", options.output, "Folder for depth.json and depth/")->required()->type_name("DIR");
  sgbm->add_option("--views", options.views, "Cameras to estimate (default: all)")->delimiter(',')->type_name("A,B");
  sgbm->add_option("--first-frame", options.first_frame, "First frame")->capture_default_str();
  sgbm->add_option("--end-frame", options.end_frame, "One past the last frame; -1: to the end")->capture_default_str();
  sgbm->add_option("--downscale", options.downscale, "1, 2 or 4")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const depthfarm::Status status = depthfarm::RunSgbm(options, std::cout);
  if (status.ok()) return 0;
  std::cerr << "depthfarm-experiments: " << status.message() << "\n";
  return status.code() == depthfarm::ErrorCode::kInvalidArgument ? 2 : 1;
}
