#include "worker/service/compute_pool.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <map>
#include <semaphore>

namespace depthfarm {
namespace {

using testing::ElementsAre;

// Tasks are told apart by their frame; each runs until the test lets it.
class ComputePoolTest : public testing::Test {
 protected:
  void Open(int slots) {
    pool_ = std::make_unique<ComputePool>(
        slots,
        [this](int slot, const LeasedTask& task, const std::stop_token& stop) { return Run(slot, task.spec, stop); },
        [this](const TaskSpec& spec, const std::stop_token& stop, const std::stop_token& enough) {
          Note("fetch " + std::to_string(spec.id.frame));
          std::unique_lock lock(mutex_);
          const std::stop_callback woken(enough, [this] { changed_.notify_all(); });
          const std::stop_callback stopped(stop, [this] { changed_.notify_all(); });
          if (fetches_stop_alone_) {
            changed_.wait(lock, [&] { return enough.stop_requested(); });
            lock.unlock();
            Note("enough " + std::to_string(spec.id.frame));
            lock.lock();
            changed_.wait(lock, [&] { return stop.stop_requested(); });
          }
          changed_.wait(lock, [&] { return !fetches_wait_ || enough.stop_requested(); });
          return FetchedAhead{.bytes = 7, .pins = {}};
        },
        [this] { outcomes_.release(); });
  }
  TaskOutcome Run(int slot, const TaskSpec& spec, const std::stop_token& stop) {
    EXPECT_EQ(running_in_[static_cast<std::size_t>(slot)]++, 0) << "a slot runs one task at a time";
    Note("run " + std::to_string(spec.id.frame));
    std::unique_lock lock(mutex_);
    const std::stop_callback woken(stop, [this] { changed_.notify_all(); });
    changed_.wait(lock, [&] { return free_.contains(spec.id.frame) || stop.stop_requested(); });
    --running_in_[static_cast<std::size_t>(slot)];
    TaskOutcome outcome;
    if (!free_.contains(spec.id.frame)) outcome.status = Cancelled();
    return outcome;
  }
  std::shared_ptr<LeaseTerm> Start(int frame) {
    const auto term = std::make_shared<LeaseTerm>(LeaseTerm::Time::max());
    LeasedTask task{LeaseId(static_cast<std::uint64_t>(frame)), {}, std::make_shared<JobConfig>(), term};
    task.spec.id.frame = frame;
    pool_->Start(std::move(task));
    return term;
  }
  void Free(int frame) {
    const std::scoped_lock lock(mutex_);
    free_.insert(frame);
    changed_.notify_all();
  }
  void Note(std::string what) {
    const std::scoped_lock lock(mutex_);
    notes_.push_back(std::move(what));
    changed_.notify_all();
  }
  std::vector<std::string> AwaitNotes(std::size_t count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return notes_.size() >= count; });
    return notes_;
  }
  LeasedOutcome NextOutcome() {
    outcomes_.acquire();
    return pool_->TakeOutcome().value();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<int> free_;
  bool fetches_wait_ = false;
  bool fetches_stop_alone_ = false;  // they are slow to see that a slot waits for them
  std::vector<std::string> notes_;
  std::array<std::atomic<int>, 4> running_in_{};
  std::counting_semaphore<> outcomes_{0};
  std::unique_ptr<ComputePool> pool_;
};

TEST_F(ComputePoolTest, FetchesForATaskThatWaitsAndRunsItNext) {
  Open(1);
  Start(1);
  (void)AwaitNotes(1);
  Start(2);
  EXPECT_THAT(AwaitNotes(2), ElementsAre("run 1", "fetch 2"));
  Free(1);
  Free(2);
  EXPECT_EQ(NextOutcome().outcome.stats.fetched_bytes, 0U);
  const LeasedOutcome second = NextOutcome();
  EXPECT_EQ(second.lease, LeaseId(2));
  EXPECT_EQ(second.outcome.stats.fetched_bytes, 7U);
  EXPECT_FALSE(pool_->busy());
}

TEST_F(ComputePoolTest, RunsTasksInOrderAlsoIfOneIsFetchedFor) {
  fetches_wait_ = true;
  Open(1);
  Start(1);
  (void)AwaitNotes(1);
  Start(2);
  (void)AwaitNotes(2);
  Start(3);
  Free(1);  // the slot asks that the fetch for 2 ends, and does not take 3
  Free(2);
  Free(3);
  for (const std::uint64_t lease : {1, 2, 3}) EXPECT_EQ(NextOutcome().lease, LeaseId(lease));
}

TEST_F(ComputePoolTest, DoesNotBeginATaskWhoseLeaseRanOutWhileItWaited) {
  Open(1);
  Start(1);
  (void)AwaitNotes(1);
  Start(2)->Set({});
  (void)AwaitNotes(2);
  Free(1);
  EXPECT_TRUE(NextOutcome().outcome.status.ok());
  EXPECT_EQ(NextOutcome().outcome.status.code(), ErrorCode::kLeaseExpired);
  EXPECT_THAT(AwaitNotes(2), ElementsAre("run 1", "fetch 2"));
}

TEST_F(ComputePoolTest, RunsAsManyAsItHasSlots) {
  Open(2);
  Start(1);
  Start(2);
  EXPECT_THAT(AwaitNotes(2), testing::UnorderedElementsAre("run 1", "run 2"));
  Free(2);
  EXPECT_EQ(NextOutcome().lease, LeaseId(2));
  EXPECT_TRUE(pool_->busy());
  Free(1);
  EXPECT_EQ(NextOutcome().lease, LeaseId(1));
}

TEST_F(ComputePoolTest, StopsTheTaskThatRunsAlone) {
  Open(2);
  Start(1);
  Start(2);
  (void)AwaitNotes(2);
  pool_->Stop(LeaseId(1));
  const LeasedOutcome stopped = NextOutcome();
  EXPECT_EQ(stopped.lease, LeaseId(1));
  EXPECT_EQ(stopped.outcome.status.code(), ErrorCode::kCancelled);
  Free(2);
  EXPECT_TRUE(NextOutcome().outcome.status.ok());
}

TEST_F(ComputePoolTest, ATaskThatWaitsEndsAtOnceWhenItIsStopped) {
  Open(1);
  Start(1);
  (void)AwaitNotes(1);
  Start(2);
  (void)AwaitNotes(2);
  Start(3);
  (void)AwaitNotes(3);
  pool_->Stop(LeaseId(3));
  const LeasedOutcome stopped = NextOutcome();
  EXPECT_EQ(stopped.lease, LeaseId(3));
  EXPECT_EQ(stopped.outcome.status.code(), ErrorCode::kCancelled);
  pool_->Stop(LeaseId(9));  // nobody's
  Free(1);
  Free(2);
  EXPECT_EQ(NextOutcome().lease, LeaseId(1));
  EXPECT_EQ(NextOutcome().lease, LeaseId(2));
}

TEST_F(ComputePoolTest, GivesBackWhatNoSlotHasBegun) {
  Open(1);
  Start(1);
  (void)AwaitNotes(1);
  Start(2);
  (void)AwaitNotes(2);
  Start(3);
  (void)AwaitNotes(3);
  EXPECT_FALSE(pool_->GiveBack(LeaseId(1))) << "it runs";
  EXPECT_FALSE(pool_->GiveBack(LeaseId(9))) << "nobody's";
  EXPECT_TRUE(pool_->GiveBack(LeaseId(2)));
  const LeasedOutcome given_back = NextOutcome();
  EXPECT_EQ(given_back.lease, LeaseId(2));
  EXPECT_EQ(given_back.outcome.status.code(), ErrorCode::kCancelled);
  EXPECT_FALSE(pool_->GiveBack(LeaseId(2))) << "it is over";
  Free(1);
  Free(3);
  EXPECT_TRUE(NextOutcome().outcome.status.ok());
  EXPECT_EQ(NextOutcome().lease, LeaseId(3));
  EXPECT_THAT(AwaitNotes(4), ElementsAre("run 1", "fetch 2", "fetch 3", "run 3"));
}

TEST_F(ComputePoolTest, ASlotThatWaitedForWhatIsGivenBackTakesTheNext) {
  fetches_stop_alone_ = true;
  Open(1);
  Start(1);
  (void)AwaitNotes(1);
  Start(2);
  (void)AwaitNotes(2);
  Start(3);
  Free(1);
  EXPECT_EQ(NextOutcome().lease, LeaseId(1));
  EXPECT_EQ(AwaitNotes(3).back(), "enough 2");  // the slot waits by now
  EXPECT_TRUE(pool_->GiveBack(LeaseId(2)));
  EXPECT_EQ(NextOutcome().outcome.status.code(), ErrorCode::kCancelled);
  Free(3);
  EXPECT_EQ(NextOutcome().lease, LeaseId(3));
}

TEST_F(ComputePoolTest, EndsWithTasksUnderWay) {
  Open(2);
  for (int frame = 1; frame <= 5; ++frame) Start(frame);
  (void)AwaitNotes(2);
  pool_.reset();
}

}  // namespace
}  // namespace depthfarm
