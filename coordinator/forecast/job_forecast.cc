#include "coordinator/forecast/job_forecast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
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

// From half of the frames that are played to all of them.
std::vector<int> LengthsToPlay(int frames) {
  constexpr int kMostLengths = 4;
  const int steps = std::clamp(frames - frames / 2, 1, kMostLengths - 1);
  std::vector<int> lengths;
  for (int step = steps; step >= 0; --step) lengths.push_back(std::max(1, frames - frames / 2 * step / steps));
  lengths.erase(std::unique(lengths.begin(), lengths.end()), lengths.end());
  return lengths;
}

// Exact sums: I frames are alike, and so are P frames, but for those that find the I frame and the frame before in one.
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
  const auto sort_of = [&](int frame) -> std::size_t {
    if (job.IsIFrame(frame)) return 0;
    return job.PreviousOf(frame) == job.IFrameOf(frame) ? 1 : 2;
  };
  std::array<std::uint64_t, 3> times{};
  for (int frame = 0; frame < job.num_frames; ++frame) ++times[sort_of(frame)];
  const Part sample(job, std::min(4, job.num_frames));  // has each sort that the job has
  std::array<int, 3> frame_of{-1, -1, -1};
  for (int frame = sample.plan.resolved().num_frames - 1; frame >= 0; --frame) frame_of[sort_of(frame)] = frame;
  const TaskGraph& graph = sample.graph;
  for (TaskGraph::Index index = 0; index + 1 < graph.size(); ++index) {
    const TaskId& id = graph.task(index);
    if (frame_of[sort_of(id.frame)] != id.frame) continue;
    add(id.kind, graph.cost(index), graph.BytesRead(index),
        id.kind == TaskKind::kPrepare ? 1 : times[sort_of(id.frame)]);
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

struct Figures {
  double wall = 0;
  double cpu = 0;
  double moved = 0;
};

// Plays the first frames of a job through, and goes on at their pace.
class Extrapolation {
 public:
  Extrapolation(const ResolvedJob& job, int played_frames)
      : job_(job), played_frames_(played_frames), whole_gops_(played_frames / job.params.gop) {}

  [[nodiscard]] const TaskGraph& graph() { return PartOf(played_frames_).graph; }

  [[nodiscard]] FarmForecast On(int workers) {
    Figures figures;
    if (played_frames_ == job_.num_frames) {
      figures = Play(played_frames_, workers);
    } else if (whole_gops_ > 0) {
      figures = OfManyGops(workers);
    } else {
      figures = Line(LengthsToPlay(played_frames_), workers, job_.num_frames);
    }
    FarmForecast farm;
    farm.workers = workers;
    farm.cpu_seconds = figures.cpu;
    farm.moved_bytes = static_cast<std::uint64_t>(std::max(0.0, figures.moved));
    farm.wall_seconds = figures.wall;
    // The first frames may not have kept all workers busy, so that the pace seems better than it can be.
    if (played_frames_ < job_.num_frames) farm.wall_seconds = std::max(figures.wall, figures.cpu / workers);
    return farm;
  }

  // Of the critical path. GOPs do not wait for each other: more of them make no chain longer.
  [[nodiscard]] double LeastSeconds(const CriticalPath& of_played) {
    const int gop_frames = std::min(job_.params.gop, job_.num_frames);
    if (played_frames_ == job_.num_frames || whole_gops_ > 0) return of_played.seconds;
    const std::vector<int> lengths = LengthsToPlay(played_frames_);
    std::vector<double> seconds;
    seconds.reserve(lengths.size());
    for (const int frames : lengths) seconds.push_back(FindCriticalPath(PartOf(frames).graph).seconds);
    return GoOn(lengths, seconds, gop_frames);
  }

 private:
  [[nodiscard]] Part& PartOf(int frames) {
    std::unique_ptr<Part>& part = parts_[frames];
    if (!part) part = std::make_unique<Part>(job_, frames);
    return *part;
  }

  [[nodiscard]] Figures Play(int frames, int workers) {
    const ListSchedule played = PlayThrough(PartOf(frames).graph, workers);
    return {played.wall_seconds, played.cpu_seconds, static_cast<double>(played.moved_bytes)};
  }

  // Workers have a GOP each, again and again, and share those that are left in the end; or there are several to a GOP.
  // Either way a farm is as many small ones side by side as there are workers for each of these. An I frame that all
  // GOPs refer to comes before, with all workers.
  [[nodiscard]] Figures OfManyGops(int workers) {
    const int gop = job_.params.gop;
    const int gops = job_.num_gops();
    const bool shared = job_.params.anchor == Anchor::kShared;
    const int before = shared ? 1 : 0;  // frames
    double farms = static_cast<double>(gops) / whole_gops_;
    int small = std::max(1, static_cast<int>(std::lround(workers / farms)));
    Figures figures;
    if (workers >= gops) {
      figures = Play(whole_gops_ * gop, small);
    } else {
      small = std::clamp(whole_gops_ / 2, 1, workers);
      farms = static_cast<double>(workers) / small;
      const double frames = before + (job_.num_frames - before) / farms;
      const int turn = small * gop;  // frames
      // The same rest as that of the whole, so that the last turn is alike.
      const int rest = static_cast<int>(frames) % turn;
      const int first = rest <= before || rest + 2 * turn <= whole_gops_ * gop ? rest + turn : rest;
      figures = Line({first, first + turn}, small, frames);
    }
    const Figures of_all = shared ? Play(1, workers) : Figures();
    const Figures of_small = shared ? Play(1, small) : Figures();
    return {of_all.wall + figures.wall - of_small.wall, of_all.cpu + farms * (figures.cpu - of_small.cpu),
            of_all.moved + farms * (figures.moved - of_small.moved)};
  }

  [[nodiscard]] Figures Line(const std::vector<int>& lengths, int workers, double frames) {
    std::vector<double> wall;
    std::vector<double> cpu;
    std::vector<double> moved;
    for (const int length : lengths) {
      const Figures figures = Play(length, workers);
      wall.push_back(figures.wall);
      cpu.push_back(figures.cpu);
      moved.push_back(figures.moved);
    }
    return {GoOn(lengths, wall, frames), GoOn(lengths, cpu, frames), GoOn(lengths, moved, frames)};
  }

  // What a figure of each length is for `frames`: on the straight line nearest to them (least squares), since single
  // lengths end with workers that idle for more or less long.
  [[nodiscard]] static double GoOn(const std::vector<int>& lengths, const std::vector<double>& figures, double frames) {
    if (figures.size() == 1) return figures.front();
    const auto count = static_cast<double>(figures.size());
    const double mean_length = std::accumulate(lengths.begin(), lengths.end(), 0.0) / count;
    const double mean = std::accumulate(figures.begin(), figures.end(), 0.0) / count;
    double products = 0;
    double squares = 0;
    for (std::size_t i = 0; i < figures.size(); ++i) {
      const double from_mean = lengths[i] - mean_length;
      products += from_mean * (figures[i] - mean);
      squares += from_mean * from_mean;
    }
    return mean + products / squares * (frames - mean_length);
  }

  const ResolvedJob& job_;
  const int played_frames_;
  const int whole_gops_;                        // of these
  std::map<int, std::unique_ptr<Part>> parts_;  // by length
};

}  // namespace

JobForecast Forecast(const ResolvedJob& job, const ForecastOptions& options) {
  JobForecast forecast;
  forecast.stages = Stages(job);
  forecast.frames = job.num_frames;
  forecast.played_frames = FramesToPlay(job, options.most_tasks);
  Extrapolation extrapolation(job, forecast.played_frames);

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
