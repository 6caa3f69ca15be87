// `depthfarm`: the command line of the farm. Commands are listed in command_line.cc, done in *_command*.cc.
#include <iostream>
#include <string>
#include <variant>
#include <vector>

#include "coordinator/cli/command_line.h"
#include "coordinator/cli/commands.h"
#include "coordinator/cli/exit_codes.h"
#include "coordinator/cli/processes.h"

namespace depthfarm {
namespace {

int ExecuteMediaCommand(const std::vector<std::string>& words) {
  const Result<std::filesystem::path> program = SiblingProgram("depthfarm-media");
  if (!program.ok()) return Fail(program.status());
  return Fail(ReplaceProcess(*program, words));
}

int Main(const std::vector<std::string>& words) {
  if (!words.empty() && IsMediaCommand(words.front())) return ExecuteMediaCommand(words);
  const auto outcome = ParseCommandLine(words);
  if (const auto* exit = std::get_if<CommandLineExit>(&outcome)) {
    std::cout << exit->output;
    std::cerr << exit->error;
    return exit->code;
  }
  return std::visit([](const auto& arguments) { return Execute(arguments); }, std::get<CommandArguments>(outcome));
}

}  // namespace
}  // namespace depthfarm

int main(int argc, char** argv) { return depthfarm::Main(std::vector<std::string>(argv + 1, argv + argc)); }
