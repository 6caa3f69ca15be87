#ifndef DEPTHFARM_TESTS_SIMULATION_SIMULATED_DISK_H_
#define DEPTHFARM_TESTS_SIMULATION_SIMULATED_DISK_H_

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/random.h"

namespace depthfarm::simulation {

// A disk in memory that SQLite writes to, by an SQLite VFS of its own. It can die at any write, in the middle of it:
// from then on every call fails, as if the process had ended there. What was not synced may then be lost in parts.
class SimulatedDisk {
 public:
  // `seed`: of what becomes of writes that were not synced.
  explicit SimulatedDisk(std::uint64_t seed);
  ~SimulatedDisk();
  SimulatedDisk(const SimulatedDisk&) = delete;
  SimulatedDisk& operator=(const SimulatedDisk&) = delete;

  // The name of its VFS.
  [[nodiscard]] const std::string& vfs() const;

  // Dies at the n-th change of a file from now on, 1 being the next one; 0: at none.
  void DieAtWrite(int n);
  void Die();
  [[nodiscard]] bool dead() const;
  enum class Loss {
    kProcess,  // the system writes what it had taken
    kPower,    // of each change that was not synced nothing, a part or all is there
  };
  // Lives again, with what is left of its files. Requires that nobody has one open.
  void Restart(Loss loss);

  struct State;

 private:
  std::unique_ptr<State> state_;
};

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_SIMULATED_DISK_H_
