// depthfarm-simulation: runs farms that never were, one for each seed, and says what went wrong.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

#include "common/log/log.h"
#include "tests/simulation/random_run.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace simulation = depthfarm::simulation;

struct Arguments {
  std::uint64_t first = 1;
  std::uint64_t seeds = 1000;
  std::uint64_t attempts = 0;
  std::string log = "off";
  bool until_failure = false;
  bool traces = false;
  bool narrates = false;
};

void Print(const simulation::Tally& tally) {
  std::printf("runs                  %llu\n", static_cast<unsigned long long>(tally.runs));
  const auto line = [](const char* what, std::uint64_t count) {
    std::printf("%-22s%llu\n", what, static_cast<unsigned long long>(count));
  };
  std::printf("hours of farm time    %.0f\n", tally.hours);
  std::printf("longest end, minutes  %.0f\n", tally.longest_end);
  line("task attempts", tally.attempts);
  line("messages", tally.messages);
  line("  lost", tally.messages_lost);
  line("late results", tally.late_results);
  line("tasks asked back", tally.asked_back);
  line("  given back", tally.given_back);
  line("tasks duplicated", tally.duplicates);
  line("  with success", tally.duplicates_won);
  line("worker crashes", tally.worker_crashes);
  line("deaths told", tally.deaths_told);
  line("standstills", tally.standstills);
  line("network cuts", tally.cuts);
  line("stores lost", tally.store_losses);
  line("coordinator crashes", tally.coordinator_crashes);
  line("  in a journal write", tally.torn_writes);
  line("jobs done", tally.jobs_done);
  line("jobs ended otherwise", tally.jobs_ended_otherwise);
}

// The number of seeds that failed.
int Run(const Arguments& arguments) {
  const std::filesystem::path memory = "/dev/shm";  // the output folders are small and many
  const depthfarm::testing_support::TemporaryFolder scratch(
      std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path());
  simulation::Tally tally;
  int failed = 0;
  const auto go_on = [&](std::uint64_t seed) {
    return arguments.attempts > 0 ? tally.attempts < arguments.attempts : seed < arguments.first + arguments.seeds;
  };
  for (std::uint64_t seed = arguments.first; go_on(seed); ++seed) {
    const simulation::RunResult result = simulation::RunSeed(seed, scratch.path().string(), arguments.narrates);
    tally.Add(result.tally);
    for (const std::string& problem : result.problems) std::printf("%s\n", problem.c_str());
    if (arguments.traces) {
      std::printf("seed %llu trace %016llx\n", static_cast<unsigned long long>(seed),
                  static_cast<unsigned long long>(result.trace));
    }
    failed += result.problems.empty() ? 0 : 1;
    std::fflush(stdout);
    if (arguments.until_failure && failed > 0) break;
  }
  Print(tally);
  std::printf("seeds that failed     %d\n", failed);
  return failed;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Simulates farms with faults: real coordinator, journal and worker lifecycle on a virtual clock.",
               "depthfarm-simulation");
  app.add_option("--first", arguments.first, "the first seed")->capture_default_str();
  app.add_option("--seeds", arguments.seeds, "how many seeds")->capture_default_str();
  app.add_option("--attempts", arguments.attempts, "instead: seeds until so many attempts of tasks were simulated");
  app.add_option("--log-level", arguments.log, "of the coordinator, to stderr")->capture_default_str();
  app.add_flag("--until-failure", arguments.until_failure, "end with the first seed that fails; well if there is one");
  app.add_flag("--traces", arguments.traces, "also a digest of all that was sent, for each seed");
  app.add_flag("--narrate", arguments.narrates, "also every message and fault, to stderr");
  CLI11_PARSE(app, argc, argv);
  if (!depthfarm::SetLogLevel(arguments.log).ok()) return 2;
  try {
    return (Run(arguments) > 0) == arguments.until_failure ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "depthfarm-simulation: %s\n", error.what());
    return 1;
  }
}
