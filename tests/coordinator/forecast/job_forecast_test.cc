#include "coordinator/forecast/job_forecast.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "coordinator/forecast/task_graph.h"
#include "tests/coordinator/forecast/sized_job.h"

namespace depthfarm {
namespace {

ResolvedJob Resolved(const JobShape& shape) { return MakeSizedJob(shape).config.resolved; }

TEST(Forecast, StagesAreTheSumsOfAllTasks) {
  for (const JobShape& shape :
       {JobShape{.frames = 1, .gop = 10, .blocks_i = 3}, JobShape{.frames = 7, .gop = 3, .views = 3, .refine = 2},
        JobShape{.frames = 8, .gop = 3, .refine = 1, .confidence = true},
        JobShape{.frames = 9, .gop = 4, .blocks_p = 2}, JobShape{.frames = 5, .gop = 1},
        JobShape{.frames = 6, .gop = 2}, JobShape{.frames = 6, .gop = 100},
        JobShape{.frames = 7, .gop = 1, .anchor = Anchor::kShared},
        JobShape{.frames = 9, .gop = 2, .refine = 3, .anchor = Anchor::kShared},
        JobShape{.frames = 11, .gop = 4, .refine = 3, .anchor = Anchor::kShared}}) {
    const JobPlan plan(MakeSizedJob(shape));
    const CostModel model(plan.resolved());
    const TaskGraph graph(plan, model);
    for (const StageForecast& stage : Forecast(plan.resolved()).stages) {
      StageForecast sum;
      for (TaskGraph::Index index = 0; index < graph.size(); ++index) {
        if (graph.task(index).kind != stage.kind) continue;
        ++sum.tasks;
        sum.seconds += graph.cost(index).seconds;
        sum.longest_seconds = std::max(sum.longest_seconds, graph.cost(index).seconds);
        sum.peak_memory_bytes = std::max(sum.peak_memory_bytes, graph.cost(index).peak_memory_bytes);
        sum.result_bytes += graph.cost(index).result_bytes;
        sum.read_bytes += graph.BytesRead(index);
      }
      const std::string name = TaskKindName(stage.kind) + " of " + std::to_string(shape.frames) + " frames";
      EXPECT_EQ(stage.tasks, sum.tasks) << name;
      EXPECT_EQ(stage.tasks, plan.Total(stage.kind)) << name;
      EXPECT_NEAR(stage.seconds, sum.seconds, 1e-9) << name;
      EXPECT_EQ(stage.longest_seconds, sum.longest_seconds) << name;
      EXPECT_EQ(stage.peak_memory_bytes, sum.peak_memory_bytes) << name;
      EXPECT_EQ(stage.result_bytes, sum.result_bytes) << name;
      EXPECT_EQ(stage.read_bytes, sum.read_bytes) << name;
    }
  }
}

TEST(Forecast, GoesOnUntilMoreWorkersDoNotHelp) {
  const JobForecast forecast = Forecast(Resolved({.frames = 12, .gop = 3, .views = 3, .refine = 2}));
  ASSERT_GT(forecast.farms.size(), 2U);
  for (std::size_t i = 0; i < forecast.farms.size(); ++i) {
    EXPECT_EQ(forecast.farms[i].workers, 1 << i);
    EXPECT_GE(forecast.farms[i].wall_seconds, forecast.critical_seconds);
    if (i > 0) {
      EXPECT_LT(forecast.farms[i].wall_seconds, forecast.farms[i - 1].wall_seconds);
    }
  }
  EXPECT_TRUE(forecast.more_do_not_help);
  EXPECT_FALSE(forecast.extrapolated());
}

TEST(Forecast, OfOneFarmWhenItIsNamed) {
  const JobForecast forecast = Forecast(Resolved({.frames = 2}), {.workers = 5});
  ASSERT_EQ(forecast.farms.size(), 1U);
  EXPECT_EQ(forecast.farms[0].workers, 5);
  EXPECT_FALSE(forecast.more_do_not_help);
}

// What is played in part comes close to what is played as a whole.
TEST(Forecast, ExtrapolatesLongJobs) {
  for (const JobShape& shape : {JobShape{.frames = 400, .gop = 5, .refine = 2},
                                JobShape{.frames = 400, .gop = 5, .refine = 2, .anchor = Anchor::kShared},
                                JobShape{.frames = 300, .gop = 1000, .refine = 2}}) {
    const ResolvedJob job = Resolved(shape);
    const bool shared = shape.anchor == Anchor::kShared;
    for (const auto& [workers, most_tasks] : {std::pair(1, 600), {3, 600}, {8, 600}, {7, 3000}, {100, 3000}}) {
      const JobForecast whole = Forecast(job, {.workers = workers});
      const JobForecast part =
          Forecast(job, {.workers = workers, .most_tasks = static_cast<std::uint64_t>(most_tasks)});
      ASSERT_FALSE(whole.extrapolated());
      ASSERT_TRUE(part.extrapolated());
      EXPECT_EQ(part.played_frames % std::min(shape.gop, part.played_frames), 0);
      EXPECT_NEAR(part.farms[0].wall_seconds / whole.farms[0].wall_seconds, 1, shared ? 0.08 : 0.05) << workers;
      EXPECT_NEAR(part.farms[0].cpu_seconds / whole.farms[0].cpu_seconds, 1, 0.03) << workers;
      EXPECT_NEAR(part.critical_seconds / whole.critical_seconds, 1, 0.03) << workers;
      if (shared) continue;  // how workers share the last GOPs, which end at different times, decides
      const auto moved = static_cast<double>(whole.farms[0].moved_bytes);
      EXPECT_NEAR(static_cast<double>(part.farms[0].moved_bytes), moved, 0.15 * moved) << workers;
    }
  }
}

TEST(Forecast, AFrameOfMoreTasksThanAreWantedIsPlayedAllTheSame) {
  const JobForecast one = Forecast(Resolved({.frames = 1, .blocks_i = 40}), {.workers = 2, .most_tasks = 10});
  EXPECT_FALSE(one.extrapolated());
  const JobForecast five = Forecast(Resolved({.frames = 5, .blocks_i = 40}), {.workers = 2, .most_tasks = 10});
  EXPECT_EQ(five.played_frames, 2);
}

}  // namespace
}  // namespace depthfarm
