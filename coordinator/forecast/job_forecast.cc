#include "coordinator/forecast/job_forecast.h"

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

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

// From half of the frames that are played to all of them, in steps of whole GOPs if there are two.
std::vector<int> LengthsToPlay(const ResolvedJob& job, int frames) {
  constexpr int kMostLengths = 4;
  const int unit = frames / 2 >= job.params.gop ? job.params.gop : 1;
  const int steps = std::clamp((frames - frames / 2) / unit, 1, kMostLengths - 1);
  std::vector<int> lengths;
  for (int step = steps; step >= 0; --step) {
    const int less = frames / 2 * step / steps;
    lengths.push_back(std::max(1, frames - (less + unit - 1) / unit * unit));
  }
  lengths.erase(std::unique(lengths.begin(), lengths.end()), lengths.end());
  return lengths;
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

// Plays the first frames of a job through, of a longer job some lengths of them, and goes on at their pace.
class Extrapolation {
 public:
  Extrapolation(const ResolvedJob& job, int played_frames) : job_(job), played_frames_(played_frames) {
    if (played_frames < job.num_frames) lengths_ = LengthsToPlay(job, played_frames);
    if (lengths_.empty()) lengths_ = {played_frames};
    for (const int frames : lengths_) parts_.push_back(std::make_unique<Part>(job, frames));
  }

  [[nodiscard]] const TaskGraph& graph() const { return parts_.back()->graph; }

  [[nodiscard]] FarmForecast On(int workers) const {
    std::vector<double> wall;
    std::vector<double> cpu;
    std::vector<double> moved;
    for (const auto& part : parts_) {
      const ListSchedule played = PlayThrough(part->graph, workers);
      wall.push_back(played.wall_seconds);
      cpu.push_back(played.cpu_seconds);
      moved.push_back(static_cast<double>(played.moved_bytes));
    }
    FarmForecast farm;
    farm.workers = workers;
    farm.cpu_seconds = GoOn(cpu, job_.num_frames);
    farm.moved_bytes = static_cast<std::uint64_t>(std::max(0.0, GoOn(moved, job_.num_frames)));
    // The first frames may not have kept all workers busy, so that the pace seems better than it can be.
    farm.wall_seconds = GoOn(wall, job_.num_frames);
    if (parts_.size() > 1) farm.wall_seconds = std::max(farm.wall_seconds, farm.cpu_seconds / workers);
    return farm;
  }

  // Of the critical path. GOPs do not wait for each other: more of them make no chain longer.
  [[nodiscard]] double LeastSeconds(const CriticalPath& of_played) const {
    const int gop_frames = std::min(job_.params.gop, job_.num_frames);
    if (parts_.size() == 1 || played_frames_ >= gop_frames) return of_played.seconds;
    std::vector<double> seconds;
    for (const auto& part : parts_) seconds.push_back(FindCriticalPath(part->graph).seconds);
    return GoOn(seconds, gop_frames);
  }

 private:
  // What a figure of each length is for `frames`: on the straight line nearest to them (least squares), since single
  // lengths end with workers that idle for more or less long.
  [[nodiscard]] double GoOn(const std::vector<double>& figures, int frames) const {
    if (figures.size() == 1) return figures.front();
    const auto count = static_cast<double>(figures.size());
    const double mean_length = std::accumulate(lengths_.begin(), lengths_.end(), 0.0) / count;
    const double mean = std::accumulate(figures.begin(), figures.end(), 0.0) / count;
    double products = 0;
    double squares = 0;
    for (std::size_t i = 0; i < figures.size(); ++i) {
      const double from_mean = lengths_[i] - mean_length;
      products += from_mean * (figures[i] - mean);
      squares += from_mean * from_mean;
    }
    return mean + products / squares * (frames - mean_length);
  }

  const ResolvedJob& job_;
  const int played_frames_;
  std::vector<int> lengths_;                  // ascending, the last one played_frames
  std::vector<std::unique_ptr<Part>> parts_;  // of each
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
