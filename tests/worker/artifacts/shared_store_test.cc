// Several stores on one folder: in one process, in threads, in processes, in processes that are killed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>
#include <thread>

#include "common/digest/sha256.h"
#include "tests/support/temporary_folder.h"
#include "worker/artifacts/store.h"
#include "worker/artifacts/store_file.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::uint64_t kPlenty = 1 << 20;
constexpr std::size_t kBytes = 1000;

ArtifactKey Key(int number) {
  ArtifactKey key{};
  key[0] = static_cast<std::uint8_t>(number);
  return key;
}
std::string Content(int number) { return std::string(kBytes, static_cast<char>('a' + number)); }
std::uint64_t RoomFor(std::uint64_t count) { return count * (kStoreFileHeaderBytes + kBytes); }

std::unique_ptr<ArtifactStore> OpenStore(const fs::path& folder, std::uint64_t max_bytes = kPlenty) {
  Result<std::unique_ptr<ArtifactStore>> store = ArtifactStore::Open(folder, max_bytes);
  EXPECT_TRUE(store.ok()) << store.status().message();
  return store.ok() ? std::move(*store) : nullptr;
}

fs::path FileOf(const fs::path& folder, const ArtifactKey& key) {
  const std::string name = Hex(key);
  return folder / name.substr(0, 1) / name;
}

// Bytes of the artifact files; what else is not `lock`, `pins` or `turns` is listed.
std::uint64_t BytesOnDisk(const fs::path& folder, std::vector<std::string>* others = nullptr) {
  std::uint64_t bytes = 0;
  for (const auto& file : fs::recursive_directory_iterator(folder)) {
    const std::string name = file.path().filename().string();
    const std::string parent = file.path().parent_path().filename().string();
    if (!file.is_regular_file() || name == "lock" || parent == "pins" || parent == "turns") continue;
    if (name.size() == 64) {
      bytes += file.file_size();
    } else if (others != nullptr) {
      others->push_back(name);
    }
  }
  return bytes;
}

class SharedStore : public testing::Test {
 protected:
  testing_support::TemporaryFolder folder_;
};

TEST_F(SharedStore, FindsWhatAnotherStoreMade) {
  const auto first = OpenStore(folder_.path());
  const auto second = OpenStore(folder_.path());
  const ArtifactInfo made = first->Put(Key(1), Content(1)).value();
  EXPECT_EQ(second->Find(Key(1)), made);
  EXPECT_EQ(second->Get(Key(1)).value(), Content(1));
  EXPECT_EQ(second->ReadChunk(Key(1), 990, 100).value().data.view(), std::string(10, 'b'));
  EXPECT_EQ(second->List().size(), 1U);
  EXPECT_EQ(second->total_bytes(), RoomFor(1));
  ASSERT_TRUE(second->Put(Key(1), Content(1)).ok());
  EXPECT_EQ(first->total_bytes(), RoomFor(1)) << "it counts once";
}

TEST_F(SharedStore, ReportsWhatAnotherStoreEvictedWhenItIsFoundMissing) {
  const auto first = OpenStore(folder_.path(), RoomFor(2));
  const auto second = OpenStore(folder_.path(), RoomFor(2));
  ASSERT_TRUE(first->Put(Key(1), Content(1)).ok());
  ASSERT_TRUE(first->Put(Key(2), Content(2)).ok());
  ASSERT_TRUE(second->Put(Key(3), Content(3)).ok());
  EXPECT_THAT(second->TakeDropped(), IsEmpty()) << "it never held that one";
  EXPECT_EQ(first->ReadChunk(Key(1), 0, 10).status().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(first->TakeDropped(), ElementsAre(Key(1)));
  EXPECT_TRUE(first->ReadChunk(Key(2), 0, 10).ok());
  EXPECT_THAT(first->TakeDropped(), IsEmpty());
}

TEST_F(SharedStore, DoesNotReportWhatIsThereAgain) {
  const auto first = OpenStore(folder_.path(), RoomFor(1));
  const auto second = OpenStore(folder_.path(), RoomFor(1));
  ASSERT_TRUE(first->Put(Key(1), Content(1)).ok());
  ASSERT_TRUE(second->Put(Key(2), Content(2)).ok());
  EXPECT_FALSE(first->Find(Key(1)).has_value());
  ASSERT_TRUE(second->Put(Key(1), Content(1)).ok());
  EXPECT_TRUE(first->Find(Key(1)).has_value());
  EXPECT_THAT(first->TakeDropped(), IsEmpty());
}

TEST_F(SharedStore, NeverEvictsWhatAnotherStorePins) {
  const auto first = OpenStore(folder_.path(), RoomFor(2));
  const auto second = OpenStore(folder_.path(), RoomFor(2));
  ArtifactPins pins = first->Pin({Key(1), Key(2)});
  ASSERT_TRUE(first->Put(Key(1), Content(1)).ok());
  ASSERT_TRUE(second->Put(Key(2), Content(2)).ok());
  EXPECT_EQ(second->Put(Key(3), Content(3)).status().code(), ErrorCode::kUnavailable);
  pins = {};
  EXPECT_TRUE(second->Put(Key(3), Content(3)).ok());
  EXPECT_FALSE(first->Find(Key(1)).has_value());
}

TEST_F(SharedStore, ForgetsThePinsOfAStoreThatIsClosed) {
  const auto second = OpenStore(folder_.path(), RoomFor(1));
  {
    const auto first = OpenStore(folder_.path(), RoomFor(1));
    ASSERT_TRUE(first->Put(Key(1), Content(1)).ok());
    const ArtifactPins pins = first->Pin({Key(1)});
    EXPECT_FALSE(second->Put(Key(2), Content(2)).ok());
  }
  EXPECT_TRUE(second->Put(Key(2), Content(2)).ok());
}

TEST_F(SharedStore, EvictsByTheUseOfAllStores) {
  const auto first = OpenStore(folder_.path(), RoomFor(3));
  const auto second = OpenStore(folder_.path(), RoomFor(3));
  for (int i = 1; i <= 3; ++i) ASSERT_TRUE(first->Put(Key(i), Content(i)).ok());
  ASSERT_TRUE(second->Get(Key(1)).ok());
  second->Release({Key(3)});
  EXPECT_TRUE(second->Find(Key(3)).has_value());
  second->Release({Key(3)});
  ASSERT_TRUE(first->Put(Key(4), Content(4)).ok());
  EXPECT_FALSE(second->Find(Key(3)).has_value());
  ASSERT_TRUE(first->Put(Key(5), Content(5)).ok());
  EXPECT_FALSE(second->Find(Key(2)).has_value());
  EXPECT_TRUE(second->Find(Key(1)).has_value());
}

TEST_F(SharedStore, EvictsLastWhatAnotherStoreKeeps) {
  const auto first = OpenStore(folder_.path(), RoomFor(3));
  const auto second = OpenStore(folder_.path(), RoomFor(3));
  for (int i = 1; i <= 3; ++i) ASSERT_TRUE(second->Put(Key(i), Content(i)).ok());
  ASSERT_TRUE(second->Put(Key(4), Content(4)).ok());  // it knows an order now, in which 2 is next
  first->Keep({Key(2), Key(9)});
  for (int i = 5; i <= 9; ++i) ASSERT_TRUE(second->Put(Key(i), Content(i)).ok());
  EXPECT_TRUE(second->Find(Key(2)).has_value());
  ASSERT_TRUE(second->Get(Key(2)).ok()) << "used, which does not make it one of the others";
  for (int i = 10; i <= 12; ++i) ASSERT_TRUE(second->Put(Key(i), Content(i)).ok());
  EXPECT_TRUE(second->Find(Key(2)).has_value());
  second->Keep({Key(11), Key(12)});
  ASSERT_TRUE(first->Put(Key(13), Content(13)).ok());
  EXPECT_FALSE(first->Find(Key(2)).has_value()) << "when all are kept the least recently used goes";
  ASSERT_TRUE(first->Put(Key(14), Content(14)).ok());
  EXPECT_FALSE(first->Find(Key(13)).has_value());
  EXPECT_TRUE(first->Find(Key(11)).has_value());
  EXPECT_TRUE(first->Find(Key(12)).has_value());
}

TEST_F(SharedStore, EvictsFirstWhatAnotherStoreReleased) {
  const auto first = OpenStore(folder_.path(), RoomFor(4));
  const auto second = OpenStore(folder_.path(), RoomFor(4));
  for (int i = 1; i <= 5; ++i) ASSERT_TRUE(second->Put(Key(i), Content(i)).ok());  // it knows an order now
  second->Keep({Key(4)});
  first->Release({Key(4), Key(5)});
  ASSERT_TRUE(second->Get(Key(4)).ok()) << "used, which does not make it one of the others";
  ASSERT_TRUE(second->Put(Key(6), Content(6)).ok());
  EXPECT_FALSE(first->Find(Key(5)).has_value());
  ASSERT_TRUE(second->Get(Key(4)).ok());
  ASSERT_TRUE(second->Put(Key(7), Content(7)).ok());
  EXPECT_FALSE(first->Find(Key(4)).has_value());
  EXPECT_TRUE(first->Find(Key(2)).has_value());
  EXPECT_TRUE(first->Find(Key(3)).has_value());
}

TEST_F(SharedStore, EvictsFirstWhatIsReleasedAndWasPinned) {
  const auto store = OpenStore(folder_.path(), RoomFor(4));
  for (int i = 1; i <= 4; ++i) ASSERT_TRUE(store->Put(Key(i), Content(i)).ok());
  store->Release({Key(4)});
  {
    const ArtifactPins pins = store->Pin({Key(4)});
    ASSERT_TRUE(store->Put(Key(5), Content(5)).ok());
    EXPECT_FALSE(store->Find(Key(1)).has_value());
  }
  ASSERT_TRUE(store->Put(Key(6), Content(6)).ok());
  EXPECT_FALSE(store->Find(Key(4)).has_value());
  EXPECT_TRUE(store->Find(Key(2)).has_value());
}

TEST_F(SharedStore, ForgetsWhatIsKeptWhenNobodyHasTheFolderOpen) {
  auto first = OpenStore(folder_.path(), RoomFor(2));
  auto second = OpenStore(folder_.path(), RoomFor(2));
  ASSERT_TRUE(first->Put(Key(1), Content(1)).ok());
  ASSERT_TRUE(first->Put(Key(2), Content(2)).ok());
  first->Keep({Key(1)});
  first.reset();
  first = OpenStore(folder_.path(), RoomFor(2));
  ASSERT_TRUE(first->Put(Key(3), Content(3)).ok());
  EXPECT_TRUE(first->Find(Key(1)).has_value()) << "the other one had it open";
  first.reset();
  second.reset();
  first = OpenStore(folder_.path(), RoomFor(2));
  ASSERT_TRUE(first->Put(Key(4), Content(4)).ok());
  EXPECT_FALSE(first->Find(Key(1)).has_value());
}

TEST_F(SharedStore, DropsWhatIsDamagedForAll) {
  const auto first = OpenStore(folder_.path());
  const auto second = OpenStore(folder_.path());
  ASSERT_TRUE(first->Put(Key(1), Content(1)).ok());
  std::fstream file(FileOf(folder_.path(), Key(1)), std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(kStoreFileHeaderBytes + 5);
  file.put('!');
  file.close();
  EXPECT_EQ(second->ReadChunk(Key(1), 0, 10).status().code(), ErrorCode::kCorrupt);
  EXPECT_EQ(first->Get(Key(1)).status().code(), ErrorCode::kUnavailable);
  EXPECT_EQ(first->total_bytes(), 0U);
}

TEST_F(SharedStore, LeavesWhatAnotherStoreIsWriting) {
  auto first = OpenStore(folder_.path());
  ASSERT_TRUE(first->Put(Key(1), Content(1)).ok());
  const fs::path being_written = FileOf(folder_.path(), Key(1)).string() + ".tmp-1-2";
  std::ofstream(being_written) << "half";
  auto second = OpenStore(folder_.path());
  EXPECT_TRUE(fs::exists(being_written));
  first.reset();
  second.reset();
  second = OpenStore(folder_.path());
  EXPECT_FALSE(fs::exists(being_written));
}

TEST_F(SharedStore, CountsAnewAfterAChangeThatNeverEnded) {
  const auto store = OpenStore(folder_.path());
  ASSERT_TRUE(store->Put(Key(1), Content(1)).ok());
  for (const char* sum : {"--------\x01", "", "DFSUM001"}) {
    std::ofstream(folder_.path() / "lock", std::ios::binary | std::ios::trunc) << sum;
    EXPECT_EQ(store->total_bytes(), RoomFor(1));
  }
}

TEST_F(SharedStore, FetchesInTurn) {
  const auto second = OpenStore(folder_.path());
  std::stop_source stop;
  std::atomic<bool> had = false;
  std::optional<FetchTurn> turn;
  turn.emplace(folder_.path(), Key(1), std::stop_token());
  (void)second->TakeFetchTurn(Key(2), {});
  std::thread waiting([&] {
    (void)second->TakeFetchTurn(Key(1), {});
    had = true;
  });
  std::thread stopped([&] { (void)second->TakeFetchTurn(Key(1), stop.get_token()); });
  stop.request_stop();
  stopped.join();
  EXPECT_FALSE(had);
  turn.reset();
  waiting.join();
}

// Stores, pins, reads, releases and keeps at random; returns how often something was wrong. The bound is three of eight
// artifacts, of which at most one is pinned at a time.
int Hammer(ArtifactStore& store, std::uint_fast32_t seed, int rounds) {
  int wrong = 0;
  std::mt19937 random(static_cast<std::uint32_t>(seed));
  for (int round = 0; round < rounds; ++round) {
    const int i = static_cast<int>(random() % 8);
    const auto dice = random() % 10;
    if (dice < 4) {
      const ArtifactPins pins = store.Pin({Key(i)});
      wrong += store.Put(Key(i), Content(i)).ok() ? 0 : 1;
      const Result<std::string> back = store.Get(Key(i));
      wrong += back.ok() && *back == Content(i) ? 0 : 1;
    } else if (dice < 9) {
      const Result<ArtifactChunk> chunk = store.ReadChunk(Key(i), 0, kBytes);
      if (chunk.ok() ? chunk->data.view() != Content(i) : chunk.status().code() != ErrorCode::kUnavailable) ++wrong;
    } else {
      if (random() % 2 == 0) {
        store.Release({Key(i)});
      } else {
        store.Keep({Key(i)});
      }
      wrong += store.total_bytes() <= RoomFor(3) ? 0 : 1;
      (void)store.TakeDropped();
    }
  }
  return wrong;
}

TEST_F(SharedStore, StandsThreadsOfTwoStores) {
  const auto first = OpenStore(folder_.path(), RoomFor(3));
  const auto second = OpenStore(folder_.path(), RoomFor(3));
  std::atomic<int> wrong = 0;
  std::thread other([&] { wrong += Hammer(*second, 1, 300); });
  wrong += Hammer(*first, 2, 300);
  other.join();
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(first->total_bytes(), BytesOnDisk(folder_.path()));
}

// A process that hammers the folder; its exit code is the number of wrongs.
pid_t StartHammer(const fs::path& folder, std::uint_fast32_t seed, int rounds) {
  const pid_t child = fork();
  if (child != 0) return child;
  auto store = ArtifactStore::Open(folder, RoomFor(3));
  _exit(store.ok() ? std::min(100, Hammer(**store, seed, rounds)) : 101);
}

TEST_F(SharedStore, StandsSeveralProcesses) {
  std::vector<pid_t> children;
  for (std::uint_fast32_t seed = 1; seed <= 2; ++seed) children.push_back(StartHammer(folder_.path(), seed, 500));
  for (const pid_t child : children) {
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  }
  const auto store = OpenStore(folder_.path(), RoomFor(3));
  EXPECT_LE(store->total_bytes(), RoomFor(3));
  EXPECT_EQ(store->total_bytes(), BytesOnDisk(folder_.path()));
}

TEST_F(SharedStore, StandsProcessesThatAreKilled) {
  auto store = OpenStore(folder_.path(), RoomFor(3));
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    const pid_t child = StartHammer(folder_.path(), random(), 1'000'000);
    std::this_thread::sleep_for(std::chrono::microseconds(2000 + random() % 20'000));
    EXPECT_EQ(Hammer(*store, random(), 10), 0);
    kill(child, SIGKILL);
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status)) << "it ended by itself: " << status;
    EXPECT_EQ(Hammer(*store, random(), 10), 0);
    EXPECT_EQ(store->total_bytes(), BytesOnDisk(folder_.path()));
  }
  store.reset();
  store = OpenStore(folder_.path(), RoomFor(3));
  std::vector<std::string> others;
  EXPECT_EQ(store->total_bytes(), BytesOnDisk(folder_.path(), &others));
  EXPECT_THAT(others, IsEmpty());
}

}  // namespace
}  // namespace depthfarm
