#ifndef DEPTHFARM_TESTS_SIMULATION_TALLY_H_
#define DEPTHFARM_TESTS_SIMULATION_TALLY_H_

#include <cstdint>

namespace depthfarm::simulation {

// What was counted in one run or several.
struct Tally {
  std::uint64_t runs = 0;
  std::uint64_t attempts = 0;  // of tasks, begun
  std::uint64_t messages = 0;
  std::uint64_t messages_lost = 0;
  std::uint64_t worker_crashes = 0;
  std::uint64_t deaths_told = 0;  // of workers, by who minds them
  std::uint64_t standstills = 0;
  std::uint64_t cuts = 0;
  std::uint64_t store_losses = 0;
  std::uint64_t coordinator_crashes = 0;  // of which some
  std::uint64_t torn_writes = 0;          // in a write of the journal
  std::uint64_t late_results = 0;
  std::uint64_t asked_back = 0;      // tasks that wait behind the slots of a worker
  std::uint64_t given_back = 0;      // of these
  std::uint64_t duplicates = 0;      // of tasks that took too long
  std::uint64_t duplicates_won = 0;  // of which some were first
  std::uint64_t jobs_done = 0;
  std::uint64_t jobs_ended_otherwise = 0;
  double hours = 0;        // of the farm's time
  double longest_end = 0;  // minutes from the last fault to the end of the last job

  void Add(const Tally& other);
};

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_TALLY_H_
