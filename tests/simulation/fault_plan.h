#ifndef DEPTHFARM_TESTS_SIMULATION_FAULT_PLAN_H_
#define DEPTHFARM_TESTS_SIMULATION_FAULT_PLAN_H_

#include "tests/simulation/network.h"
#include "tests/simulation/simulated_worker.h"
#include "tests/support/random.h"

namespace depthfarm::simulation {

// What goes wrong in one run. Pauses are means; 0: it does not happen.
struct FaultPlan {
  Milliseconds chaos{0};  // after that long nothing new goes wrong
  int task_length = 1;    // times the usual one
  NetworkFaults network;
  TaskFaults tasks;
  Milliseconds crashes{0};              // of a worker, which is started again later
  Milliseconds standstills{0};          // of a worker, for up to three leases
  Milliseconds slowdowns{0};            // of a worker, to a tenth
  Milliseconds cuts{0};                 // between two hosts, in one direction or both
  Milliseconds losses{0};               // of a store, or of what is in it, silently
  Milliseconds leaves{0};               // a worker is asked to stop, another comes
  Milliseconds coordinator_crashes{0};  // at any event
  Milliseconds journal_crashes{0};      // of the coordinator, in a write of its journal
  bool power_fails = false;             // with the coordinator, what was not synced is lost
};

// A few kinds of faults, more or less of each.
[[nodiscard]] FaultPlan PlanFaults(test::Random& random);

}  // namespace depthfarm::simulation

#endif  // DEPTHFARM_TESTS_SIMULATION_FAULT_PLAN_H_
