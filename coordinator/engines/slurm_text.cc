#include "coordinator/engines/slurm_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <limits>

#include "coordinator/engines/command.h"

namespace depthfarm {
namespace {

// Array task and how often it was requeued, as Slurm tells them to the script.
constexpr int kUsualNotice = 120;  // seconds

constexpr const char* kPilotVariable = "${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID}";
constexpr const char* kRestartVariable = "${SLURM_RESTART_COUNT:-0}";

std::vector<std::string> Split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

// Of a pilot that is leaving nothing more is to be expected; one that is requeued or stands still comes back.
enum class PilotState { kWaiting, kRunning, kEnded };
PilotState StateOf(std::string_view word) {
  constexpr auto kRunning = std::to_array<std::string_view>({"RUNNING", "CONFIGURING", "SUSPENDED", "STOPPED"});
  constexpr auto kWaiting =
      std::to_array<std::string_view>({"PENDING", "REQUEUED", "REQUEUE_HOLD", "REQUEUE_FED", "SPECIAL_EXIT"});
  if (std::ranges::find(kRunning, word) != kRunning.end()) return PilotState::kRunning;
  if (std::ranges::find(kWaiting, word) != kWaiting.end()) return PilotState::kWaiting;
  return PilotState::kEnded;  // COMPLETING, COMPLETED, FAILED, TIMEOUT, PREEMPTED, ...
}

}  // namespace

Result<std::optional<int>> ParseSlurmTime(std::string_view text) {
  if (text == "UNLIMITED" || text == "INFINITE") return std::optional<int>();
  const Status wrong = InvalidArgument("time limit is '" + std::string(text) +
                                       "', expected as sbatch takes it: minutes, MM:SS, HH:MM:SS, D-HH, D-HH:MM:SS");
  const std::size_t dash = text.find('-');
  std::vector<int> numbers;  // days, if there is a dash; then what the colons part
  const auto add = [&numbers](std::string_view digits) {
    int value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || value < 0 || value > 1'000'000) return false;
    numbers.push_back(value);
    return true;
  };
  if (dash != std::string_view::npos && !add(text.substr(0, dash))) return wrong;
  const std::vector<std::string> clock = Split(dash == std::string_view::npos ? text : text.substr(dash + 1), ':');
  if (clock.size() > 3) return wrong;
  for (const std::string& part : clock) {
    if (!add(part)) return wrong;
  }
  std::int64_t seconds = 0;
  if (dash != std::string_view::npos) {  // D-H[:M[:S]]
    numbers.resize(4);
    seconds = std::int64_t{numbers[0]} * 86'400 + std::int64_t{numbers[1]} * 3600 + std::int64_t{numbers[2]} * 60 +
              numbers[3];
  } else if (clock.size() == 3) {
    seconds = std::int64_t{numbers[0]} * 3600 + std::int64_t{numbers[1]} * 60 + numbers[2];
  } else {
    numbers.resize(2);  // M[:S]
    seconds = std::int64_t{numbers[0]} * 60 + numbers[1];
  }
  if (seconds <= 0 || seconds > std::numeric_limits<int>::max()) return wrong;
  return std::optional<int>(static_cast<int>(seconds));
}

int NoticeSeconds(std::string_view time) {
  const Result<std::optional<int>> limit = ParseSlurmTime(time);
  if (!limit.ok() || !*limit) return kUsualNotice;  // that of the partition, which may be anything
  return std::clamp(**limit / 4, 1, kUsualNotice);
}

std::string SlurmScript(const SlurmOptions& options, const PilotSpec& spec, const std::string& job_name) {
  std::string script = "#!/bin/sh\n";
  const auto ask = [&script](const std::string& option) { script += "#SBATCH " + option + "\n"; };
  ask("--job-name=" + job_name);
  ask("--ntasks=1");
  ask("--cpus-per-task=" + std::to_string(std::max(spec.slots, spec.threads)));
  if (spec.memory_bytes > 0) ask("--mem=" + std::to_string(spec.memory_bytes >> 20) + "M");
  if (!options.partition.empty()) ask("--partition=" + options.partition);
  if (!options.time.empty()) ask("--time=" + options.time);
  if (!options.account.empty()) ask("--account=" + options.account);
  if (!options.qos.empty()) ask("--qos=" + options.qos);
  ask("--requeue");
  ask("--open-mode=append");
  const int notice = NoticeSeconds(options.time);
  ask("--signal=B:TERM@" + std::to_string(notice));
  ask("--output=" + (options.log_dir.empty() ? "/dev/null" : options.log_dir + "/worker-%A_%a.log"));
  for (const std::string& argument : options.arguments) ask(argument);
  script += "exec " + ShellQuoted(spec.worker_program);
  PilotSpec given_notice = spec;
  given_notice.stop_grace_seconds = notice - notice / 6;  // what is left is for saying goodbye
  for (const std::string& word : WorkerArguments(given_notice)) script += " " + ShellQuoted(word);
  script += " --name \"" + WorkerName(spec.cluster, kPilotVariable, kRestartVariable) + "\"\n";
  return script;
}

std::vector<std::string> SlurmArrayArguments(int count) {
  return {"--parsable", "--array=0-" + std::to_string(count - 1)};
}

std::vector<std::string> SqueueArguments(const std::string& job_name) {
  return {"--me", "--noheader", "--array", "--name=" + job_name, "--format=%i|%T|%N|%r"};
}

Result<std::vector<Pilot>> ParseSqueue(std::string_view answer) {
  std::vector<Pilot> pilots;
  for (const std::string& line : Split(answer, '\n')) {
    if (line.empty()) continue;
    const std::vector<std::string> fields = Split(line, '|');
    if (fields.size() != 4 || fields[0].empty() || fields[1].empty()) {
      return Corrupt("squeue wrote '" + line + "', expected a job's id, state, node and reason");
    }
    const PilotState state = StateOf(fields[1]);
    if (state == PilotState::kEnded) continue;
    const bool running = state == PilotState::kRunning;
    pilots.push_back({fields[0], running, running ? fields[2] : "",
                      fields[1] + (fields[3].empty() || fields[3] == "None" ? "" : " (" + fields[3] + ")")});
  }
  return pilots;
}

}  // namespace depthfarm
