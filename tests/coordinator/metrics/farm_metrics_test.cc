#include "coordinator/metrics/farm_metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <sstream>

namespace depthfarm {
namespace {

using testing::HasSubstr;

FarmMetrics Busy() {
  FarmMetrics metrics;
  metrics.version = "1.2.3";
  metrics.algorithm_version = 9;
  metrics.protocol_version = 8;
  metrics.jobs_running = 2;
  metrics.jobs_ended = {{"done", 7}, {"failed", 1}};
  metrics.tasks_leased = 3;
  metrics.tasks_ready = 40;
  metrics.gops_unopened = 500;
  metrics.workers = 4;
  metrics.slots = 16;
  metrics.artifact_bytes = std::uint64_t{5} << 40;
  metrics.attempts = {{{"analyse", "done"}, 100}, {{"analyse", "failed"}, 1}, {{"merge", "done"}, 5}};
  metrics.cpu_seconds = {{"analyse", 12.25}};
  metrics.late_results = 6;
  metrics.refused = {{"message of a wrong role", 3}};
  return metrics;
}

TEST(FormatMetrics, TellsWhatThereIs) {
  const std::string text = FormatMetrics(Busy());
  EXPECT_THAT(text, HasSubstr("depthfarm_info{version=\"1.2.3\",algorithm=\"9\",protocol=\"8\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("\ndepthfarm_jobs_running 2\n"));
  EXPECT_THAT(text, HasSubstr("\ndepthfarm_jobs_ended_total{state=\"done\"} 7\n"));
  EXPECT_THAT(text, HasSubstr("\ndepthfarm_wanted_slots 543\n"));
  EXPECT_THAT(text, HasSubstr("\ndepthfarm_slots 16\n"));
  EXPECT_THAT(text, HasSubstr("\ndepthfarm_artifact_bytes 5497558138880\n"));
  EXPECT_THAT(text, HasSubstr("\ndepthfarm_attempts_total{kind=\"analyse\",outcome=\"failed\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("\ndepthfarm_task_cpu_seconds_total{kind=\"analyse\"} 12.25\n"));
  EXPECT_THAT(text, HasSubstr("\ndepthfarm_refused_total{what=\"message of a wrong role\"} 3\n"));
}

// A scraper refuses a page in which a name has two types or comes in two places.
TEST(FormatMetrics, EachNameIsDescribedOnce) {
  std::istringstream lines(FormatMetrics(Busy()));
  std::set<std::string> described;
  std::string current;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("# TYPE ")) {
      current = line.substr(7, line.find(' ', 7) - 7);
      EXPECT_TRUE(described.insert(current).second) << current;
    } else if (!line.starts_with("#")) {
      EXPECT_EQ(line.substr(0, line.find_first_of("{ ")), current);
    }
  }
  EXPECT_GE(described.size(), 14U);
}

}  // namespace
}  // namespace depthfarm
