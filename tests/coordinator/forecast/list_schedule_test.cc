#include "coordinator/forecast/list_schedule.h"

#include <gtest/gtest.h>

#include "coordinator/forecast/critical_path.h"
#include "tests/coordinator/forecast/sized_job.h"

namespace depthfarm {
namespace {

struct Planned {
  explicit Planned(const JobShape& shape) : plan(MakeSizedJob(shape)), model(plan.resolved()), graph(plan, model) {}
  [[nodiscard]] double Seconds() const {
    double seconds = 0;
    for (TaskGraph::Index index = 0; index < graph.size(); ++index) seconds += graph.cost(index).seconds;
    return seconds;
  }
  JobPlan plan;
  CostModel model;
  TaskGraph graph;
};

TEST(ListSchedule, OneWorkerDoesOneTaskAfterTheOtherAndFetchesNothing) {
  const Planned job({.frames = 4, .gop = 2, .views = 3, .blocks_i = 2, .refine = 2});
  const ListSchedule alone = PlayThrough(job.graph, 1);
  EXPECT_NEAR(alone.cpu_seconds, job.Seconds(), 1e-9);
  EXPECT_NEAR(alone.wall_seconds, job.Seconds() + kGrantSeconds * static_cast<double>(job.graph.size()), 1e-9);
  EXPECT_EQ(alone.moved_bytes, 0U);
}

TEST(ListSchedule, IsBetweenTheBoundsOfAnySchedule) {
  const Planned job({.frames = 9, .gop = 3, .views = 4, .blocks_i = 3, .refine = 2, .confidence = true});
  const double longest = FindCriticalPath(job.graph).seconds;
  const double alone = PlayThrough(job.graph, 1).wall_seconds;
  for (const int workers : {2, 3, 7, 64, 100}) {
    const ListSchedule schedule = PlayThrough(job.graph, workers);
    EXPECT_GE(schedule.wall_seconds, longest) << workers;
    EXPECT_GE(schedule.wall_seconds * workers, schedule.cpu_seconds) << workers;
    EXPECT_LT(schedule.wall_seconds, alone) << workers;
    // Three GOPs on three workers: each has one, and nothing moves.
    EXPECT_EQ(schedule.moved_bytes == 0, workers == 3) << workers;
    std::uint64_t read = 0;
    for (TaskGraph::Index index = 0; index < job.graph.size(); ++index) read += job.graph.BytesRead(index);
    EXPECT_LE(schedule.moved_bytes, read) << workers;
    EXPECT_NEAR(schedule.cpu_seconds, job.Seconds() + CostModel::SecondsToRead(schedule.moved_bytes), 1e-6) << workers;
  }
}

TEST(ListSchedule, IsTheSameEveryTime) {
  const Planned job({.frames = 6, .gop = 2, .views = 3, .blocks_i = 2, .refine = 1});
  const ListSchedule first = PlayThrough(job.graph, 5);
  const ListSchedule second = PlayThrough(job.graph, 5);
  EXPECT_EQ(first.wall_seconds, second.wall_seconds);
  EXPECT_EQ(first.moved_bytes, second.moved_bytes);
}

TEST(ListSchedule, GopsRunSideBySide) {
  const Planned one({.frames = 4, .gop = 4, .views = 2});
  const Planned eight({.frames = 32, .gop = 4, .views = 2});
  EXPECT_LT(PlayThrough(eight.graph, 16).wall_seconds, 2 * PlayThrough(one.graph, 16).wall_seconds);
}

TEST(ListSchedule, ATaskGoesWhereItsInputsAre) {
  // Two chains that need nothing of each other: two workers exchange nothing.
  const Planned job({.frames = 8, .gop = 4, .views = 2, .refine = 2});
  EXPECT_EQ(PlayThrough(job.graph, 2).moved_bytes, 0U);
  // Three chains on two workers: less than the one that both do is read by the other.
  const Planned three({.frames = 12, .gop = 4, .views = 2, .refine = 2});
  std::uint64_t read = 0;
  for (TaskGraph::Index index = 0; index < three.graph.size(); ++index) read += three.graph.BytesRead(index);
  EXPECT_LT(PlayThrough(three.graph, 2).moved_bytes, read / 6);
}

}  // namespace
}  // namespace depthfarm
