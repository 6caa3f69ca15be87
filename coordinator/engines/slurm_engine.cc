#include "coordinator/engines/slurm_engine.h"

#include <algorithm>
#include <chrono>
#include <string_view>

#include "coordinator/engines/command.h"

namespace depthfarm {
namespace {

constexpr std::chrono::seconds kCommandLimit{60};  // a busy controller may take its time
constexpr int kMostOfAnArray = 500;                // Slurm's usual MaxArraySize is 1001
constexpr std::size_t kMostIds = 500;              // for one command line

}  // namespace

Result<std::string> SlurmEngine::Slurm(const std::vector<std::string>& words, std::string_view input) const {
  DEPTHFARM_ASSIGN_OR_RETURN(CommandOutput result,
                             RunCommand(words, input, {.usual = kCommandLimit, .in_hurry = in_hurry_}));
  if (result.exit_code == 0) return std::move(result.output);
  std::string reason = result.error.substr(0, result.error.find_last_not_of('\n') + 1);
  if (reason.empty()) reason = "exit code " + std::to_string(result.exit_code);
  return Unavailable(words[0] + ": " + reason);
}

Result<std::unique_ptr<SlurmEngine>> SlurmEngine::Open(SlurmOptions options, PilotSpec spec, std::string job_name,
                                                       InHurry in_hurry) {
  if (!options.time.empty()) DEPTHFARM_RETURN_IF_ERROR(ParseSlurmTime(options.time).status().WithContext("--time"));
  std::unique_ptr<SlurmEngine> engine(
      new SlurmEngine(std::move(options), std::move(spec), std::move(job_name), std::move(in_hurry)));
  // Rather now than at the first job: a partition that does not exist, more memory than any node has.
  DEPTHFARM_RETURN_IF_ERROR(engine->Submit(1, {"--test-only"}));
  return engine;
}

Status SlurmEngine::Submit(int count, const std::vector<std::string>& more) const {
  std::vector<std::string> words = {"sbatch"};
  for (std::string& word : SlurmArrayArguments(count)) words.push_back(std::move(word));
  words.insert(words.end(), more.begin(), more.end());
  return Slurm(words, SlurmScript(options_, spec_, job_name_)).status();
}

Status SlurmEngine::Launch(int count) {
  for (int left = count; left > 0; left -= kMostOfAnArray) {
    DEPTHFARM_RETURN_IF_ERROR(Submit(std::min(left, kMostOfAnArray), {}));
  }
  return {};
}

Result<std::vector<Pilot>> SlurmEngine::List() {
  std::vector<std::string> words = {"squeue"};
  for (std::string& word : SqueueArguments(job_name_)) words.push_back(std::move(word));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string answer, Slurm(words));
  return ParseSqueue(answer);
}

Status SlurmEngine::Cancel(const std::vector<std::string>& ids) {
  for (std::size_t done = 0; done < ids.size(); done += kMostIds) {
    // --quiet: that a job has ended meanwhile is no error.
    std::vector<std::string> words = {"scancel", "--quiet"};
    const std::size_t end = std::min(ids.size(), done + kMostIds);
    words.insert(words.end(), ids.begin() + static_cast<std::ptrdiff_t>(done),
                 ids.begin() + static_cast<std::ptrdiff_t>(end));
    DEPTHFARM_RETURN_IF_ERROR(Slurm(words).status());
  }
  return {};
}

}  // namespace depthfarm
