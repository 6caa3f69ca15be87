#ifndef DEPTHFARM_COORDINATOR_CLI_OPTION_PARTS_H_
#define DEPTHFARM_COORDINATOR_CLI_OPTION_PARTS_H_

#include <string>

#include "coordinator/cli/arguments.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace depthfarm {

// Options that several commands have, under the heading "Workers" where they are of workers.
inline constexpr const char* kWorkersGroup = "Workers";

void AddJsonFlag(CLI::App& app, bool& json);
// --threads, 1 to 256; under no heading of its own.
CLI::Option* AddThreads(CLI::App& app, int& threads);
// --workers N|A..B, see ParseWorkerRange.
void AddWorkerRange(CLI::App& app, std::string& workers, const std::string& help);
// --engine and all that belongs to it. `partition`: the name of Slurm's option; jobs have a --partition of levels.
void AddEngine(CLI::App& app, EngineArguments& arguments, const char* partition);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_OPTION_PARTS_H_
