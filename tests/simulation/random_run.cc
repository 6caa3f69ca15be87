#include "tests/simulation/random_run.h"

#include <filesystem>
#include <utility>

namespace depthfarm::simulation {
namespace {

// The first worker takes every job; others lack a tag, or room.
std::vector<WorkerShape> Workers(test::Random& random) {
  std::vector<WorkerShape> workers{{.slots = random.Int(1, 3), .ahead = random.Int(0, 2), .tags = {"ssd"}}};
  for (int more = random.Int(0, 5); more > 0; --more) {
    WorkerShape worker{.slots = random.Int(1, 3), .ahead = random.Int(0, 2)};
    if (random.Chance(30)) worker.store_bound = static_cast<std::size_t>(random.Int(10, 40));
    if (random.Chance(50)) worker.tags = {"ssd"};
    workers.push_back(std::move(worker));
  }
  return workers;
}

Wish AnyWish(test::Random& random, bool patient) {
  Wish wish;
  wish.kind.shape = random.Int(0, kNumShapes - 1);
  wish.kind.pictures = random.Chance(50) ? "a" : "b";
  wish.kind.keeps_results = random.Chance(25);
  if (random.Chance(15)) {  // most has gone wrong in what these two have in common
    wish.kind.shape = kSharedShape;
    wish.kind.keeps_results = true;
  }
  wish.kind.renders = !wish.kind.keeps_results && random.Chance(15);
  if (!patient && random.Chance(6)) wish.kind.sequence = "poison";
  if (random.Chance(4)) wish.kind.sequence = "unreadable";
  if (wish.kind.sequence != "line") wish.kind.pictures = wish.kind.sequence;  // nobody else has made anything of them
  wish.priority = random.Int(0, 1);
  if (random.Chance(25)) wish.tags = {"ssd"};
  if (random.Chance(35)) wish.cancel_after = Milliseconds(random.Int(0, random.Chance(50) ? 10'000 : 60'000));
  wish.retries = random.Chance(50);
  return wish;
}

void RemoveFolders(const SimulatedFarm& farm) {
  for (const auto& [name, submitter] : farm.submitters()) {
    for (const bool renders : {false, true}) std::filesystem::remove_all(submitter->FolderOf({.renders = renders}));
  }
}

constexpr std::uint64_t kFairRuns = 20;     // each of so many seeds
constexpr Milliseconds kLongestTask{8000};  // of a farm without faults, with the fetches before it

// Nothing goes wrong: a job that is submitted behind long ones of its priority starts within one task.
RunResult RunFairly(std::uint64_t seed, SimulatedFarm::Options options) {
  test::Random random(seed);
  options.workers = Workers(random);
  SimulatedFarm farm(random.Next(), options);
  const int rivals = random.Int(1, 3);
  for (int i = 1; i <= rivals; ++i) {
    farm.AddSubmitter("long" + std::to_string(i), {Wish{{kLongShape, "long" + std::to_string(i)}}}, Milliseconds(0));
  }
  const Milliseconds pause(random.Int(10'000, 40'000));
  const TimePoint begin = farm.events().now();
  farm.AddSubmitter("small", {Wish{{random.Int(0, kNumShapes - 1), "small"}}}, pause);
  farm.Run();
  RemoveFolders(farm);
  RunResult result{farm.problems(), farm.trace(), farm.tally()};
  if (result.problems.empty()) {
    const JobId small(farm.submitters().at("small")->ends().front().id);
    const Milliseconds waited = std::chrono::duration_cast<Milliseconds>(farm.first_tasks().at(small) - begin) - pause;
    if (waited > kLongestTask) {
      result.problems.push_back("a small job waited " + std::to_string(waited.count()) + " ms behind long ones");
    }
  }
  return result;
}

}  // namespace

RunResult RunSeed(std::uint64_t seed, const std::string& scratch, bool narrates) {
  test::Random random(seed);
  const bool patient = random.Chance(50);
  SimulatedFarm::Options options;
  options.scratch = scratch;
  options.narrates = narrates;
  options.coordinator.max_attempts = patient ? 100 : random.Int(2, 6);
  options.workers = Workers(random);
  options.faults = PlanFaults(random);
  for (WorkerShape& worker : options.workers) worker.task_length = options.faults.task_length;
  if (seed % kFairRuns == 0) {
    RunResult result = RunFairly(seed, {.scratch = scratch, .coordinator = {}, .workers = {}, .faults = {}});
    for (std::string& problem : result.problems) problem = "seed " + std::to_string(seed) + ": " + problem;
    return result;
  }
  SimulatedFarm farm(random.Next(), options);
  const int submitters = random.Int(1, 4);
  for (int i = 1; i <= submitters; ++i) {
    std::vector<Wish> wishes;
    for (int jobs = random.Int(1, 3); jobs > 0; --jobs) wishes.push_back(AnyWish(random, patient));
    farm.AddSubmitter("s" + std::to_string(i), std::move(wishes), Milliseconds(random.Int(0, 20'000)));
  }
  farm.Run();
  RemoveFolders(farm);
  RunResult result{{}, farm.trace(), farm.tally()};
  for (const std::string& problem : farm.problems())
    result.problems.push_back("seed " + std::to_string(seed) + ": " + problem);
  return result;
}

}  // namespace depthfarm::simulation
