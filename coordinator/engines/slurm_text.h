#ifndef DEPTHFARM_COORDINATOR_ENGINES_SLURM_TEXT_H_
#define DEPTHFARM_COORDINATOR_ENGINES_SLURM_TEXT_H_

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/status.h"
#include "coordinator/engines/engine.h"
#include "coordinator/engines/pilot_spec.h"

namespace depthfarm {

// How workers are asked for.
struct SlurmOptions {
  std::string partition = {};               // empty: Slurm's default
  std::string time = {};                    // as sbatch takes it, "4:00:00"; empty: the partition's
  std::string account = {};                 // empty: the user's
  std::string qos = {};                     // empty: the user's
  std::vector<std::string> arguments = {};  // more of sbatch's, "--constraint=avx2"
  std::string log_dir = {};                 // that the nodes see; empty: no logs of workers
};

// Seconds of a time limit as sbatch takes it: "MM", "MM:SS", "HH:MM:SS", "D-HH", "D-HH:MM", "D-HH:MM:SS". Nothing for
// "UNLIMITED" and the like; kInvalidArgument: it is no time.
[[nodiscard]] Result<std::optional<int>> ParseSlurmTime(std::string_view text);

// How long before its time limit a worker is told to leave: two minutes, less of a short limit.
[[nodiscard]] int NoticeSeconds(std::string_view time);

// What Slurm is given on sbatch's stdin. `job_name` names the jobs of one cluster. The worker takes the place of the
// shell, so that Slurm's signals reach it: at preemption, at scancel, and NoticeSeconds before the time limit.
[[nodiscard]] std::string SlurmScript(const SlurmOptions& options, const PilotSpec& spec, const std::string& job_name);

// sbatch's words for an array of `count` workers, after the program's name.
[[nodiscard]] std::vector<std::string> SlurmArrayArguments(int count);

// The words after squeue for the pilots of a cluster, and what its answer says.
[[nodiscard]] std::vector<std::string> SqueueArguments(const std::string& job_name);
// kCorrupt: a line is none of those that SqueueArguments asks for.
[[nodiscard]] Result<std::vector<Pilot>> ParseSqueue(std::string_view answer);

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_ENGINES_SLURM_TEXT_H_
