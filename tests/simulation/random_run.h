#ifndef DEPTHFARM_TESTS_SIMULATION_RANDOM_RUN_H_
#define DEPTHFARM_TESTS_SIMULATION_RANDOM_RUN_H_

#include <cstdint>
#include <string>
#include <vector>

#include "tests/simulation/simulated_farm.h"

namespace depthfarm::simulation {

struct RunResult {
  std::vector<std::string> problems;
  std::uint64_t trace = 0;
  Tally tally;
};

// One farm whose workers, users and faults come from the seed. `scratch`: an empty folder, emptied again. `narrates`:
// says to stderr what happens.
[[nodiscard]] RunResult RunSeed(std::uint64_t seed, const std::string& scratch, bool narrates = false);

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_RANDOM_RUN_H_
