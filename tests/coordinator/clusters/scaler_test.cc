#include "coordinator/clusters/scaler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace depthfarm {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::ElementsAre;
using testing::IsEmpty;

// A cluster whose engine and coordinator do as they are told.
class FakeCluster {
 public:
  explicit FakeCluster(ScalerOptions options)
      : scaler_([&] {
          options.cluster = "c";
          return options;
        }()) {}

  ScalingDecision Decide() {
    const ScalingDecision decision = scaler_.Decide(view, now);
    for (int i = 0; i < decision.launch; ++i)
      view.pilots.push_back({"p" + std::to_string(++last_), false, "", "PENDING"});
    for (const std::string& id : decision.cancel)
      std::erase_if(view.pilots, [&](const Pilot& p) { return p.id == id; });
    for (const std::string& name : decision.drain) {
      for (ClusterWorker& worker : view.workers) worker.draining |= worker.name == name;
    }
    return decision;
  }
  ScalingDecision After(milliseconds time) {
    now += time;
    return Decide();
  }
  // Every pilot that waits gets a machine and its worker joins.
  void StartAll(bool busy) {
    for (Pilot& pilot : view.pilots) {
      if (!pilot.running) view.workers.push_back({"c." + pilot.id + ".0", busy, false});
      pilot.running = true;
    }
  }
  void End(std::string pilot) {  // a copy: it may be of the list that is changed
    std::erase_if(view.pilots, [&](const Pilot& p) { return p.id == pilot; });
    std::erase_if(view.workers, [&](const ClusterWorker& w) { return w.name == "c." + pilot + ".0"; });
  }

  ClusterView view;
  Scaler::TimePoint now;

 private:
  Scaler scaler_;
  int last_ = 0;
};

TEST(Scaler, AsksForAsManyAsThereIsWorkForWithinBounds) {
  FakeCluster cluster({.min_workers = 1, .max_workers = 4});
  EXPECT_EQ(cluster.Decide().launch, 1);
  cluster.view.wanted_slots = 3;
  EXPECT_EQ(cluster.Decide().launch, 2);
  cluster.view.wanted_slots = 1000;
  EXPECT_EQ(cluster.Decide().launch, 1);
  EXPECT_EQ(cluster.Decide().launch, 0) << "those that wait count";
}

TEST(Scaler, SlotsAreSharedOutRoundedUp) {
  FakeCluster cluster({.min_workers = 0, .max_workers = 100, .slots_per_worker = 4});
  EXPECT_EQ(cluster.Decide().launch, 0);
  cluster.view.wanted_slots = 1;
  EXPECT_EQ(cluster.Decide().launch, 1);
  cluster.view.wanted_slots = 9;
  EXPECT_EQ(cluster.Decide().launch, 2);
}

TEST(Scaler, WhatIsIdleForLongLeavesTheLongestIdleFirst) {
  FakeCluster cluster({.min_workers = 1, .max_workers = 4, .idle = seconds(60)});
  cluster.view.wanted_slots = 3;
  cluster.Decide();
  cluster.StartAll(true);
  cluster.view.wanted_slots = 2;
  cluster.view.workers[1].busy = false;
  EXPECT_THAT(cluster.Decide().drain, IsEmpty());
  cluster.view.wanted_slots = 0;
  cluster.view.workers[0].busy = false;
  EXPECT_THAT(cluster.After(seconds(30)).drain, IsEmpty());
  EXPECT_THAT(cluster.After(seconds(29)).drain, IsEmpty());
  EXPECT_THAT(cluster.After(seconds(1)).drain, ElementsAre("c.p2.0"));
  // The one that leaves does not count any more; one stays.
  EXPECT_THAT(cluster.After(seconds(30)).drain, ElementsAre("c.p1.0"));
  cluster.view.workers[2].busy = false;
  EXPECT_THAT(cluster.After(seconds(1000)).drain, IsEmpty());
  EXPECT_THAT(cluster.After(seconds(1000)).drain, IsEmpty());
}

TEST(Scaler, AWorkerThatGotATaskMeanwhileStays) {
  FakeCluster cluster({.min_workers = 0, .max_workers = 4, .idle = seconds(60)});
  cluster.view.wanted_slots = 1;
  cluster.Decide();
  cluster.StartAll(false);
  cluster.view.wanted_slots = 0;
  EXPECT_THAT(cluster.After(seconds(50)).drain, IsEmpty());
  cluster.view.workers[0].busy = true;
  EXPECT_THAT(cluster.After(seconds(20)).drain, IsEmpty());
  cluster.view.workers[0].busy = false;
  EXPECT_THAT(cluster.After(seconds(50)).drain, IsEmpty());
  EXPECT_THAT(cluster.After(seconds(50)).drain, IsEmpty());
  EXPECT_THAT(cluster.After(seconds(10)).drain, ElementsAre("c.p1.0"));
}

TEST(Scaler, WaitingPilotsThatAreNotNeededAreCancelledTheNewestFirst) {
  FakeCluster cluster({.min_workers = 0, .max_workers = 4, .settle = seconds(5)});
  cluster.view.wanted_slots = 4;
  cluster.Decide();
  cluster.view.wanted_slots = 1;
  EXPECT_THAT(cluster.Decide().cancel, IsEmpty());
  EXPECT_THAT(cluster.After(seconds(4)).cancel, IsEmpty());
  cluster.view.wanted_slots = 4;  // a moment's lull was no reason
  cluster.After(seconds(1));
  cluster.view.wanted_slots = 1;
  EXPECT_THAT(cluster.After(seconds(1)).cancel, IsEmpty());
  const ScalingDecision decision = cluster.After(seconds(5));
  EXPECT_THAT(decision.cancel, ElementsAre("p4", "p3", "p2"));
  const ScalingDecision next = cluster.After(seconds(1));
  EXPECT_THAT(next.failed, IsEmpty()) << "what was cancelled did not fail";
  EXPECT_EQ(next.launch, 0);
}

TEST(Scaler, WorkersOfOthersAreNotItsOwn) {
  FakeCluster cluster({.min_workers = 0, .max_workers = 4, .idle = seconds(1)});
  cluster.view.wanted_slots = 1;
  cluster.view.workers = {{"host:1:2", false, false}, {"other.p1.0", false, false}};
  EXPECT_EQ(cluster.Decide().launch, 1) << "idle workers of others may not take the job: its own are its measure";
  cluster.StartAll(true);
  cluster.view.wanted_slots = 0;
  cluster.After(seconds(100));
  EXPECT_THAT(cluster.After(seconds(100)).drain, IsEmpty());
}

TEST(Scaler, WhatDiesIsReplacedAtOnceAfterItHadJoined) {
  FakeCluster cluster({.min_workers = 0, .max_workers = 4});
  cluster.view.wanted_slots = 2;
  cluster.Decide();
  cluster.StartAll(true);
  cluster.Decide();
  cluster.End("p1");
  const ScalingDecision decision = cluster.After(seconds(1));
  EXPECT_THAT(decision.failed, IsEmpty());
  EXPECT_EQ(decision.launch, 1);
}

TEST(Scaler, WhatEndsBeforeItJoinedIsReplacedMoreAndMoreSlowly) {
  FakeCluster cluster({.min_workers = 0, .max_workers = 1});
  cluster.view.wanted_slots = 1;
  std::vector<int> pauses;
  for (int i = 0; i < 9; ++i) {
    ASSERT_EQ(cluster.Decide().launch, 1);
    const bool seen = i % 2 == 0;
    if (seen) {
      EXPECT_EQ(cluster.Decide().launch, 0);
    }
    cluster.End(cluster.view.pilots[0].id);
    const ScalingDecision decision = cluster.After(seconds(1));
    // Of every second one nothing was seen but that it had been asked for.
    EXPECT_EQ(decision.failed.size(), seen ? 1U : 0U);
    EXPECT_EQ(decision.vanished, seen ? 0 : 1);
    ASSERT_TRUE(decision.pause.has_value());
    EXPECT_EQ(decision.launch, 0);
    pauses.push_back(static_cast<int>(decision.pause->count() / 1000));
    EXPECT_EQ(cluster.After(*decision.pause - milliseconds(1)).launch, 0);
    cluster.now += milliseconds(1);
  }
  EXPECT_THAT(pauses, ElementsAre(5, 10, 20, 40, 80, 160, 300, 300, 300));
  // One that joins ends that.
  ASSERT_EQ(cluster.Decide().launch, 1);
  cluster.StartAll(true);
  cluster.Decide();
  cluster.End(cluster.view.pilots[0].id);
  ASSERT_EQ(cluster.Decide().launch, 1);
  cluster.End(cluster.view.pilots[0].id);
  EXPECT_EQ(cluster.Decide().pause, seconds(5));
}

TEST(Scaler, AnEngineThatTakesNothingIsAskedMoreAndMoreSlowly) {
  Scaler scaler({.cluster = "c", .min_workers = 1, .max_workers = 1});
  Scaler::TimePoint now;
  ASSERT_EQ(scaler.Decide({}, now).launch, 1);
  EXPECT_EQ(scaler.LaunchFailed(now), seconds(5));
  EXPECT_EQ(scaler.Decide({}, now + seconds(4)).launch, 0);
  now += seconds(5);
  const ScalingDecision again = scaler.Decide({}, now);
  EXPECT_EQ(again.launch, 1);
  EXPECT_EQ(again.vanished, 0) << "what was not taken did not vanish";
  EXPECT_EQ(scaler.LaunchFailed(now), seconds(10));
}

// Whatever comes, the number of pilots that are not leaving stays within the bounds, no busy worker is drained, and
// when the work is constant the cluster comes to rest at what it needs.
TEST(Scaler, KeepsItsBoundsAndComesToRest) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    std::mt19937 random(seed);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const int least = below(3);
    const ScalerOptions options{.min_workers = least,
                                .max_workers = least + 1 + below(6),
                                .slots_per_worker = 1 + below(3),
                                .idle = seconds(20)};
    FakeCluster cluster(options);
    for (int step = 0; step < 300; ++step) {
      const bool calm = step >= 200;
      if (!calm) {
        if (below(5) == 0) cluster.view.wanted_slots = static_cast<std::uint64_t>(below(20));
        if (below(10) == 0 && !cluster.view.pilots.empty())
          cluster.End(
              cluster.view.pilots[static_cast<std::size_t>(below(static_cast<int>(cluster.view.pilots.size())))].id);
      }
      if (calm || below(3) == 0) cluster.StartAll(false);
      const auto wanted_workers = static_cast<std::size_t>(
          (cluster.view.wanted_slots + static_cast<std::uint64_t>(options.slots_per_worker) - 1) /
          static_cast<std::uint64_t>(options.slots_per_worker));
      for (std::size_t i = 0; i < cluster.view.workers.size(); ++i) cluster.view.workers[i].busy = i < wanted_workers;
      const ScalingDecision decision = cluster.After(seconds(2 + below(3)));
      for (const std::string& name : decision.drain) {
        for (const ClusterWorker& worker : cluster.view.workers) EXPECT_FALSE(worker.name == name && worker.busy);
      }
      std::vector<std::string> left;
      for (const ClusterWorker& worker : cluster.view.workers) {
        if (worker.draining) left.push_back(worker.name.substr(2, worker.name.size() - 4));
      }
      for (const std::string& pilot : left) cluster.End(pilot);
      ASSERT_LE(cluster.view.pilots.size(), static_cast<std::size_t>(options.max_workers)) << "seed " << seed;
      if (step == 299) {
        const std::size_t target = std::clamp(wanted_workers, static_cast<std::size_t>(options.min_workers),
                                              static_cast<std::size_t>(options.max_workers));
        ASSERT_EQ(cluster.view.pilots.size(), target) << "seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace depthfarm
