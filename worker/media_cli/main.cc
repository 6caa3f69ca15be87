// depthfarm-media: the commands that touch pixels. One table of commands, each parsing its options and calling a
// library.

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <functional>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/freed_memory.h"
#include "common/base/status.h"
#include "coordinator/cli/farm_options.h"
#include "coordinator/client/client.h"
#include "worker/media_cli/colour_command.h"
#include "worker/media_cli/evaluate_command.h"
#include "worker/media_cli/export_command.h"
#include "worker/media_cli/scene_command.h"
#include "worker/media_cli/submit_views.h"
#include "worker/media_cli/synthesize_command.h"

namespace {

using depthfarm::Status;

constexpr int kExitOk = 0;
constexpr int kExitFailed = 1;
constexpr int kExitBadUsage = 2;
constexpr int kExitNoCoordinator = 3;
constexpr int kExitInterrupted = 130;

volatile std::sig_atomic_t interrupted = 0;

// From here on SIGINT and SIGTERM are only noted: a command that asks can remove what is half-written.
void CatchInterruptions() {
  const auto note = [](int) { interrupted = 1; };
  for (const int number : {SIGINT, SIGTERM}) std::signal(number, note);  // NOLINT(bugprone-signal-handler): one store
}

// What parsing leaves behind: the chosen command with its options bound. No farm answering is a code of its own.
struct Outcome {
  Status status;
  bool no_coordinator = false;
  Outcome(Status how) : status(std::move(how)) {}  // NOLINT(google-explicit-constructor): every command ends in one
};
using Action = std::function<Outcome()>;

// Where and how a job is handed in.
struct SubmitOptions {
  bool submit = false;
  depthfarm::FarmArguments farm;
  std::string name;
  int priority = 0;
};

// `value` of an option that was not given is that of the environment, if there.
void UseEnvironment(const CLI::App& command, const char* option, const char* variable, std::string& value) {
  const char* text = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe): no other thread yet
  if (command.get_option(option)->count() == 0 && text != nullptr) value = text;
}

Outcome SubmitViews(const depthfarm::SynthesizeCommandOptions& views, const SubmitOptions& options) {
  const auto job = depthfarm::PlanViewsJob(views, options.name, options.priority);
  if (!job.ok()) return job.status();
  const auto client = depthfarm::Client::Connect(
      {.endpoint = options.farm.coordinator, .keys_dir = options.farm.keys, .insecure = options.farm.insecure},
      {.timeout = std::chrono::milliseconds(std::llround(options.farm.timeout_seconds * 1000)),
       .stop = [] { return interrupted != 0; }});
  if (!client.ok()) return client.status();
  const auto id = (*client)->Submit(*job);
  if (id.ok()) {
    std::cout << *id << "\n";
    return Status();
  }
  Outcome outcome(id.status());
  outcome.no_coordinator = id.status().code() == depthfarm::ErrorCode::kUnavailable;
  return outcome;
}

// `text` as "first<separator>second", both whole numbers. False when it is not.
bool ParsePair(const std::string& text, char separator, int* first, int* second) {
  const char* end = text.data() + text.size();
  const auto [middle, error] = std::from_chars(text.data(), end, *first);
  if (error != std::errc() || middle == end || *middle != separator) return false;
  const auto [rest, second_error] = std::from_chars(middle + 1, end, *second);
  return second_error == std::errc() && rest == end;
}

void AddScene(CLI::App* command, Action* action) {
  auto options = std::make_shared<depthfarm::SceneCommandOptions>();
  command->add_option("kind", options->kind, "Arrangement of the cameras: arc, line, grid, irregular or mixed")
      ->required()
      ->type_name("KIND");
  command->add_option("-o,--output", options->output, "Folder to write: sequence.json, pictures, true depth")
      ->required()
      ->type_name("DIR");
  command->add_option("--cameras", options->cameras, "Number of cameras")->capture_default_str()->type_name("N");
  command
      ->add_option_function<std::string>(
          "--size",
          [options](const std::string& text) {
            const bool parsed = ParsePair(text, 'x', &options->width, &options->height);
            if (!parsed || options->width < 1 || options->height < 1) {
              throw CLI::ValidationError("--size", "is " + text + ", expected WIDTHxHEIGHT, e.g. 640x480");
            }
          },
          "Size of the pictures, pixels")
      ->default_str("640x480")
      ->type_name("WxH");
  command->add_option("--frames", options->frames, "Number of frames")->capture_default_str()->type_name("F");
  command->add_option("--seed", options->seed, "Same seed, same scene")
      ->check(CLI::NonNegativeNumber)  // or -1 would be a number of 20 digits
      ->capture_default_str()
      ->type_name("S");
  command->add_option("--noise", options->noise, "Standard deviation of the sensor noise, grey levels; 0 = none")
      ->capture_default_str()
      ->type_name("SIGMA");
  command->add_option("--gain", options->gain, "Spread of the cameras' gains around 1; 0 = equal cameras")
      ->capture_default_str()
      ->type_name("SPREAD");
  command->add_option("--format", options->format, "Form of the pictures: png, yuv420p8 or yuv420p10le")
      ->capture_default_str()
      ->type_name("NAME");
  command->footer(
      "Example: depthfarm scene arc -o scene --cameras 8 --size 640x480 --frames 10\n"
      "Then:    depthfarm run scene/sequence.json -o out && depthfarm evaluate scene/sequence.json out");
  command->callback([options, action] { *action = [options] { return depthfarm::RunScene(*options); }; });
}

void AddEvaluate(CLI::App* command, Action* action) {
  auto options = std::make_shared<depthfarm::EvaluateCommandOptions>();
  command->add_option("sequence", options->sequence, "Sequence file the depth was estimated from")
      ->required()
      ->type_name("SEQUENCE");
  command->add_option("depth", options->depth_dir, "Folder with depth.json")->required()->type_name("DEPTH_DIR");
  command->add_option("--view", options->view, "Camera to synthesise and compare (default: chosen among the cameras)")
      ->type_name("CAMERA");
  command->add_option("--from", options->from, "Cameras to synthesise it from (default: its neighbours)")
      ->delimiter(',')
      ->type_name("A,B");
  command
      ->add_option_function<std::string>(
          "--frames",
          [options](const std::string& text) {
            const bool parsed = ParsePair(text, ':', &options->first_frame, &options->end_frame);
            if (!parsed || options->first_frame < 0 || options->end_frame <= options->first_frame) {
              throw CLI::ValidationError("--frames", "is " + text + ", expected FIRST:END with FIRST < END, e.g. 0:50");
            }
          },
          "Frames FIRST to END - 1 (default: all)")
      ->type_name("FIRST:END");
  command->add_flag("--json", options->json, "Print the figures as JSON");
  command->add_option("--pictures", options->pictures_dir, "Write the synthesised views and differences there")
      ->type_name("DIR");
  command->add_flag("--bit-rate", options->bit_rate,
                    "Bits of virtual views and of their sources' depth as low-delay HEVC, QP 22, 27, 32, 37");
  command
      ->add_option("--against", options->against,
                   "Other depth of SEQUENCE: Bjøntegaard delta rate of DEPTH_DIR against it; implies --bit-rate")
      ->type_name("DIR");
  // Shown without a default: there is none.
  const char* bounds = "Bounds for scripts: exit with 1, after the figures, when one does not hold";
  const auto add_bound = [&](const char* name, double& value, const char* unit, const char* help) {
    command->add_option(name, value, help)->type_name(unit)->group(bounds);
  };
  add_bound("--min-psnr", options->min_psnr, "DB", "Mean PSNR-Y of the virtual views");
  add_bound("--min-iv-psnr", options->min_iv_psnr, "DB", "Mean IV-PSNR of the virtual views");
  add_bound("--min-agreement", options->min_agreement, "PERCENT", "Non-occluded pixels on which views agree");
  add_bound("--max-bad-px", options->max_bad_px, "PERCENT", "Pixels off by more than 1 px from exact depth");
  add_bound("--max-flicker", options->max_flicker, "PERCENT", "Still pixels whose depth changes by more than a level");
  command->footer(
      "A view that was left out is synthesised from its neighbours' pictures and depth and compared with its picture;\n"
      "where the sequence has ground truth, depth is compared with it too.");
  command->callback([options, action] { *action = [options] { return depthfarm::RunEvaluate(*options, std::cout); }; });
}

// "A:B" with either left out (-1). False when it is not.
bool ParseFrames(const std::string& text, int* first, int* end) {
  const auto colon = text.find(':');
  if (colon == std::string::npos || text.size() == 1) return false;
  const std::string a = colon == 0 ? "-1" : text.substr(0, colon);
  const std::string b = colon + 1 == text.size() ? "-1" : text.substr(colon + 1);
  const bool parsed = ParsePair(a + ":" + b, ':', first, end);
  return parsed && (colon == 0 || *first >= 0) && (colon + 1 == text.size() || *end > std::max(*first, 0));
}

// Of options that have first_frame and end_frame.
template <typename Options>
void AddFrames(CLI::App& command, const std::shared_ptr<Options>& options) {
  command
      .add_option_function<std::string>(
          "--frames",
          [options](const std::string& text) {
            if (!ParseFrames(text, &options->first_frame, &options->end_frame)) {
              throw CLI::ValidationError("--frames", "is " + text + ", expected A:B with A < B, e.g. 0:50");
            }
          },
          "Frames A to B - 1 of the sequence; either may be left out (default: all that have depth)")
      ->type_name("A:B");
}

void AddSynthesize(CLI::App* command, Action* action) {
  auto options = std::make_shared<depthfarm::SynthesizeCommandOptions>();
  command->add_option("sequence", options->sequence, "Sequence file the depth was estimated from")
      ->required()
      ->type_name("SEQUENCE");
  command->add_option("depth", options->depth_dir, "Folder with depth.json")->required()->type_name("DEPTH_DIR");
  command
      ->add_option("-o,--output", options->output,
                   "Folder for PNG pictures 0000.png, ...; FILE.mp4: H.264; FILE.yuv: planar 4:2:0, 8 bits, 16-235")
      ->required()
      ->type_name("OUT");
  command->add_option("--view", options->view, "A camera of the sequence, made from others, in every frame")
      ->type_name("CAMERA");
  command
      ->add_option("--camera", options->camera_file,
                   "Virtual camera: JSON with name, width, height, K, R, t; several under \"cameras\" are a path")
      ->type_name("FILE");
  command
      ->add_option("--path", options->path, "Move from camera to camera; picture i shows frame i, the last frame stays")
      ->delimiter(',')
      ->type_name("A,B,...");
  command->add_option("--steps", options->steps, "Pictures of the path (default: one per frame, 60 of a single frame)")
      ->check(CLI::PositiveNumber)  // 0 would mean the default
      ->type_name("N");
  command
      ->add_option_function<std::vector<std::string>>(
          "--from",
          [options](const std::vector<std::string>& names) {
            if (names != std::vector<std::string>{"auto"}) options->from = names;
          },
          "Cameras to synthesise from; auto: chosen for each picture, on both sides of it")
      ->delimiter(',')
      ->default_str("auto")
      ->type_name("auto|A,B,...");
  command->add_option("--sources", options->sources, "How many cameras auto chooses, 1 to 8")
      ->capture_default_str()
      ->type_name("N");
  AddFrames(*command, options);
  command->add_option("--fps", options->frames_per_second, "Pictures a second of FILE.mp4")
      ->capture_default_str()
      ->type_name("N");
  command->add_option("--threads", options->threads, "Pictures made at once; 0: one per core")
      ->capture_default_str()
      ->type_name("N");
  auto submit = std::make_shared<SubmitOptions>();
  command->add_flag("--submit", submit->submit,
                    "Let a farm make them: DIR/views/NUMBER.png, DIR/views.json; prints the job's number");
  for (const char* local : {"--threads", "--fps"}) {
    command->get_option("--submit")->excludes(command->get_option(local));
  }
  depthfarm::AddFarmOptions(*command, submit->farm);
  command->add_option("--priority", submit->priority, "Jobs of higher priority go first")
      ->type_name("P")
      ->check(CLI::Range(-1000, 1000))
      ->capture_default_str()
      ->group("Farm");
  command->add_option("--name", submit->name, "Name of the job; default: the sequence's and 'views'")
      ->type_name("S")
      ->group("Farm");
  // The environment counts with --submit only (UseEnvironment): given by hand without it, they are an error.
  for (const char* farm : {"--coordinator", "--keys"}) command->get_option(farm)->envname("");
  for (const char* farm : {"--coordinator", "--keys", "--insecure", "--timeout", "--priority", "--name"}) {
    command->get_option(farm)->needs(command->get_option("--submit"));
  }
  command->footer(
      "Depth-image-based rendering: depth is drawn into the virtual view (z-buffer, sub-pixel), colour fetched back,\n"
      "sources blended by nearness where they agree, holes filled from the background.\n"
      "With --submit, DEPTHFARM_COORDINATOR and DEPTHFARM_KEYS stand for --coordinator and --keys; follow\n"
      "the job with depthfarm watch. SEQUENCE, DEPTH_DIR and DIR are paths that every worker must see under the same "
      "name.\n"
      "Examples:\n"
      "  depthfarm synthesize array.json depth -o view2 --view cam2\n"
      "  depthfarm synthesize array.json depth -o sweep --path cam0,cam3,cam7 --steps 100 --frames 0:1\n"
      "  depthfarm synthesize array.json depth -o sweep.mp4 --path cam0,cam7 --fps 30\n"
      "  depthfarm synthesize array.json depth -o /shared/sweep --path cam0,cam7 --submit --coordinator "
      "tcp://head:7700");
  command->callback([options, submit, command, action] {
    *action = [options, submit, command]() -> Outcome {
      CatchInterruptions();
      options->interrupted = [] { return interrupted != 0; };
      if (submit->submit) {
        UseEnvironment(*command, "--coordinator", "DEPTHFARM_COORDINATOR", submit->farm.coordinator);
        UseEnvironment(*command, "--keys", "DEPTHFARM_KEYS", submit->farm.keys);
        return SubmitViews(*options, *submit);
      }
      if (isatty(STDERR_FILENO) != 0) options->progress = &std::cerr;
      return depthfarm::RunSynthesize(*options, std::cout);
    };
  });
}

void AddColour(CLI::App* command, Action* action) {
  auto options = std::make_shared<depthfarm::ColourCommandOptions>();
  command->add_option("depth", options->depth_dir, "Folder with depth.json")->required()->type_name("DEPTH_DIR");
  command->add_option("-o,--output", options->output, "Folder for the pictures: CAMERA/FRAME.png and contact.png")
      ->required()
      ->type_name("DIR");
  command->footer("Near is red, far is blue, no depth is black; all cameras share one scale.");
  command->callback([options, action] { *action = [options] { return depthfarm::RunColour(*options, std::cout); }; });
}

void AddExport(CLI::App* command, Action* action) {
  auto options = std::make_shared<depthfarm::ExportCommandOptions>();
  command->add_option("format", options->format, "pfm, exr, yuv or ply, see below")->required()->type_name("FORMAT");
  command->add_option("depth", options->depth_dir, "Folder with depth.json")->required()->type_name("DEPTH_DIR");
  command->add_option("-o,--output", options->output, "Folder to write")->required()->type_name("DIR");
  command->add_option("--sequence", options->sequence, "ply: sequence file the depth was estimated from")
      ->type_name("SEQUENCE");
  AddFrames(*command, options);
  command->add_option("--step", options->step, "ply: a point for every N-th column and row")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->type_name("N");
  command
      ->add_option("--min-confidence", options->min_confidence,
                   "ply: leave out depth that is right within a level with a smaller probability (run --confidence on)")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str()
      ->type_name("P");
  command->footer(
      "Formats:\n"
      "  pfm   DIR/CAMERA/FRAME.pfm: z along the camera's axis, the sequence's unit of length, 0 where there is none\n"
      "  exr   DIR/CAMERA/FRAME.exr: the same as channel Z of OpenEXR files\n"
      "  yuv   DIR/CAMERA.yuv: all frames, planar 4:2:0, 16 bits little-endian; luma is 1 + 65534 (1/z - 1/zFar) /\n"
      "        (1/zNear - 1/zFar) with the camera's zNear and zFar in DIR/cameras.json, 0 where there is none\n"
      "  ply   DIR/FRAME.ply: points of all cameras in the world, with their colours\n"
      "Examples:\n"
      "  depthfarm export yuv my-depth -o my-videos\n"
      "  depthfarm export ply my-depth -o my-points --sequence my-array/sequence.json --step 2 --frames 0:1");
  command->callback([options, action] {
    *action = [options] {
      CatchInterruptions();
      options->interrupted = [] { return interrupted != 0; };
      return depthfarm::RunExport(*options, std::cout);
    };
  });
}

struct Command {
  const char* name;
  const char* summary;
  void (*add)(CLI::App* command, Action* action);
};

constexpr std::array<Command, 5> kCommands = {{
    {"scene", "Render a synthetic multi-camera sequence with exact depth", AddScene},
    {"evaluate", "Measure depth: synthesised views against pictures, depth against ground truth", AddEvaluate},
    {"synthesize", "Render virtual views from pictures and depth", AddSynthesize},
    {"colour", "Turn depth maps into colour pictures to look at", AddColour},
    {"export", "Write depth for other programs: PFM, YUV video, point clouds", AddExport},
}};

// Speaks of itself as depthfarm, the program that people call.
int Run(int argc, char** argv) {
  CLI::App app("Commands of depthfarm that work on pictures and depth maps.", "depthfarm");
  app.set_version_flag("--version", DEPTHFARM_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 ok, 1 failed, 2 bad usage or bad input, 3 no coordinator, 130 interrupted. 'depthfarm COMMAND "
      "--help' tells more.");
  Action action;
  for (const Command& command : kCommands) command.add(app.add_subcommand(command.name, command.summary), &action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ExtrasError& error) {
    (void)app.exit(error);
    // The other commands have the sequence before the depth.
    if (app.got_subcommand("export"))
      std::cerr << "export takes FORMAT and DEPTH_DIR alone; the sequence, which ply needs, is --sequence SEQUENCE.\n";
    return kExitBadUsage;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitOk : kExitBadUsage;
  }
  const Outcome outcome = action();
  const Status& status = outcome.status;
  if (status.ok()) return kExitOk;
  if (status.code() == depthfarm::ErrorCode::kCancelled) return kExitInterrupted;
  std::cerr << "depthfarm: " << status.message() << "\n";
  if (outcome.no_coordinator) return kExitNoCoordinator;
  return status.code() == depthfarm::ErrorCode::kInvalidArgument ? kExitBadUsage : kExitFailed;
}

}  // namespace

int main(int argc, char** argv) {
  // A fifth of the time of a virtual view.
  depthfarm::KeepFreedMemory({.most_bytes = 1U << 30U, .largest_block_bytes = 1U << 30U});
  try {
    return Run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "depthfarm: unexpected failure: " << error.what() << "\n";
    return kExitFailed;
  }
}
