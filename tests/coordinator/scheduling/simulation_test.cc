#include <gtest/gtest.h>

#include <random>

#include "coordinator/planning/cost_model.h"
#include "tests/coordinator/planned_job.h"
#include "tests/coordinator/scheduling/fake_farm.h"

namespace depthfarm {
namespace {

constexpr int kSeeds = 200;
constexpr int kSteps = 400;

// Workers that work, fail, fall silent, come back, lose artifacts, leave; jobs that are cancelled; all in random order.
class Chaos {
 public:
  Chaos(std::uint32_t seed, FakeFarm& farm) : random_(seed), farm_(farm) {}

  void Step() {
    const int dice = Below(100);
    if (dice < 3 && submitted_ < 3) {
      Submit();
    } else if (dice < 6 && farm_.workers.size() < 6) {
      Join();
    } else if (dice < 20) {
      farm_.PassWithBeats(Milliseconds(Below(2000)));
    } else if (dice == 21) {
      farm_.answers_late = !farm_.answers_late;
      if (!farm_.answers_late) farm_.AnswerAskedBack();
    } else if (dice == 20 && submitted_ > 0 && Below(4) == 0) {
      farm_.Cancel(static_cast<std::uint64_t>(1 + Below(submitted_)));
    } else if (!farm_.workers.empty()) {
      Disturb(std::next(farm_.workers.begin(), Below(static_cast<int>(farm_.workers.size())))->first, Below(100));
    }
  }

  // Some have a tag, some are too small for one task or for two.
  void Join() {
    const WorkerId id = farm_.Join(1 + Below(3), Below(3));
    FakeWorker& worker = farm_.At(id);
    if (Below(2) == 0) worker.tags = {"tag"};
    if (Below(2) == 0) worker.memory_bytes = kProcessMemoryBytes + static_cast<std::uint64_t>(Below(100'000));
    farm_.Rejoin(id);
    farm_.Ask(id);
  }

  void Submit() {
    if (Below(4) == 0) {
      farm_.Submit(MakeRenderingJob(static_cast<std::uint64_t>(++submitted_), 1 + Below(40)), Below(2), Tags());
      return;
    }
    const int refine = Below(3);
    farm_.Submit(MakePlannedJob({.id = static_cast<std::uint64_t>(++submitted_),
                                 .frames = 1 + Below(6),
                                 .gop = 1 + Below(4),
                                 .views = 2 + Below(2),
                                 .blocks_i = 1 + Below(5),
                                 .blocks_p = 1 + Below(2),
                                 .refine = refine,
                                 .confidence = refine > 0 && Below(2) == 0,
                                 .anchor = Below(2) == 0 ? Anchor::kShared : Anchor::kGop}),
                 Below(2), Tags());
  }
  [[nodiscard]] int submitted() const { return submitted_; }

 private:
  std::set<std::string> Tags() { return Below(3) == 0 ? std::set<std::string>{"tag"} : std::set<std::string>(); }
  int Below(int bound) { return static_cast<int>(random_() % static_cast<std::uint32_t>(bound)); }

  void Disturb(WorkerId id, int dice) {
    FakeWorker& worker = farm_.At(id);
    if (!worker.alive) {
      // A process that comes back: with its store, or as somebody that was only cut off and still runs its task.
      if (Below(2) == 0) worker.running.clear();
      worker.alive = true;
      farm_.Rejoin(id);
      if (worker.HasRoom()) farm_.Ask(id);
    } else if (dice < 3) {
      farm_.Kill(id);
    } else if (dice < 5) {
      farm_.Leave(id);
    } else if (dice < 9 && !worker.store.empty()) {
      const auto artifact = std::next(worker.store.begin(), Below(static_cast<int>(worker.store.size())));
      farm_.Drop(id, ArtifactKey(artifact->first));
    } else if (dice < 10) {
      worker.store.clear();  // without a word
    } else if (worker.running.empty()) {
      farm_.Ask(id);
    } else if (dice < 14) {
      farm_.Fail(id, Internal("by chance"));
    } else if (dice < 17) {
      const TaskFinished twice = farm_.ResultOf(worker, farm_.Running(id));
      worker.running.erase(twice.lease);
      farm_.Send(twice);
      farm_.Send(twice);
      farm_.Ask(id);
    } else if (dice < 19) {
      worker.running.erase(worker.running.begin());  // the grant got lost
    } else {
      farm_.Finish(id);
    }
  }

  std::mt19937 random_;
  FakeFarm& farm_;
  int submitted_ = 0;
};

TEST(FarmSimulation, EveryJobEndsAndNothingIsKeptWhateverHappens) {
  int done = 0;
  std::uint64_t duplicates = 0;
  for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    SchedulerOptions options;
    const bool patient = seed % 2 == 0;
    if (patient) options.max_attempts = options.max_setbacks = 1'000'000;
    FakeFarm farm(options);
    Chaos chaos(seed, farm);
    for (int step = 0; step < kSteps; ++step) chaos.Step();
    if (chaos.submitted() == 0) chaos.Submit();

    farm.answers_late = false;
    farm.AnswerAskedBack();
    // Calm: the silent are gone for good, one healthy worker comes.
    for (auto worker = farm.workers.begin(); worker != farm.workers.end();) {
      worker = worker->second.alive ? std::next(worker) : farm.workers.erase(worker);
    }
    const WorkerId healthy = farm.Join();
    farm.At(healthy).tags = {"tag"};
    farm.Rejoin(healthy);
    farm.Ask(healthy);
    farm.RunToTheEnd();
    ASSERT_EQ(farm.ended.size(), static_cast<std::size_t>(chaos.submitted()));
    for (const auto& [id, job] : farm.ended) {
      EXPECT_EQ(job.determinism_violations, 0U);
      EXPECT_TRUE(job.running.empty());
      duplicates += job.duplicates;
      EXPECT_FALSE(patient && job.state == JobState::kFailed) << job.error.message();
      if (job.state != JobState::kDone) continue;
      ++done;
      EXPECT_EQ(job.frames_done, job.frames_total);
      for (int kind = 0; kind < kNumTaskKinds; ++kind) {
        // A lost artifact that nobody reads any more is not made again: all results are there, each counted once.
        const StageSnapshot& stage = job.stages[static_cast<std::size_t>(kind)];
        EXPECT_EQ(stage.tasks_done, stage.tasks_total) << TaskKindName(static_cast<TaskKind>(kind));
      }
    }
    while (!farm.workers.empty()) farm.Leave(farm.workers.begin()->first);
    farm.Pass(options.lease);
    ASSERT_TRUE(farm.scheduler.empty());
    EXPECT_EQ(farm.attempts_ended.size(), farm.grants.size());
    if (HasFailure()) return;
  }
  EXPECT_GT(done, kSeeds / 2);
  EXPECT_GT(duplicates, 0U);
}

TEST(FarmSimulation, TheSameEventsGiveTheSameGrants) {
  const auto grants = [](std::uint32_t seed) {
    FakeFarm farm;
    Chaos chaos(seed, farm);
    for (int step = 0; step < kSteps; ++step) chaos.Step();
    std::vector<std::pair<TaskId, WorkerId>> list;
    for (const Grant& grant : farm.grants) list.emplace_back(grant.task.spec.id, grant.worker);
    return list;
  };
  for (std::uint32_t seed = 1; seed <= 10; ++seed) EXPECT_EQ(grants(seed), grants(seed));
}

}  // namespace
}  // namespace depthfarm
