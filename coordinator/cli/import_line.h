#ifndef DEPTHFARM_COORDINATOR_CLI_IMPORT_LINE_H_
#define DEPTHFARM_COORDINATOR_CLI_IMPORT_LINE_H_

#include "coordinator/cli/arguments.h"

namespace CLI {
class App;
}  // namespace CLI

namespace depthfarm {

// The command line of `depthfarm import`; where its values go is put into `storage`.
void DefineImport(CLI::App& app, CommandArguments& storage);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_IMPORT_LINE_H_
