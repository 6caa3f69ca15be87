#include "coordinator/forecast/job_forecast.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "coordinator/forecast/critical_path.h"
#include "coordinator/forecast/list_schedule.h"
#include "coordinator/forecast/task_graph.h"
#include "coordinator/planning/cost_model.h"
#include "coordinator/planning/job_plan.h"

namespace depthfarm {
namespace {

constexpr int kMostWorkers = 1024;
constexpr double kLeastGain = 0.05;  // of a doubling of workers

// The first frames of a job, and their tasks.
struct Part {
  Part(const ResolvedJob& job, int frames) : plan(PlanOf(job, frames)), model(plan.resolved()), graph(plan, model) {}
  Part(const Part&) = delete;  // the model looks into the plan
  Part& operator=(const Part&) = delete;
  ~Part() = default;

  static JobPlan PlanOf(const ResolvedJob& job, int frames) {
    PlannedJob planned;
    planned.config.job = JobId(1);
    planned.config.resolved = job;
    planned.config.resolved.num_frames = frames;
    return JobPlan(std::move(planned));
  }

  JobPlan plan;
  CostModel model;
  TaskGraph graph;
};

std::uint64_t NumTasks(const JobPlan& plan) {
  std::uint64_t tasks = 0;
  for (int kind = 0; kind < kNumTaskKinds; ++kind) tasks += plan.Total(static_cast<TaskKind>(kind));
  return tasks;
}

// As many frames as have at most so many tasks, whole GOPs if one fits; at least two, so that there is a half.
int FramesToPlay(const ResolvedJob& job, std::uint64_t most_tasks) {
  const std::uint64_t tasks = NumTasks(Part::PlanOf(job, job.num_frames));
  if (tasks <= most_tasks) return job.num_frames;
  const std::uint64_t tasks_of_frame = std::max<std::uint64_t>(1, tasks / static_cast<std::uint64_t>(job.num_frames));
  const auto fit = static_cast<int>(std::min<std::uint64_t>(most_tasks / tasks_of_frame, job.num_frames));
  const int whole = fit - fit % job.params.gop;
  return std::min(job.num_frames, std::max({2, whole > 0 ? whole : fit}));
}

// Half of the frames that are played, whole GOPs if there are two.
int HalfOf(const ResolvedJob& job, int frames) {
  const int half = frames / 2;
  const int whole = half - half % job.params.gop;
  return std::max(1, whole > 0 ? whole : half);
}

// Exact sums: I frames are alike, and so are P frames, but for the first one of a GOP, which finds the I frame and the
// frame before it in one.
std::vector<StageForecast> Stages(const ResolvedJob& job) {
  std::array<StageForecast, kNumTaskKinds> stages;
  const auto add = [&](TaskKind kind, const TaskCost& cost, std::uint64_t read, std::uint64_t times) {
    StageForecast& stage = stages[static_cast<std::size_t>(kind)];
    if (times == 0) return;
    stage.tasks += times;
    stage.seconds += cost.seconds * static_cast<double>(times);
    stage.longest_seconds = std::max(stage.longest_seconds, cost.seconds);
    stage.peak_memory_bytes = std::max(stage.peak_memory_bytes, cost.peak_memory_bytes);
    stage.result_bytes += cost.result_bytes * times;
    stage.read_bytes += read * times;
  };
  const int gop = job.params.gop;
  const Part sample(job, std::min({3, gop, job.num_frames}));
  const auto frames = static_cast<std::uint64_t>(job.num_frames);
  const auto i_frames = static_cast<std::uint64_t>((job.num_frames + gop - 1) / gop);
  const std::uint64_t last_alone = job.num_frames % gop == 1 ? 1 : 0;
  const std::uint64_t first_p_frames = gop == 1 ? 0 : i_frames - last_alone;
  const std::array<std::uint64_t, 3> times = {i_frames, first_p_frames, frames - i_frames - first_p_frames};
  const TaskGraph& graph = sample.graph;
  for (TaskGraph::Index index = 0; index + 1 < graph.size(); ++index) {
    const TaskId& id = graph.task(index);
    const std::uint64_t of_frame = times[static_cast<std::size_t>(id.frame)];
    add(id.kind, graph.cost(index), graph.BytesRead(index), id.kind == TaskKind::kPrepare ? 1 : of_frame);
  }
  add(TaskKind::kManifest, CostModel(job).Of(sample.plan.OfJob(TaskKind::kManifest)), 0, 1);

  std::vector<StageForecast> listed;
  for (int kind = 0; kind < kNumTaskKinds; ++kind) {
    StageForecast& stage = stages[static_cast<std::size_t>(kind)];
    stage.kind = static_cast<TaskKind>(kind);
    if (stage.tasks > 0) listed.push_back(stage);
  }
  return listed;
}

// Plays the first frames of a job through and goes on from there.
class Extrapolation {
 public:
  Extrapolation(const ResolvedJob& job, int played_frames) : job_(job), played_frames_(played_frames) {
    part_.emplace(job, played_frames);
    if (played_frames == job.num_frames) return;
    half_frames_ = HalfOf(job, played_frames);
    half_.emplace(job, half_frames_);
  }

  [[nodiscard]] const TaskGraph& graph() const { return part_->graph; }

  [[nodiscard]] FarmForecast On(int workers) const {
    const ListSchedule all = PlayThrough(part_->graph, workers);
    if (!half_) return {workers, all.wall_seconds, all.cpu_seconds, all.moved_bytes};
    const ListSchedule some = PlayThrough(half_->graph, workers);
    const auto go_on = [&](auto some_figure, auto all_figure) {
      return GoOn(static_cast<double>(some_figure), static_cast<double>(all_figure), job_.num_frames);
    };
    FarmForecast farm;
    farm.workers = workers;
    farm.cpu_seconds = go_on(some.cpu_seconds, all.cpu_seconds);
    farm.moved_bytes = static_cast<std::uint64_t>(std::max(0.0, go_on(some.moved_bytes, all.moved_bytes)));
    // Half of the frames may not have kept all workers busy, so that the pace seems better than it can be.
    farm.wall_seconds = std::max(go_on(some.wall_seconds, all.wall_seconds), farm.cpu_seconds / workers);
    return farm;
  }

  // Of the critical path. GOPs do not wait for each other: more of them make no chain longer.
  [[nodiscard]] double LeastSeconds(const CriticalPath& of_part) const {
    const int gop_frames = std::min(job_.params.gop, job_.num_frames);
    if (!half_ || played_frames_ >= gop_frames) return of_part.seconds;
    return GoOn(FindCriticalPath(half_->graph).seconds, of_part.seconds, gop_frames);
  }

 private:
  // A figure of half the frames and of all that were played, at the pace between them up to `frames`.
  [[nodiscard]] double GoOn(double of_half, double of_played, int frames) const {
    return of_played + (of_played - of_half) / (played_frames_ - half_frames_) * (frames - played_frames_);
  }

  const ResolvedJob& job_;
  const int played_frames_;
  int half_frames_ = 0;
  std::optional<Part> part_;
  std::optional<Part> half_;  // none when all frames were played
};

}  // namespace

JobForecast Forecast(const ResolvedJob& job, const ForecastOptions& options) {
  JobForecast forecast;
  forecast.stages = Stages(job);
  forecast.frames = job.num_frames;
  forecast.played_frames = FramesToPlay(job, options.most_tasks);
  const Extrapolation extrapolation(job, forecast.played_frames);

  const CriticalPath path = FindCriticalPath(extrapolation.graph());
  for (const TaskGraph::Index index : path.tasks) forecast.critical_path.push_back(extrapolation.graph().task(index));
  forecast.critical_seconds = extrapolation.LeastSeconds(path);

  if (options.workers > 0) {
    forecast.farms.push_back(extrapolation.On(options.workers));
    return forecast;
  }
  for (int workers = 1; workers <= kMostWorkers; workers *= 2) {
    const FarmForecast farm = extrapolation.On(workers);
    forecast.more_do_not_help =
        !forecast.farms.empty() && farm.wall_seconds > forecast.farms.back().wall_seconds * (1 - kLeastGain);
    if (forecast.more_do_not_help) break;
    forecast.farms.push_back(farm);
  }
  return forecast;
}

}  // namespace depthfarm
