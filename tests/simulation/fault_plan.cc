#include "tests/simulation/fault_plan.h"

namespace depthfarm::simulation {
namespace {

Milliseconds Pause(test::Random& random, int percent) {
  return random.Chance(percent) ? Milliseconds(1000 * random.Int(8, 60)) : Milliseconds(0);
}

}  // namespace

FaultPlan PlanFaults(test::Random& random) {
  FaultPlan plan;
  plan.chaos = Milliseconds(1000 * random.Int(20, 150));
  plan.task_length = random.Chance(50) ? 1 : random.Int(2, 8);  // a few seconds, or more than a lease
  plan.network.longest_delay = Milliseconds(random.Chance(25) ? random.Int(100, 8000) : random.Int(1, 100));
  if (random.Chance(40)) plan.network.lost_percent = random.Int(1, 20);
  if (random.Chance(40)) plan.network.doubled_percent = random.Int(1, 20);
  plan.network.reorders = random.Chance(40);
  if (random.Chance(30)) plan.tasks.fails = random.Int(1, 10);
  if (random.Chance(30)) plan.tasks.disk_is_full = random.Int(1, 10);
  if (random.Chance(20)) plan.tasks.runs_out_of_memory = random.Int(1, 4);
  plan.crashes = Pause(random, 50);
  plan.standstills = Pause(random, 50);
  plan.slowdowns = Pause(random, 30);
  plan.cuts = Pause(random, 50);
  plan.losses = Pause(random, 40);
  plan.leaves = Pause(random, 30);
  plan.coordinator_crashes = Pause(random, 40);
  plan.journal_crashes = Pause(random, 40);
  plan.power_fails = random.Chance(50);
  return plan;
}

}  // namespace depthfarm::simulation
