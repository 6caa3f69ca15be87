#ifndef DEPTHFARM_COORDINATOR_CLI_COMMAND_LINE_H_
#define DEPTHFARM_COORDINATOR_CLI_COMMAND_LINE_H_

#include <string>
#include <variant>
#include <vector>

#include "coordinator/cli/arguments.h"

namespace depthfarm {

// The command line asked for nothing to run: help, the version, or it was wrong.
struct CommandLineExit {
  int code = 0;
  std::string output;  // for stdout
  std::string error;   // for stderr
};

// Reads a command line (without the program's name). Bounds of estimation options are checked later.
[[nodiscard]] std::variant<CommandArguments, CommandLineExit> ParseCommandLine(const std::vector<std::string>& words);

// Whether `command` is one of the pixel commands, which the program depthfarm-media runs with the same words.
[[nodiscard]] bool IsMediaCommand(const std::string& command);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_COMMAND_LINE_H_
