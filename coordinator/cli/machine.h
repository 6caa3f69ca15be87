#ifndef DEPTHFARM_COORDINATOR_CLI_MACHINE_H_
#define DEPTHFARM_COORDINATOR_CLI_MACHINE_H_

#include <istream>
#include <string>

namespace depthfarm {

// What times were measured on.
struct Machine {
  std::string cpu;  // its name; that of the architecture where the system does not tell
  int cores = 0;    // that this process may use
};
[[nodiscard]] Machine ThisMachine();

// The name of the first CPU in the text of /proc/cpuinfo; empty: there is none.
[[nodiscard]] std::string CpuName(std::istream& cpu_info);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_CLI_MACHINE_H_
