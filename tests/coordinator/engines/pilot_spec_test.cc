#include "coordinator/engines/pilot_spec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace depthfarm {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::Not;

// All of these words, in whatever order.
auto Holds(std::vector<std::string> words) { return testing::IsSupersetOf(std::move(words)); }

TEST(WorkerArguments, SayWhatWasAsked) {
  EXPECT_THAT(
      WorkerArguments({.coordinator = "tcp://head:7700", .slots = 2, .threads = 3, .give_up_seconds = 60}),
      ElementsAre("--coordinator", "tcp://head:7700", "--slots", "2", "--threads", "3", "--give-up-seconds", "60"));
  const auto words = WorkerArguments({.coordinator = "tcp://head:7700",
                                      .keys_dir = "/shared/keys",
                                      .cache_dir = "/var/tmp/cache",
                                      .cache_size = "20GB",
                                      .tags = {"fast", "room2"},
                                      .path_map = {"/a=/b", "/c=/d"},
                                      .stop_grace_seconds = 90});
  EXPECT_THAT(words, Holds({"--keys", "/shared/keys", "--cache-dir", "/var/tmp/cache", "--cache-size", "20GB", "--tags",
                            "fast,room2", "--path-map", "/a=/b", "/c=/d", "--stop-grace", "90"}));
  EXPECT_THAT(words, Not(Contains("--insecure")));
  EXPECT_THAT(words, Not(Contains("--task-memory")));
}

TEST(WorkerArguments, MemoryIsForTasksAndAQuarterAtMostForDecodedArtifacts) {
  const auto words = WorkerArguments({.memory_bytes = std::uint64_t{4} << 30});
  EXPECT_THAT(words, Holds({"--memory", std::to_string(std::uint64_t{1} << 30), "--task-memory",
                            std::to_string(std::uint64_t{3} << 30)}));
  EXPECT_THAT(WorkerArguments({.memory_bytes = std::uint64_t{64} << 30}),
              Contains(std::to_string(std::uint64_t{2} << 30)));
}

TEST(WorkerName, TellsItsPilotAndNobodyElses) {
  EXPECT_EQ(WorkerName("render-1x2", "4711_3", "0"), "render-1x2.4711_3.0");
  EXPECT_EQ(PilotOfWorker("render-1x2", "render-1x2.4711_3.0"), "4711_3");
  EXPECT_EQ(PilotOfWorker("render-1x2", "render-1x2.4711_3.12"), "4711_3");
  for (const char* other : {"host:4711:93", "render-1x2", "render-1x2.", "render-1x2.4711", "render-1x23.4711_3.0",
                            "render-1.4711_3.0", "render-1x2..0", ""}) {
    EXPECT_EQ(PilotOfWorker("render-1x2", other), std::nullopt) << other;
  }
}

}  // namespace
}  // namespace depthfarm
