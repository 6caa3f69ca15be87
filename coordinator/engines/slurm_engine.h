#ifndef DEPTHFARM_COORDINATOR_ENGINES_SLURM_ENGINE_H_
#define DEPTHFARM_COORDINATOR_ENGINES_SLURM_ENGINE_H_

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "coordinator/engines/command.h"
#include "coordinator/engines/engine.h"
#include "coordinator/engines/slurm_text.h"

namespace depthfarm {

// Workers as tasks of Slurm job arrays, by sbatch, squeue and scancel of the user's PATH.
class SlurmEngine : public Engine {
 public:
  // kInvalidArgument: the time limit is none. kUnavailable: Slurm's commands are not there, its controller does not
  // answer, or it would not take such workers; the message is Slurm's. Commands that hang end early in a hurry.
  [[nodiscard]] static Result<std::unique_ptr<SlurmEngine>> Open(SlurmOptions options, PilotSpec spec,
                                                                 std::string job_name, InHurry in_hurry = {});
  [[nodiscard]] Status Launch(int count) override;
  [[nodiscard]] Result<std::vector<Pilot>> List() override;
  [[nodiscard]] Status Cancel(const std::vector<std::string>& ids) override;

 private:
  SlurmEngine(SlurmOptions options, PilotSpec spec, std::string job_name, InHurry in_hurry)
      : options_(std::move(options)),
        spec_(std::move(spec)),
        job_name_(std::move(job_name)),
        in_hurry_(std::move(in_hurry)) {}
  // Runs one of Slurm's commands and returns what it printed.
  [[nodiscard]] Result<std::string> Slurm(const std::vector<std::string>& words, std::string_view input = {}) const;
  // An array of `count`, with these words more for sbatch.
  [[nodiscard]] Status Submit(int count, const std::vector<std::string>& more) const;

  SlurmOptions options_;
  PilotSpec spec_;
  std::string job_name_;
  InHurry in_hurry_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COORDINATOR_ENGINES_SLURM_ENGINE_H_
