#include "coordinator/cli/command_line.h"

#include <CLI/CLI.hpp>  // 10 s to compile
#include <algorithm>
#include <array>
#include <charconv>
#include <memory>
#include <sstream>
#include <thread>

#include "coordinator/cli/cluster_line.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/import_line.h"
#include "coordinator/cli/option_parts.h"

namespace depthfarm {
namespace {

constexpr const char* kVersion = DEPTHFARM_VERSION;

constexpr const char* kOverview =
    "Depth maps of multi-camera sequences, estimated together and consistently, on one machine or a farm.\n"
    "Start with: depthfarm demo";
constexpr const char* kExitCodes =
    "Exit codes: 0 done, 1 failed, 2 bad usage or bad input, 3 no coordinator, 130 interrupted.\n"
    "Help of a command: depthfarm COMMAND --help";

// Commands that touch pixels; this program stays light and executes another one for them.
struct MediaCommand {
  const char* name;
  const char* summary;
};
constexpr auto kMediaCommands = std::to_array<MediaCommand>({
    {"scene", "Render a synthetic multi-camera sequence with exact depth"},
    {"evaluate", "Quality of depth maps: virtual views, ground truth, consistency, bits"},
    {"synthesize", "Virtual views from pictures and depth: a camera's, any other, a path"},
    {"colour", "Colour pictures of depth maps"},
    {"export", "Depth for other programs: PFM, YUV video, point clouds"},
});

void AddEstimationOptions(CLI::App& app, EstimationArguments& estimation) {
  const char* group = "Estimation options";
  app.add_option("--preset", estimation.preset,
                 "Values to start from: default; best (thin objects and edges, 30 % more CPU); fast (a quarter less); "
                 "paper (the published method: 250 levels, n = 1, no refinement)")
      ->type_name("default|best|fast|paper")
      ->group(group);
  app.add_option(
         "--params", estimation.params_file,
         "JSON object of option names and values, e.g. {\"levels\": 64, \"frames\": \"0:50\"}; explicit options win")
      ->type_name("FILE")
      ->group(group);
  for (const EstimationOption& option : EstimationOptions()) {
    const std::string name(option.name);
    const auto keep = [&estimation, name](const std::string& text) { estimation.values.emplace_back(name, text); };
    app.add_option_function<std::string>("--" + name, keep, std::string(option.help))
        ->type_name(std::string(option.value))
        ->group(group);
  }
}

void AddSequence(CLI::App& app, JobArguments& job) {
  app.add_option("SEQUENCE", job.sequence, "JSON file of cameras and pictures")->required()->type_name("");
  app.add_flag("--allow-outside", job.allow_outside, "Accept picture paths that leave the folder of SEQUENCE");
}

CLI::Option* AddJobOptions(CLI::App& app, JobArguments& job) {
  AddSequence(app, job);
  CLI::Option* output =
      app.add_option("-o,--output", job.output_dir, "Output folder: DIR/depth/CAMERA/FRAME.png, DIR/depth.json")
          ->type_name("DIR");
  AddEstimationOptions(app, job.estimation);
  return output;
}

void AddJobId(CLI::App& app, std::uint64_t& job) {
  // Not CLI11's own conversion, which takes -1 for a number of 20 digits.
  const auto parse = [&job](const std::string& text) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), job);
    if (error != std::errc() || end != text.data() + text.size()) {
      throw CLI::ValidationError("JOB", "'" + text + "' is not a job number");
    }
  };
  app.add_option_function<std::string>("JOB", parse, "Number that submit printed")->required()->type_name("");
}

void DefineDemo(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<DemoArguments>();
  app.add_option("-o,--output", arguments.output_dir, "Output folder")->type_name("DIR")->capture_default_str();
  app.footer(
      "Renders a scene of 5 cameras (512x384, 6 frames), estimates its depth on a local farm of two workers, measures\n"
      "the quality and writes colour pictures. Takes a minute or two.\n"
      "Example: depthfarm demo -o /tmp/demo");
}

void DefineRun(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<RunArguments>();
  AddJobOptions(app, arguments.job)->required();
  const char* group = "Local farm";
  AddWorkerRange(
      app, arguments.engine.workers,
      "Worker processes; default: as many as give each core a slot. Of another engine also bounds, as many as there is "
      "work for");
  AddThreads(app, arguments.farm.threads)->group(kWorkersGroup);
  AddEngine(app, arguments.engine, "--slurm-partition");
  app.get_option("--slots")
      ->description(
          "Tasks that each worker computes at a time; default: one, or on this machine, where --workers is not named, "
          "up to four")
      ->default_str("")
      ->each([&arguments](const std::string& slots) { arguments.farm.slots = std::stoi(slots); });
  CLI::Option* cache_dir = app.get_option("--cache-dir");
  cache_dir->description(
      "Folder of the artifacts, shared by the workers and kept: a run that was interrupted, or one with more frames "
      "or other output, computes only what is new. Default: depthfarm/artifacts in $XDG_CACHE_HOME or ~/.cache; of "
      "another engine's machines temporary ones");
  CLI::Option* cache_size = app.get_option("--cache-size");
  cache_size->description("Bound of that folder; default: 8GB, and on this machine at most a tenth of its file system");
  app.add_flag("--no-cache", arguments.no_cache, "Reuse nothing and keep nothing")
      ->excludes(cache_dir)
      ->excludes(cache_size)
      ->group(kWorkersGroup);
  app.add_option("--worker-log-dir", arguments.farm.worker_log_dir,
                 "Keep the logs of coordinator and workers in this folder; default: a temporary one, removed")
      ->type_name("DIR")
      ->group(group);
  app.add_option("--log-level", arguments.farm.log_level, "Of coordinator and workers")
      ->type_name("LEVEL")
      ->check(CLI::IsMember({"debug", "info", "warning", "error", "off"}))
      ->capture_default_str()
      ->group(group);
  AddJsonFlag(app, arguments.json);
  app.footer(
      "Starts a coordinator and workers on this machine, waits for the job, writes DIR/run.json (times, memory) and\n"
      "stops everything. Ctrl-C cancels and cleans up; the same command then goes on where it was. The depth is the "
      "same\n"
      "bytes whatever --workers, --slots and --threads are.\n"
      "With --engine it brings a cluster up for the job and takes it down after it: depthfarm cluster up --help.\n"
      "Examples:\n"
      "  depthfarm run ballet/cameras.json -o out\n"
      "  depthfarm run array.json -o out --engine slurm --workers 4..64 --slurm-partition render\n"
      "  depthfarm run array.json -o out --workers 8 --frames 0:50 --levels 128\n"
      "  depthfarm run array.json -o out --preset paper --level-blocks 4 --partition blocks");
}

void DefinePlan(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<PlanArguments>();
  AddSequence(app, arguments.job);
  app.add_option("--workers", arguments.workers, "Workers of the farm; default: 1, 2, 4, ... until more do not help")
      ->type_name("N")
      ->check(CLI::Range(1, 4096));
  AddJsonFlag(app, arguments.json);
  AddEstimationOptions(app, arguments.job.estimation);
  app.footer(
      "Says what run or submit would do with the same options, without doing it: what \"auto\" chooses, the tasks by "
      "stage\n"
      "with their CPU time, memory and bytes, the chain of tasks that takes longest, and the time on farms of "
      "different\n"
      "size. Needs no farm and writes nothing. Times are predictions for one core of a server of the early 2020s, "
      "from\n"
      "sizes and options alone; depthfarm bench measures this machine.\n"
      "Examples:\n"
      "  depthfarm plan array.json\n"
      "  depthfarm plan array.json --preset paper --level-blocks 4 --workers 16 --json");
}

void DefineBench(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<BenchArguments>();
  CLI::Option* sequence = app.add_option("SEQUENCE", arguments.sequence,
                                         "JSON file of cameras and pictures; default: an arc scene that is rendered")
                              ->type_name("");
  app.add_flag("--allow-outside", arguments.allow_outside, "Accept picture paths that leave the folder of SEQUENCE");
  app.add_option("--workers", arguments.workers, "Worker processes of each farm")
      ->type_name("N")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  AddThreads(app, arguments.threads);
  app.add_option("--repeat", arguments.repeats, "Jobs of each preset, in turn; figures are medians")
      ->type_name("R")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  AddJsonFlag(app, arguments.json);
  const char* group = "Rendered scene";
  app.add_option("--size", arguments.size, "Size of the pictures, pixels")
      ->type_name("WxH")
      ->excludes(sequence)
      ->capture_default_str()
      ->group(group);
  app.add_option("--cameras", arguments.cameras, "Number of cameras, 2 to 256")
      ->type_name("N")
      ->check(CLI::Range(2, 256))
      ->excludes(sequence)
      ->capture_default_str()
      ->group(group);
  app.add_option("--seed", arguments.seed, "Same seed, same scene")
      ->type_name("S")
      ->check(CLI::NonNegativeNumber)
      ->excludes(sequence)
      ->capture_default_str()
      ->group(group);
  AddEstimationOptions(app, arguments.estimation);
  CLI::Option* preset = app.get_option("--preset");
  preset->description("One job for each, in turn. " + preset->get_description())->type_name("NAME,...");
  app.footer(
      "Runs the job of each preset on a farm of its own and prints CPU seconds of a view by stage, wall time, memory "
      "and\n"
      "quality. Of a rendered scene one frame is estimated unless --frames says more; of SEQUENCE all of them. "
      "Everything\n"
      "is kept in a temporary folder, which is removed. What else the machine does shows less in CPU seconds than in "
      "wall\n"
      "time; --repeat shows how much.\n"
      "Examples:\n"
      "  depthfarm bench\n"
      "  depthfarm bench --size 1920x1080 --cameras 6 --preset default,paper --repeat 3\n"
      "  depthfarm bench array.json --frames 0:1 --levels 64 --json");
}

void DefineSubmit(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<SubmitArguments>();
  AddJobOptions(app, arguments.job)
      ->description(
          "Output folder that workers see and write; without it depth stays on the workers for depthfarm fetch");
  AddFarmOptions(app, arguments.farm);
  app.add_option("--priority", arguments.priority, "Jobs of higher priority go first")
      ->type_name("P")
      ->check(CLI::Range(-1000, 1000))
      ->capture_default_str();
  app.add_option("--name", arguments.name, "Name of the job; default: the sequence's")->type_name("S");
  app.add_option("--require", arguments.required_tags,
                 "Only workers with all of these tags (their --tags) get its tasks")
      ->type_name("TAG,...")
      ->delimiter(',');
  app.add_flag("--wait", arguments.wait, "Wait for the end of the job, showing progress");
  CLI::Option* upload = app.add_flag(
      "--upload", arguments.upload,
      "Serve the pictures from here to workers that cannot see them, until the job has ended; DIR of -o is "
      "then of this machine. Ctrl-C cancels the job");
  app.add_option("--upload-listen", arguments.upload_listen,
                 "Endpoint to serve at; default: a free port, on the loopback address if the coordinator is there")
      ->type_name("tcp://HOST:PORT")
      ->needs(upload);
  app.add_option("--upload-host", arguments.upload_host, "Name or address that workers reach this machine by")
      ->type_name("HOST")
      ->needs(upload);
  AddJsonFlag(app, arguments.json);
  app.footer(
      "Prints the number of the job. Pictures and DIR are paths that every worker must see, under the same name or as "
      "its\n"
      "--path-map says. Without -o the depth files stay in the caches of the workers until depthfarm fetch copies "
      "them.\n"
      "Examples:\n"
      "  depthfarm submit array.json -o /shared/out --coordinator tcp://head:7700 --keys ~/farm-keys\n"
      "  depthfarm submit /shared/array.json; depthfarm fetch 1 -o out --wait\n"
      "  depthfarm submit array.json -o out --upload");
}

void DefineStatus(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<StatusArguments>();
  AddJobId(app, arguments.job);
  AddFarmOptions(app, arguments.farm);
  AddJsonFlag(app, arguments.json);
  app.footer("Example: depthfarm status 3 --json");
}

void DefineWatch(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<WatchArguments>();
  AddJobId(app, arguments.job);
  AddFarmOptions(app, arguments.farm);
  AddJsonFlag(app, arguments.json);
  app.footer(
      "Shows progress until the job ends; exit code 0 when it is done, 1 (or 2: its input is bad) when it failed or "
      "was\n"
      "cancelled. Ctrl-C stops watching, not the job.\n"
      "Example: depthfarm watch 3");
}

void DefineLogs(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<LogsArguments>();
  AddJobId(app, arguments.job);
  app.add_option(
         "--task", arguments.task,
         "Only tasks of that name, as status prints it: 'frame 3 estimate block 0'; a part of it takes all that "
         "have it: 'frame 3', merge")
      ->type_name("T");
  AddFarmOptions(app, arguments.farm);
  AddJsonFlag(app, arguments.json);
  app.footer(
      "Every attempt of the job's tasks in the order in which they were granted: worker, start since the job was "
      "submitted,\n"
      "time, memory, bytes fetched and how it ended; below it why it failed and what its worker logged meanwhile:\n"
      "warnings, errors, and what libraries wrote to stderr, the last 64 lines. Of a job all failed attempts are kept, "
      "and\n"
      "the newest 10,000 of the others, as long as the farm knows the job.\n"
      "Examples:\n"
      "  depthfarm logs 3\n"
      "  depthfarm logs 3 --task 'frame 12 analyse view 0' --json");
}

void DefineJobs(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<JobsArguments>();
  AddFarmOptions(app, arguments.farm);
  AddJsonFlag(app, arguments.json);
  app.footer("Example: depthfarm jobs --coordinator tcp://head:7700 --keys ~/farm-keys");
}

void DefineCancel(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<CancelArguments>();
  AddJobId(app, arguments.job);
  AddFarmOptions(app, arguments.farm);
  app.footer(
      "Frames that are complete stay in the output folder, and depthfarm retry goes on from there.\n"
      "Example: depthfarm cancel 3");
}

void DefineRetry(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<RetryArguments>();
  AddJobId(app, arguments.job);
  app.add_flag("--wait", arguments.wait, "Show progress and wait for the end; the exit code says how it ended");
  AddFarmOptions(app, arguments.farm);
  AddJsonFlag(app, arguments.json);
  app.footer(
      "A job that failed or was cancelled goes on under its number: frames whose files are in place stay, of the "
      "others\n"
      "only what no worker holds any more is computed again.\n"
      "Example: depthfarm retry 3 --wait");
}

void DefineWorkers(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<WorkersArguments>();
  AddFarmOptions(app, arguments.farm);
  AddJsonFlag(app, arguments.json);
  app.footer("Example: depthfarm workers --json");
}

void DefineDrain(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<DrainArguments>();
  app.add_option("WORKER", arguments.worker, "Its name, as depthfarm workers tells")->required()->type_name("");
  AddFarmOptions(app, arguments.farm);
  app.footer(
      "The worker gets no more tasks and ends when it is done with those it has. Takes a key of role admin.\n"
      "Example: depthfarm drain render07:4711-93");
}

void DefineFetch(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<FetchArguments>();
  AddJobId(app, arguments.job);
  app.add_option("-o,--output", arguments.output_dir,
                 "Folder of this machine: DIR/depth/CAMERA/FRAME.png, DIR/depth.json")
      ->required()
      ->type_name("DIR");
  AddFarmOptions(app, arguments.farm);
  app.add_flag("--wait", arguments.wait, "Stay until the job has ended, fetching frames as they are done");
  AddJsonFlag(app, arguments.json);
  app.footer(
      "Copies the depth of a job that was submitted without an output folder from the workers, and checks every "
      "digest.\n"
      "DIR is in the end what submit -o would have written. Files that are there and right are not fetched again, so "
      "a\n"
      "fetch that was interrupted, or of a job that still runs, is gone on with by the same command. Exit code 0: all "
      "is\n"
      "here; 1: frames are not done yet, or are lost. Workers keep results until 1000 later jobs have ended or their\n"
      "caches are full.\n"
      "Example: depthfarm fetch 3 -o out");
}

void DefineVerify(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<VerifyArguments>();
  app.add_option("DIR", arguments.directory, "Output folder of a job")->required()->type_name("");
  AddJsonFlag(app, arguments.json);
  app.footer(
      "Reads every file that depth.json and views.json name and compares its SHA-256; says what is missing, "
      "unreadable,\n"
      "changed or not of the job that wrote them. Exit code 0: all is right; 1: it is not; 2: no job finished there.\n"
      "Example: depthfarm verify /shared/out");
}

void DefineKeygen(CLI::App& app, CommandArguments& storage) {
  auto& arguments = storage.emplace<KeygenArguments>();
  app.add_option("-o,--output", arguments.output_dir, "Folder for the keys; must not hold keys yet")
      ->required()
      ->type_name("DIR");
  app.footer(
      "Makes key pairs for coordinator, workers and clients and the list of those who may do what (authorized).\n"
      "Give coordinator.key to the coordinator's host only, worker.key to worker hosts, client.key to submitters;\n"
      "*.pub and authorized may be read by all.\n"
      "Example: depthfarm keygen -o ~/farm-keys");
}

struct Command {
  const char* name;
  const char* summary;
  // Adds the command's options and puts its arguments, where their values will go, into `storage`.
  void (*define)(CLI::App& app, CommandArguments& storage);
};
constexpr auto kCommands = std::to_array<Command>({
    {"demo", "Render a small scene, estimate its depth, measure and colour it: start here", DefineDemo},
    {"run", "Estimate depth on this machine", DefineRun},
    {"plan", "Tasks, time, memory and bytes of a job, without running it", DefinePlan},
    {"bench", "Speed of the core on this machine, by stage and preset", DefineBench},
    {"submit", "Hand a job to a farm; prints its number", DefineSubmit},
    {"status", "State of a job", DefineStatus},
    {"watch", "Progress of a job until it ends", DefineWatch},
    {"logs", "What happened to a job's tasks, attempt by attempt", DefineLogs},
    {"jobs", "All jobs of a farm", DefineJobs},
    {"cancel", "End a job", DefineCancel},
    {"retry", "Let a job go on that failed or was cancelled", DefineRetry},
    {"workers", "Workers of a farm", DefineWorkers},
    {"drain", "End a worker when it is done with its tasks", DefineDrain},
    {"cluster", "Farms whose workers Slurm, ssh or this machine provides: up, status, down", DefineCluster},
    {"fetch", "Copy a job's depth from the farm when it was submitted without an output folder", DefineFetch},
    {"verify", "Check an output folder against its digests", DefineVerify},
    {"import", "Turn the calibration of another program (COLMAP, MPEG, ...) into a sequence file", DefineImport},
    {"keygen", "Make the keys of a farm", DefineKeygen},
});

bool IsCommand(const std::string& word) {
  return IsMediaCommand(word) ||
         std::ranges::any_of(kCommands, [&](const Command& command) { return word == command.name; });
}

std::string UnknownCommand(const std::string& word) {
  std::string text = "depthfarm: there is no command '" + word + "'; there are";
  for (const auto& command : kCommands) text += std::string(" ") + command.name;
  for (const MediaCommand& media : kMediaCommands) text += std::string(" ") + media.name;
  return text + "; see depthfarm --help\n";
}

}  // namespace

bool IsMediaCommand(const std::string& command) {
  return std::ranges::any_of(kMediaCommands, [&](const MediaCommand& media) { return command == media.name; });
}

std::variant<CommandArguments, CommandLineExit> ParseCommandLine(const std::vector<std::string>& words) {
  CLI::App app(kOverview, "depthfarm");
  app.set_version_flag("--version", std::string("depthfarm ") + kVersion);
  app.require_subcommand(1);
  app.footer(kExitCodes);
  std::array<CommandArguments, kCommands.size()> arguments;
  std::array<CLI::App*, kCommands.size()> commands{};
  for (std::size_t i = 0; i < kCommands.size(); ++i) {
    commands[i] = app.add_subcommand(kCommands[i].name, kCommands[i].summary);
    kCommands[i].define(*commands[i], arguments[i]);
  }
  for (const MediaCommand& media : kMediaCommands) app.add_subcommand(media.name, media.summary);
  // CLI11 would only say that it wants a subcommand.
  if (!words.empty() && !words[0].starts_with("-") && !IsCommand(words[0]))
    return CommandLineExit{kExitBadInput, "", UnknownCommand(words[0])};
  try {
    std::vector<std::string> reversed(words.rbegin(), words.rend());  // the order CLI11 asks for
    app.parse(std::move(reversed));
  } catch (const CLI::ParseError& outcome) {
    std::ostringstream output;
    std::ostringstream error;
    const int code = app.exit(outcome, output, error);
    return CommandLineExit{code == 0 ? kExitOk : kExitBadInput, output.str(), error.str()};
  }
  for (std::size_t i = 0; i < kCommands.size(); ++i) {
    if (commands[i]->parsed()) return std::move(arguments[i]);
  }
  return CommandLineExit{kExitBadInput, "", "expected a command, see depthfarm --help\n"};
}

}  // namespace depthfarm
