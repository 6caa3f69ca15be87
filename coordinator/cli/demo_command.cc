#include <filesystem>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/interruption.h"
#include "coordinator/cli/media_program.h"
#include "coordinator/cli/processes.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;

// Runs a command of depthfarm-media with this process's output; its exit code.
int ShowMedia(const std::vector<std::string>& words) {
  std::cout << "\n$ depthfarm";
  for (const std::string& word : words) std::cout << " " << word;
  std::cout << "\n" << std::flush;
  const Result<ProcessEnd> end = RunMedia(words);
  if (!end.ok()) return end.status().code() == ErrorCode::kCancelled ? kExitInterrupted : Fail(end.status());
  if (end->ok()) return kExitOk;
  std::cerr << "depthfarm: depthfarm-media " << words.front() << " " << Describe(*end) << "\n";
  return end->signal == 0 ? end->exit_code : kExitFailed;
}

int RunFarm(const std::string& sequence, const std::string& output_dir) {
  std::cout << "\n$ depthfarm run " << sequence << " -o " << output_dir << " --workers 2 --no-cache\n" << std::flush;
  RunArguments run;
  run.job.sequence = sequence;
  run.job.output_dir = output_dir;
  run.engine.workers = "2";
  run.no_cache = true;  // it shows the work
  return Execute(run);
}

}  // namespace

int Execute(const DemoArguments& arguments) {
  CatchInterruptions();
  const fs::path folder(arguments.output_dir);
  const std::string scene = (folder / "scene").string();
  const std::string sequence = (folder / "scene" / "sequence.json").string();
  const std::string result = (folder / "result").string();
  const std::string colour = (folder / "colour").string();
  const std::vector<std::function<int()>> steps = {
      [&] {
        return ShowMedia({"scene", "arc", "-o", scene, "--cameras", "5", "--size", "512x384", "--frames", "6"});
      },
      [&] { return RunFarm(sequence, result); },
      [&] {
        return ShowMedia({"evaluate", sequence, result});
      },
      [&] {
        return ShowMedia({"colour", result, "-o", colour});
      },
  };
  for (const auto& step : steps) {
    if (const int code = step(); code != kExitOk) return code;
  }
  std::cout << "\nPictures of the cameras:  " << scene << "\n"
            << "Depth, 16 bit:            " << result << "/depth (format: depth.json beside it)\n"
            << "Depth, coloured:          " << colour << "\n"
            << "Times and memory:         " << result << "/run.json\n";
  return kExitOk;
}

}  // namespace depthfarm
