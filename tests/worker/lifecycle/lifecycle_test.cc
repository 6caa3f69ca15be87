#include "worker/lifecycle/lifecycle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace depthfarm {
namespace {

namespace event = lifecycle_event;
namespace action = lifecycle_action;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr Milliseconds kHeartbeat{1000};
constexpr Milliseconds kLease{6000};
constexpr LeaseId kTask{41};

using Actions = std::vector<LifecycleAction>;

template <typename Kind>
int Count(const Actions& actions) {
  return static_cast<int>(
      std::ranges::count_if(actions, [](const LifecycleAction& a) { return std::holds_alternative<Kind>(a); }));
}

template <typename Kind>
Kind Only(const Actions& actions) {
  EXPECT_EQ(Count<Kind>(actions), 1);
  for (const LifecycleAction& a : actions) {
    if (const auto* found = std::get_if<Kind>(&a)) return *found;
  }
  return {};
}

// A worker on a virtual clock.
class LifecycleTest : public testing::Test {
 protected:
  explicit LifecycleTest(int capacity = 1) : worker_(WithCapacity(capacity), now_) {}

  LifecycleOptions WithCapacity(int capacity) {
    options_.capacity = capacity;
    options_.give_up = Milliseconds(30000);
    return options_;
  }
  Actions Handle(const LifecycleEvent& happened) { return worker_.Handle(happened, now_); }
  Actions Tick() { return worker_.Tick(now_); }
  void Pass(Milliseconds time) { now_ += time; }

  // Joined and idle; the ask was sent at now_.
  std::uint64_t Join() {
    EXPECT_EQ(Count<action::SendHello>(Tick()), 1);
    return Only<action::SendAsk>(Handle(event::Welcomed{kHeartbeat, kLease})).ask_id;
  }
  void Work() { EXPECT_THAT(Handle(event::Granted{kTask, Join()}), ElementsAre(action::StartTask{kTask})); }
  // Time passes in heartbeats without any answer; everything that was to be done.
  Actions Silence(Milliseconds time) {
    Actions all;
    const TimePoint end = now_ + time;
    while (now_ < end) {
      now_ = std::min(end, std::max(now_, worker_.NextDue()));
      const Actions due = Tick();
      all.insert(all.end(), due.begin(), due.end());
    }
    return all;
  }

  TimePoint now_{std::chrono::hours(1)};
  LifecycleOptions options_;
  Lifecycle worker_;
};

TEST_F(LifecycleTest, SaysHelloAgainUntilWelcomedAndWaitsLongerEachTime) {
  EXPECT_EQ(Count<action::SendHello>(Tick()), 1);
  EXPECT_THAT(Tick(), IsEmpty());
  EXPECT_EQ(worker_.NextDue(), now_ + Milliseconds(500));
  Pass(Milliseconds(500));
  EXPECT_EQ(Count<action::SendHello>(Tick()), 1);
  EXPECT_EQ(worker_.NextDue(), now_ + Milliseconds(1000));
  EXPECT_EQ(worker_.state(), WorkerState::kJoining);
}

TEST_F(LifecycleTest, AsksWhenWelcomed) {
  Join();
  EXPECT_EQ(worker_.state(), WorkerState::kIdle);
}

TEST_F(LifecycleTest, RenewsTheAskWithEachHeartbeatWhileIdle) {
  const std::uint64_t first = Join();
  Pass(kHeartbeat);
  const Actions actions = Tick();
  EXPECT_EQ(Count<action::SendHeartbeat>(actions), 1);
  EXPECT_GT(Only<action::SendAsk>(actions).ask_id, first);
}

TEST_F(LifecycleTest, DoesNotAskWhileItWorks) {
  Work();
  EXPECT_EQ(worker_.state(), WorkerState::kWorking);
  Pass(kHeartbeat);
  const Actions actions = Tick();
  EXPECT_THAT(actions, ElementsAre(action::SendHeartbeat{2, {kTask}}));
}

TEST_F(LifecycleTest, TakesAnEarlierAskThatIsStillFresh) {
  const std::uint64_t first = Join();
  Pass(kHeartbeat);
  (void)Tick();
  EXPECT_THAT(Handle(event::Granted{kTask, first}), ElementsAre(action::StartTask{kTask}));
}

TEST_F(LifecycleTest, TakesAnAskThatCrossedAGrantWhenItIsFreeAgain) {
  const std::uint64_t first = Join();
  Pass(kHeartbeat);
  const TimePoint asked = now_;
  const std::uint64_t second = Only<action::SendAsk>(Tick()).ask_id;
  (void)Handle(event::Granted{kTask, first});
  Pass(Milliseconds(500));
  (void)Handle(event::TaskEnded{kTask});
  EXPECT_THAT(Handle(event::Granted{LeaseId{42}, second}), ElementsAre(action::StartTask{LeaseId{42}}));
  EXPECT_LE(worker_.NextDue(), asked + kLease);
}

TEST_F(LifecycleTest, NoAskIsGrantedTwice) {
  const std::uint64_t ask = Join();
  (void)Handle(event::Granted{kTask, ask});
  (void)Handle(event::TaskEnded{kTask});
  EXPECT_EQ(Count<action::RefuseGrant>(Handle(event::Granted{LeaseId{42}, ask})), 1);
}

TEST_F(LifecycleTest, RefusesAGrantForAnAskOlderThanHalfALeaseAndAsksAgain) {
  const std::uint64_t ask = Join();
  Pass(kLease / 2 + Milliseconds(1));
  const Actions actions = Handle(event::Granted{kTask, ask});
  EXPECT_EQ(Only<action::RefuseGrant>(actions).lease, kTask);
  EXPECT_EQ(Count<action::SendAsk>(actions), 1);
  EXPECT_EQ(Count<action::StartTask>(actions), 0);
}

TEST_F(LifecycleTest, RefusesASecondTask) {
  Work();
  EXPECT_EQ(Only<action::RefuseGrant>(Handle(event::Granted{LeaseId{42}, 1})).lease, LeaseId{42});
}

TEST_F(LifecycleTest, ARepeatedGrantStartsNothing) {
  Work();
  EXPECT_THAT(Handle(event::Granted{kTask, 1}), IsEmpty());
}

TEST_F(LifecycleTest, RefusesAGrantItDidNotAskFor) {
  Join();
  EXPECT_EQ(Count<action::RefuseGrant>(Handle(event::Granted{kTask, 999})), 1);
}

TEST_F(LifecycleTest, ReportsTheResultAndAsksForMore) {
  Work();
  const Actions actions = Handle(event::TaskEnded{kTask});
  EXPECT_EQ(Only<action::ReportTask>(actions).lease, kTask);
  EXPECT_EQ(Count<action::SendAsk>(actions), 1);
  EXPECT_EQ(worker_.state(), WorkerState::kIdle);
}

TEST_F(LifecycleTest, CountsTheLeaseFromTheAskNotFromTheGrant) {
  const std::uint64_t ask = Join();
  const TimePoint asked = now_;
  Pass(Milliseconds(900));
  (void)Handle(event::Granted{kTask, ask});
  now_ = asked + kLease - Milliseconds(1);
  EXPECT_EQ(Count<action::StopTask>(Tick()), 0);
  now_ = asked + kLease;
  EXPECT_EQ(Only<action::StopTask>(Tick()).lease, kTask);
  EXPECT_EQ(Count<action::DropResult>(Handle(event::TaskEnded{kTask})), 1);
}

TEST_F(LifecycleTest, AnAckedHeartbeatRenewsTheLeaseFromWhenItWasSent) {
  Work();
  Pass(kHeartbeat);
  const TimePoint sent = now_;
  const std::uint64_t beat = Only<action::SendHeartbeat>(Tick()).heartbeat_id;
  Pass(Milliseconds(700));
  EXPECT_THAT(Handle(event::HeartbeatAcked{beat, {}}), IsEmpty());
  now_ = sent + kLease - Milliseconds(1);
  EXPECT_EQ(Count<action::StopTask>(Tick()), 0);
  now_ = sent + kLease;
  EXPECT_EQ(Count<action::StopTask>(Tick()), 1);
}

TEST_F(LifecycleTest, SaysUntilWhenATaskIsItsOwn) {
  EXPECT_EQ(worker_.ExpiryOf(kTask), std::nullopt);
  const std::uint64_t ask = Join();
  const TimePoint asked = now_;
  Pass(kHeartbeat / 2);
  (void)Handle(event::Granted{kTask, ask});
  EXPECT_EQ(worker_.ExpiryOf(kTask), asked + kLease);
  Pass(kHeartbeat / 2);
  const TimePoint sent = now_;
  const std::uint64_t beat = Only<action::SendHeartbeat>(Tick()).heartbeat_id;
  Pass(Milliseconds(10));
  (void)Handle(event::HeartbeatAcked{beat, {}});
  EXPECT_EQ(worker_.ExpiryOf(kTask), sent + kLease);
  (void)Handle(event::Revoked{kTask});
  EXPECT_EQ(worker_.ExpiryOf(kTask), std::nullopt);
}

TEST_F(LifecycleTest, AnAckOfAHeartbeatWithoutTheLeaseDoesNotRenewIt) {
  const std::uint64_t ask = Join();  // its heartbeat, 1, names no lease
  const TimePoint asked = now_;
  (void)Handle(event::Granted{kTask, ask});
  Pass(Milliseconds(500));
  (void)Handle(event::HeartbeatAcked{1, {}});
  now_ = asked + kLease;
  EXPECT_EQ(Count<action::StopTask>(Tick()), 1);
}

TEST_F(LifecycleTest, AcksKeepALongTaskAlive) {
  Work();
  for (int i = 0; i < 100; ++i) {
    Pass(kHeartbeat);
    const Actions actions = Tick();
    ASSERT_EQ(Count<action::StopTask>(actions), 0);
    (void)Handle(event::HeartbeatAcked{Only<action::SendHeartbeat>(actions).heartbeat_id, {}});
  }
  EXPECT_EQ(Count<action::ReportTask>(Handle(event::TaskEnded{kTask})), 1);
}

TEST_F(LifecycleTest, StopsATaskTheCoordinatorDoesNotKnow) {
  Work();
  Pass(kHeartbeat);
  const std::uint64_t beat = Only<action::SendHeartbeat>(Tick()).heartbeat_id;
  EXPECT_EQ(Count<action::StopTask>(Handle(event::HeartbeatAcked{beat, {kTask}})), 1);
  // As far as is known here the coordinator revoked it and waits for its end.
  Pass(kHeartbeat);
  EXPECT_THAT(Only<action::SendHeartbeat>(Tick()).running, ElementsAre(kTask));
  const Actions actions = Handle(event::TaskEnded{kTask});
  EXPECT_EQ(Only<action::ReportTask>(actions).lease, kTask);
  EXPECT_THAT(Only<action::SendAsk>(actions).running, IsEmpty());
}

TEST_F(LifecycleTest, StopsARevokedTaskOnceAndIsNotFreeBeforeItEnded) {
  Work();
  EXPECT_EQ(Count<action::StopTask>(Handle(event::Revoked{kTask})), 1);
  EXPECT_THAT(Handle(event::Revoked{kTask}), IsEmpty());
  EXPECT_EQ(worker_.state(), WorkerState::kWorking);
  Pass(kHeartbeat);
  EXPECT_THAT(Tick(), ElementsAre(action::SendHeartbeat{2, {kTask}}));  // the coordinator waits for its end
  EXPECT_THAT(Handle(event::TaskEnded{kTask}), ElementsAre(action::ReportTask{kTask}, action::SendAsk{2, {}}));
}

TEST_F(LifecycleTest, IgnoresTheRevocationOfAnotherLease) {
  Work();
  EXPECT_THAT(Handle(event::Revoked{LeaseId{7}}), IsEmpty());
}

TEST_F(LifecycleTest, SaysHelloAgainAfterALeaseOfSilence) {
  Join();
  const Actions quiet = Silence(kLease - Milliseconds(1));
  EXPECT_EQ(Count<action::SendHello>(quiet), 0);
  EXPECT_EQ(Count<action::SendHello>(Silence(Milliseconds(1))), 1);
  EXPECT_EQ(worker_.state(), WorkerState::kLost);
  EXPECT_EQ(Count<action::SendAsk>(Handle(event::Welcomed{kHeartbeat, kLease})), 1);
  EXPECT_EQ(worker_.state(), WorkerState::kIdle);
}

TEST_F(LifecycleTest, StopsItsTaskNoLaterThanALeaseAfterTheCutAndDropsTheResult) {
  Work();
  EXPECT_EQ(Count<action::StopTask>(Silence(kLease)), 1);
  EXPECT_EQ(Count<action::DropResult>(Handle(event::TaskEnded{kTask})), 1);
}

TEST_F(LifecycleTest, SaysHelloAtOnceToACoordinatorThatDoesNotKnowIt) {
  Join();
  EXPECT_EQ(Count<action::SendHello>(Handle(event::Refused{Unavailable("who are you")})), 1);
  EXPECT_EQ(worker_.state(), WorkerState::kLost);
}

TEST_F(LifecycleTest, NamesARunningLeaseWhenItRejoins) {
  Work();
  EXPECT_THAT(Handle(event::Refused{Unavailable("who are you")}), ElementsAre(action::SendHello{{kTask}}));
  EXPECT_THAT(Handle(event::Welcomed{kHeartbeat, kLease}), ElementsAre(action::SendHeartbeat{2, {kTask}}));
  EXPECT_EQ(worker_.state(), WorkerState::kWorking);
}

TEST_F(LifecycleTest, EndsWithAnErrorWhenItsVersionIsRefused) {
  (void)Tick();
  const Actions actions = Handle(event::Refused{{ErrorCode::kIncompatible, "algorithm version 2, expected 1"}});
  EXPECT_EQ(Only<action::Exit>(actions).status.code(), ErrorCode::kIncompatible);
  EXPECT_EQ(worker_.state(), WorkerState::kGone);
}

TEST_F(LifecycleTest, GivesUpAfterTheConfiguredSilence) {
  (void)Tick();
  EXPECT_EQ(Count<action::Exit>(Silence(Milliseconds(29999))), 0);
  EXPECT_EQ(Only<action::Exit>(Silence(Milliseconds(1))).status.code(), ErrorCode::kUnavailable);
}

TEST_F(LifecycleTest, NeverGivesUpWhenNotTold) {
  options_.give_up.reset();
  Lifecycle patient(options_, now_);
  for (int hour = 0; hour < 24; ++hour) {
    Pass(std::chrono::hours(1));
    EXPECT_THAT(patient.Tick(now_), ElementsAre(action::SendHello{}));
  }
}

TEST_F(LifecycleTest, AnIdleWorkerLeavesAtOnceWithGoodbye) {
  Join();
  EXPECT_THAT(Handle(event::StopRequested{}), ElementsAre(action::SendGoodbye{}, action::Exit{}));
}

TEST_F(LifecycleTest, ALeavingWorkerStopsItsTaskAndGoesWhenItEnds) {
  Work();
  const Actions actions = Handle(event::StopRequested{});
  EXPECT_EQ(Count<action::SendGoodbye>(actions), 1);
  EXPECT_EQ(Count<action::StopTask>(actions), 1);
  EXPECT_EQ(Count<action::Exit>(actions), 0);
  EXPECT_THAT(Handle(event::StopRequested{}), IsEmpty());
  EXPECT_THAT(Handle(event::TaskEnded{kTask}), ElementsAre(action::DropResult{kTask}, action::Exit{}));
}

TEST_F(LifecycleTest, ALeavingWorkerDoesNotWaitForeverForItsTask) {
  Work();
  (void)Handle(event::StopRequested{});
  EXPECT_EQ(Count<action::Exit>(Silence(options_.goodbye_grace)), 1);
  EXPECT_EQ(worker_.NextDue(), TimePoint::max());
}

TEST_F(LifecycleTest, ALeavingWorkerTakesNoGrant) {
  Work();
  (void)Handle(event::StopRequested{});
  EXPECT_EQ(Count<action::RefuseGrant>(Handle(event::Granted{LeaseId{42}, 1})), 1);
}

TEST_F(LifecycleTest, WithTimeToFinishAWorkerReportsItsTaskAndLeavesThen) {
  Work();
  EXPECT_THAT(Handle(event::StopRequested{Milliseconds(60'000)}), IsEmpty());
  EXPECT_EQ(worker_.state(), WorkerState::kWorking);
  // Nothing new meanwhile, but the lease goes on.
  EXPECT_EQ(Count<action::RefuseGrant>(Handle(event::Granted{LeaseId{42}, 1})), 1);
  const Actions beat = Silence(kHeartbeat);
  EXPECT_EQ(Count<action::SendHeartbeat>(beat), 1);
  EXPECT_EQ(Count<action::SendAsk>(beat), 0);
  EXPECT_THAT(Handle(event::TaskEnded{kTask}),
              ElementsAre(action::ReportTask{kTask}, action::SendGoodbye{}, action::Exit{}));
}

TEST_F(LifecycleTest, TimeToFinishIsBounded) {
  Work();
  (void)Handle(event::StopRequested{Milliseconds(500)});
  EXPECT_EQ(worker_.NextDue(), now_ + Milliseconds(500));
  EXPECT_EQ(Count<action::StopTask>(Silence(Milliseconds(499))), 0);
  const Actions actions = Silence(Milliseconds(1));
  EXPECT_EQ(Count<action::SendGoodbye>(actions), 1);
  EXPECT_EQ(Count<action::StopTask>(actions), 1);
}

TEST_F(LifecycleTest, ASecondStopDoesNotLetItFinish) {
  Work();
  (void)Handle(event::StopRequested{Milliseconds(60'000)});
  EXPECT_EQ(Count<action::StopTask>(Handle(event::StopRequested{Milliseconds(60'000)})), 1);
}

TEST_F(LifecycleTest, AnIdleWorkerNeedsNoTimeToFinish) {
  Join();
  EXPECT_THAT(Handle(event::StopRequested{Milliseconds(60'000)}), ElementsAre(action::SendGoodbye{}, action::Exit{}));
}

TEST_F(LifecycleTest, TwoWelcomesLoseNoAsk) {
  const std::uint64_t ask = Join();
  (void)Handle(event::Welcomed{kHeartbeat, kLease});
  EXPECT_THAT(Handle(event::Granted{kTask, ask}), ElementsAre(action::StartTask{kTask}));
}

// A worker that takes three tasks at a time.
class LifecycleOfThreeTest : public LifecycleTest {
 protected:
  LifecycleOfThreeTest() : LifecycleTest(3) {}

  // Joins and is granted the leases 1, 2, 3.
  void FillUp() {
    std::uint64_t ask = Join();
    for (const LeaseId lease : {LeaseId(1), LeaseId(2), LeaseId(3)}) {
      const Actions actions = Handle(event::Granted{lease, ask});
      EXPECT_EQ(Only<action::StartTask>(actions).lease, lease);
      if (lease != LeaseId(3)) ask = Only<action::SendAsk>(actions).ask_id;
    }
  }
};

TEST_F(LifecycleOfThreeTest, AsksUntilItIsFull) {
  FillUp();
  EXPECT_EQ(Only<action::RefuseGrant>(Handle(event::Granted{LeaseId(4), 3})).lease, LeaseId(4));
  Pass(kHeartbeat);
  EXPECT_THAT(Tick(), ElementsAre(action::SendHeartbeat{2, {LeaseId(1), LeaseId(2), LeaseId(3)}}));
}

TEST_F(LifecycleOfThreeTest, EndsTasksInAnyOrderAndAsksAfterEach) {
  FillUp();
  for (const LeaseId lease : {LeaseId(2), LeaseId(3), LeaseId(1)}) {
    EXPECT_EQ(worker_.state(), WorkerState::kWorking);
    const Actions actions = Handle(event::TaskEnded{lease});
    EXPECT_EQ(Only<action::ReportTask>(actions).lease, lease);
    EXPECT_EQ(Count<action::SendAsk>(actions), 1);
  }
  EXPECT_EQ(worker_.state(), WorkerState::kIdle);
}

TEST_F(LifecycleOfThreeTest, StopsTheRevokedTaskAlone) {
  FillUp();
  EXPECT_THAT(Handle(event::Revoked{LeaseId(2)}), ElementsAre(action::StopTask{LeaseId(2), "revoked"}));
  EXPECT_EQ(Only<action::ReportTask>(Handle(event::TaskEnded{LeaseId(1)})).lease, LeaseId(1));
  const Actions actions = Handle(event::TaskEnded{LeaseId(2)});
  EXPECT_EQ(Only<action::ReportTask>(actions).lease, LeaseId(2)) << "its end is waited for";
  EXPECT_THAT(Only<action::SendAsk>(actions).running, ElementsAre(LeaseId(3)));
}

TEST_F(LifecycleOfThreeTest, AnAskNamesWhatStillRunsAlsoIfRevoked) {
  FillUp();
  (void)Handle(event::Revoked{LeaseId(2)});
  EXPECT_THAT(Only<action::SendAsk>(Handle(event::TaskEnded{LeaseId(1)})).running, ElementsAre(LeaseId(2), LeaseId(3)));
}

TEST_F(LifecycleOfThreeTest, EachLeaseHasItsOwnTime) {
  FillUp();
  const std::uint64_t beat = 1;  // sent when it joined, before it had a task
  Pass(kHeartbeat);
  (void)Handle(event::HeartbeatAcked{beat, {}});
  const std::uint64_t second = Only<action::SendHeartbeat>(Tick()).heartbeat_id;
  (void)Handle(event::TaskEnded{LeaseId(3)});
  (void)Handle(event::Granted{LeaseId(9), 4});
  Pass(kLease / 2);
  (void)Handle(event::HeartbeatAcked{second, {LeaseId(1)}});  // renews 2, not 9
  EXPECT_EQ(Count<action::ReportTask>(Handle(event::TaskEnded{LeaseId(1)})), 1);
  Pass(kLease / 2);
  const Actions due = Tick();
  EXPECT_EQ(Count<action::StopTask>(due), 2);  // both: 2 was renewed by a beat of a lease ago, 9 by an ask as old
}

TEST_F(LifecycleOfThreeTest, NamesAllRunningLeasesWhenItRejoins) {
  FillUp();
  EXPECT_THAT(Only<action::SendHello>(Handle(event::Refused{Unavailable("say hello")})).running,
              ElementsAre(LeaseId(1), LeaseId(2), LeaseId(3)));
}

TEST_F(LifecycleOfThreeTest, LeavesWhenAllItsTasksHaveEnded) {
  FillUp();
  EXPECT_EQ(Count<action::StopTask>(Handle(event::StopRequested{})), 3);
  EXPECT_EQ(Count<action::Exit>(Handle(event::TaskEnded{LeaseId(1)})), 0);
  EXPECT_EQ(Count<action::Exit>(Handle(event::TaskEnded{LeaseId(3)})), 0);
  EXPECT_EQ(Count<action::Exit>(Handle(event::TaskEnded{LeaseId(2)})), 1);
}

}  // namespace
}  // namespace depthfarm
