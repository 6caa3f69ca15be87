#include "worker/execution/fetch_once.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.h"
#include "worker/artifacts/artifact_digest.h"
#include "worker/execution/fetch_ahead.h"

namespace depthfarm {
namespace {

const std::string kBytes = "the artifact";

TaskInput Input() { return {{ArtifactKey{1}, kBytes.size(), DigestOfArtifact(kBytes)}, InputRole::kLabels, 0, {}}; }

// Another worker that takes its time.
class SlowFetcher : public ArtifactFetcher {
 public:
  [[nodiscard]] Result<std::string> Fetch(const TaskInput&, const std::stop_token& stop) override {
    ++fetches;
    while (held && !stop.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (stop.stop_requested()) return Cancelled();
    return kBytes;
  }
  std::atomic<int> fetches = 0;
  std::atomic<bool> held = false;
};

class FetchOnceTest : public testing::Test {
 protected:
  Result<Fetched> Fetch(const std::stop_token& stop = {}) { return FetchOnce(*store_, fetcher_, Input(), stop); }
  void AwaitFetch() const {
    while (fetcher_.fetches == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

  testing_support::TemporaryFolder folder_;
  std::unique_ptr<ArtifactStore> store_ = ArtifactStore::Open(folder_.path(), 1 << 20).value();
  SlowFetcher fetcher_;
};

TEST_F(FetchOnceTest, StoresWhatItFetched) {
  const Fetched first = Fetch().value();
  EXPECT_EQ(first.artifact, kBytes);
  EXPECT_EQ(first.fetched_bytes, kBytes.size());
  EXPECT_EQ(store_->Find(ArtifactKey{1}), Input().artifact);
  const Fetched second = Fetch().value();
  EXPECT_EQ(second.artifact, kBytes);
  EXPECT_EQ(second.fetched_bytes, 0U);
  EXPECT_EQ(fetcher_.fetches, 1);
}

TEST_F(FetchOnceTest, BytesThatSeveralThreadsWantComeAndCountOnce) {
  fetcher_.held = true;
  std::atomic<std::uint64_t> bytes = 0;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 3; ++i) {
      threads.emplace_back([&] {
        const Fetched fetched = Fetch().value();
        EXPECT_EQ(fetched.artifact, kBytes);
        bytes += fetched.fetched_bytes;
      });
    }
    threads.emplace_back([&] { bytes += FetchIntoStore(*store_, fetcher_, Input(), {}); });
    AwaitFetch();
    fetcher_.held = false;
  }
  EXPECT_EQ(bytes, kBytes.size());
  EXPECT_EQ(fetcher_.fetches, 1);
}

TEST_F(FetchOnceTest, WhoWaitsForAnothersFetchStopsWhenAsked) {
  fetcher_.held = true;
  std::jthread first([&] { EXPECT_TRUE(Fetch().ok()); });
  AwaitFetch();
  std::stop_source stop;
  std::thread second([&] { EXPECT_EQ(Fetch(stop.get_token()).status().code(), ErrorCode::kCancelled); });
  stop.request_stop();
  second.join();
  EXPECT_EQ(fetcher_.fetches, 1);
  fetcher_.held = false;
}

TEST_F(FetchOnceTest, BytesThatTwoStoresOfOneFolderWantComeAndCountOnce) {
  const auto other_store = ArtifactStore::Open(folder_.path(), 1 << 20).value();
  SlowFetcher other_fetcher;
  fetcher_.held = true;
  std::atomic<std::uint64_t> bytes = 0;
  {
    std::jthread first([&] { bytes += Fetch().value().fetched_bytes; });
    AwaitFetch();
    std::stop_source stop;
    std::thread stopped([&] {
      const Result<Fetched> fetched = FetchOnce(*other_store, other_fetcher, Input(), stop.get_token());
      EXPECT_EQ(fetched.status().code(), ErrorCode::kCancelled);
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(5));  // most likely it waits by then
    stop.request_stop();
    stopped.join();
    std::jthread second([&] {
      const Fetched fetched = FetchOnce(*other_store, other_fetcher, Input(), {}).value();
      EXPECT_EQ(fetched.artifact, kBytes);
      bytes += fetched.fetched_bytes;
    });
    fetcher_.held = false;
  }
  EXPECT_EQ(bytes, kBytes.size());
  EXPECT_EQ(fetcher_.fetches + other_fetcher.fetches, 1);
}

TEST_F(FetchOnceTest, FetchesWhenTheStoreHasOtherBytesOfThatKeyOrNoRoom) {
  ASSERT_TRUE(store_->Put(ArtifactKey{1}, "something else").ok());
  EXPECT_EQ(Fetch().value().fetched_bytes, kBytes.size());
  EXPECT_EQ(store_->Get(ArtifactKey{1}).value(), kBytes);

  const testing_support::TemporaryFolder folder;
  const auto small = ArtifactStore::Open(folder.path(), 10).value();
  const Result<Fetched> fetched = FetchOnce(*small, fetcher_, Input(), {});
  ASSERT_TRUE(fetched.ok()) << fetched.status().message();
  EXPECT_EQ(fetched->artifact, kBytes);
  EXPECT_FALSE(small->Find(ArtifactKey{1}).has_value());
}

}  // namespace
}  // namespace depthfarm
