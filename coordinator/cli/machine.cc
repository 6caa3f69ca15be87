#include "coordinator/cli/machine.h"

#include <sys/utsname.h>

#include <fstream>
#include <thread>

namespace depthfarm {

std::string CpuName(std::istream& cpu_info) {
  for (std::string line; std::getline(cpu_info, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t name = line.find_first_not_of(" \t", line.find(':') + 1);
    if (line.find(':') != std::string::npos && name != std::string::npos) return line.substr(name);
  }
  return "";
}

Machine ThisMachine() {
  Machine machine;
  std::ifstream cpu_info("/proc/cpuinfo");
  machine.cpu = CpuName(cpu_info);
  utsname system = {};
  if (machine.cpu.empty() && ::uname(&system) == 0) machine.cpu = system.machine;
  machine.cores = static_cast<int>(std::thread::hardware_concurrency());
  return machine;
}

}  // namespace depthfarm
