#include "coordinator/forecast/list_schedule.h"

#include <algorithm>
#include <bit>
#include <optional>
#include <queue>
#include <set>
#include <utility>
#include <vector>

#include "coordinator/scheduling/gop_homes.h"
#include "coordinator/scheduling/placement.h"
#include "coordinator/scheduling/scheduler.h"
#include "coordinator/scheduling/task_table.h"

namespace depthfarm {
namespace {

using Index = TaskGraph::Index;

// One bit for each worker.
class WorkerSets {
 public:
  WorkerSets(std::size_t sets, int workers)
      : words_(static_cast<std::size_t>(workers + 63) / 64), bits_(sets * words_) {}
  [[nodiscard]] std::size_t words() const { return words_; }
  [[nodiscard]] std::uint64_t word(std::size_t set, std::size_t word) const { return bits_[set * words_ + word]; }
  void Add(std::size_t set, int worker) { Word(set, worker) |= Bit(worker); }
  void Remove(std::size_t set, int worker) { Word(set, worker) &= ~Bit(worker); }
  [[nodiscard]] bool Has(std::size_t set, int worker) const {
    return (bits_[set * words_ + static_cast<std::size_t>(worker) / 64] & Bit(worker)) != 0;
  }

 private:
  [[nodiscard]] static std::uint64_t Bit(int worker) {
    return std::uint64_t{1} << (static_cast<unsigned>(worker) % 64);
  }
  [[nodiscard]] std::uint64_t& Word(std::size_t set, int worker) {
    return bits_[set * words_ + static_cast<std::size_t>(worker) / 64];
  }

  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

class Player {
 public:
  Player(const TaskGraph& graph, int workers)
      : graph_(graph),
        workers_(workers),
        holders_(graph.size(), workers),
        free_(1, workers),
        waiting_since_(static_cast<std::size_t>(workers)),
        local_bytes_(static_cast<std::size_t>(workers)),
        missing_(graph.size()),
        open_tasks_(graph.num_gops()),
        ready_of_gop_(graph.num_gops(), std::set<Index, ByUrgencyOf>(ByUrgencyOf{&graph})),
        ready_(ByUrgencyOf{&graph}) {
    for (int worker = 0; worker < workers; ++worker) Free(worker);
    for (Index index = 0; index < graph.size(); ++index) missing_[index] = graph.Needs(index).size();
    Enable(0);
  }

  ListSchedule Play() {
    Advance();
    while (!running_.empty()) {
      const auto [end, worker, task] = running_.top();
      running_.pop();
      result_.wall_seconds = end;
      Free(worker);
      Finish(task);
      Advance();
    }
    return result_;
  }

 private:
  struct ByUrgencyOf {
    const TaskGraph* graph;
    bool operator()(Index a, Index b) const { return ByUrgency()(graph->task(a), graph->task(b)); }
  };
  struct Running {
    double end = 0;
    int worker = 0;
    Index task = 0;
    bool operator>(const Running& other) const { return std::pair(end, worker) > std::pair(other.end, other.worker); }
  };

  void Free(int worker) {
    free_.Add(0, worker);
    ++num_free_;
    waiting_since_[static_cast<std::size_t>(worker)] = next_turn_++;
  }

  [[nodiscard]] std::size_t GopOf(Index task) const {
    std::size_t gop = 0;
    std::size_t end = graph_.num_gops();
    while (gop + 1 < end) {
      const std::size_t middle = (gop + end) / 2;
      (graph_.GopBegin(middle) <= task ? gop : end) = middle;
    }
    return gop;
  }

  [[nodiscard]] bool IsOfAGop(Index task) const { return task > 0 && task + 1 < graph_.size(); }

  // A task that needs nothing any more is ready once its GOP is open.
  void Enable(Index task) {
    if (IsOfAGop(task) && task >= opened_end_) return;
    AddReady(task);
  }

  [[nodiscard]] bool IsAtHomeSomewhere(Index task) const {
    return IsOfAGop(task) && !EndsAFrameOrJob(graph_.task(task).kind);
  }

  void AddReady(Index task) {
    ready_.insert(task);
    if (IsAtHomeSomewhere(task)) ready_of_gop_[GopOf(task)].insert(task);
  }

  void OpenGops() {
    const SchedulerOptions options;
    const std::size_t wanted = static_cast<std::size_t>(workers_) * static_cast<std::size_t>(options.ready_per_slot);
    while (next_gop_ < graph_.num_gops() && open_.size() < static_cast<std::size_t>(options.max_open_gops) &&
           (ready_.size() < wanted || open_.size() < static_cast<std::size_t>(workers_))) {
      const Index begin = graph_.GopBegin(next_gop_);
      opened_end_ = graph_.GopBegin(next_gop_ + 1);
      open_tasks_[next_gop_] = opened_end_ - begin;
      open_.insert(next_gop_++);
      for (Index task = begin; task < opened_end_; ++task)
        if (missing_[task] == 0) AddReady(task);
    }
  }

  void Finish(Index task) {
    if (IsOfAGop(task) && --open_tasks_[GopOf(task)] == 0) {
      homes_.End(static_cast<int>(GopOf(task)));
      open_.erase(GopOf(task));
    }
    for (const Index waiting : graph_.NeededBy(task))
      if (--missing_[waiting] == 0) Enable(waiting);
  }

  void Advance() {
    OpenGops();
    while (num_free_ > 0 && !ready_.empty()) AssignOne();
    OpenGops();
    while (num_free_ > 0 && !ready_.empty()) AssignOne();
  }

  [[nodiscard]] int LongestWaiting() const {
    int best = -1;
    for (int worker = 0; worker < workers_; ++worker) {
      if (!free_.Has(0, worker)) continue;
      if (best < 0 || waiting_since_[static_cast<std::size_t>(worker)] < waiting_since_[static_cast<std::size_t>(best)])
        best = worker;
    }
    return best;
  }

  // The free worker that holds most of the task's inputs, and how much; 0 bytes and no worker where none holds any.
  std::pair<std::uint64_t, int> NearestWorker(Index task) {
    touched_.clear();
    for (const Index needed : graph_.Needs(task)) {
      if (!MakesArtifact(graph_.task(needed).kind)) continue;
      for (std::size_t word = 0; word < holders_.words(); ++word) {
        for (std::uint64_t bits = holders_.word(needed, word) & free_.word(0, word); bits != 0; bits &= bits - 1) {
          const int worker = static_cast<int>(word * 64) + std::countr_zero(bits);
          std::uint64_t& bytes = local_bytes_[static_cast<std::size_t>(worker)];
          if (bytes == 0) touched_.push_back(worker);
          bytes += graph_.cost(needed).result_bytes;
        }
      }
    }
    std::pair<std::uint64_t, int> best{0, -1};
    for (const int worker : touched_) {
      const auto w = static_cast<std::size_t>(worker);
      const std::uint64_t bytes = std::exchange(local_bytes_[w], 0);
      const bool first =
          best.second < 0 || bytes > best.first ||
          (bytes == best.first && waiting_since_[w] < waiting_since_[static_cast<std::size_t>(best.second)]);
      if (first) best = {bytes, worker};
    }
    return best;
  }

  // How much of the task's inputs the worker holds.
  [[nodiscard]] std::uint64_t BytesAt(Index task, int worker) const {
    std::uint64_t bytes = 0;
    for (const Index needed : graph_.Needs(task)) {
      if (MakesArtifact(graph_.task(needed).kind) && holders_.Has(needed, worker))
        bytes += graph_.cost(needed).result_bytes;
    }
    return bytes;
  }

  // As Scheduler::AssignOneOf: what ends a frame, else of a GOP that a free worker is at home with, else of one that
  // has no home, else any.
  void AssignOne() {
    const Index first = *ready_.begin();
    if (EndsAFrameOrJob(graph_.task(first).kind)) return AssignAmong(ready_, -1);
    if (const std::optional<std::pair<std::size_t, int>> own = FreeAtHome())
      return AssignAmong(ready_of_gop_[own->first], own->second);
    for (const std::size_t gop : open_) {
      if (!homes_.HomeOf(static_cast<int>(gop)) && !ready_of_gop_[gop].empty())
        return AssignAmong(ready_of_gop_[gop], -1);
    }
    AssignAmong(ready_, -1);
  }

  // A GOP that has a ready task and whose worker is free; of the one that waits longest.
  [[nodiscard]] std::optional<std::pair<std::size_t, int>> FreeAtHome() const {
    std::optional<std::pair<std::size_t, int>> best;
    for (const std::size_t gop : open_) {
      const std::optional<WorkerId> home = homes_.HomeOf(static_cast<int>(gop));
      if (!home || ready_of_gop_[gop].empty()) continue;
      const auto worker = static_cast<std::size_t>(home->value());
      if (!free_.Has(0, static_cast<int>(worker))) continue;
      if (!best || waiting_since_[worker] < waiting_since_[static_cast<std::size_t>(best->second)])
        best = {gop, static_cast<int>(worker)};
    }
    return best;
  }

  // Starts one of the most urgent of these tasks, on `worker` if one is named (>= 0).
  void AssignAmong(const std::set<Index, ByUrgencyOf>& tasks, int worker) {
    Index task = *tasks.begin();
    std::pair<std::uint64_t, int> best{0, -1};
    std::size_t candidates = 0;
    for (auto candidate = tasks.begin(); candidate != tasks.end() && candidates < kMaxCandidates; ++candidate) {
      if (!EquallyUrgent(graph_.task(*candidate), graph_.task(*tasks.begin()))) break;
      ++candidates;
      const std::pair<std::uint64_t, int> nearest =
          worker < 0 ? NearestWorker(*candidate) : std::pair(BytesAt(*candidate, worker), worker);
      if (nearest.first <= best.first) continue;
      best = nearest;
      task = *candidate;
    }
    if (best.second < 0) best.second = worker < 0 ? LongestWaiting() : worker;
    if (IsAtHomeSomewhere(task))
      homes_.Claim(static_cast<int>(GopOf(task)), WorkerId(static_cast<std::uint64_t>(best.second)));
    Start(task, best.second);
  }

  void Start(Index task, int worker) {
    if (IsAtHomeSomewhere(task)) ready_of_gop_[GopOf(task)].erase(task);
    ready_.erase(task);
    free_.Remove(0, worker);
    --num_free_;
    double seconds = graph_.cost(task).seconds;
    for (const Index needed : graph_.Needs(task)) {
      if (!MakesArtifact(graph_.task(needed).kind) || holders_.Has(needed, worker)) continue;
      const std::uint64_t bytes = graph_.cost(needed).result_bytes;
      result_.moved_bytes += bytes;
      seconds += CostModel::SecondsToRead(bytes);
      holders_.Add(needed, worker);
    }
    holders_.Add(task, worker);
    result_.cpu_seconds += seconds;
    running_.push({result_.wall_seconds + seconds + kGrantSeconds, worker, task});
  }

  const TaskGraph& graph_;
  const int workers_;
  WorkerSets holders_;  // of each task's artifact
  WorkerSets free_;
  int num_free_ = 0;
  std::vector<std::uint64_t> waiting_since_;
  std::uint64_t next_turn_ = 0;
  std::vector<std::uint64_t> local_bytes_;  // of NearestWorker; 0 between calls
  std::vector<int> touched_;
  std::vector<std::size_t> missing_;
  std::vector<std::size_t> open_tasks_;  // of each GOP, not done
  std::set<std::size_t> open_;
  GopHomes homes_;
  std::size_t next_gop_ = 0;
  Index opened_end_ = 0;
  std::vector<std::set<Index, ByUrgencyOf>> ready_of_gop_;  // of ready_, without what ends a frame
  std::set<Index, ByUrgencyOf> ready_;
  std::priority_queue<Running, std::vector<Running>, std::greater<>> running_;
  ListSchedule result_;
};

}  // namespace

ListSchedule PlayThrough(const TaskGraph& graph, int workers) { return Player(graph, std::max(1, workers)).Play(); }

}  // namespace depthfarm
