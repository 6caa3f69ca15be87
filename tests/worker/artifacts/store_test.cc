#include "worker/artifacts/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "tests/support/temporary_folder.h"
#include "worker/artifacts/artifact_digest.h"
#include "worker/artifacts/store_file.h"

namespace depthfarm {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t kPlenty = 1 << 20;

ArtifactKey Key(int number) {
  ArtifactKey key{};
  key[0] = static_cast<std::uint8_t>(number);
  key[31] = 7;
  return key;
}

// Room for exactly `count` artifacts of `bytes` bytes.
std::uint64_t RoomFor(std::uint64_t count, std::uint64_t bytes) { return count * (kStoreFileHeaderBytes + bytes); }

std::vector<ArtifactKey> Keys(ArtifactStore& store) {
  std::vector<ArtifactKey> keys;
  for (const ArtifactInfo& info : store.List()) keys.push_back(info.key);
  return keys;
}

class ArtifactStoreTest : public testing::Test {
 protected:
  void Open(std::uint64_t max_bytes) {
    store_.reset();
    Result<std::unique_ptr<ArtifactStore>> store = ArtifactStore::Open(folder_.path(), max_bytes);
    ASSERT_TRUE(store.ok()) << store.status().message();
    store_ = std::move(*store);
  }
  fs::path FileOf(const ArtifactKey& key) const {
    const std::string name = Hex(key);
    return folder_.path() / name.substr(0, 1) / name;
  }
  void DamageByte(const ArtifactKey& key, std::streamoff offset) {
    std::fstream file(FileOf(key), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(offset);
    file.put('\x55');
    ASSERT_TRUE(file.good());
  }

  testing_support::TemporaryFolder folder_;
  std::unique_ptr<ArtifactStore> store_;
};

TEST_F(ArtifactStoreTest, GivesBackWhatWasPut) {
  Open(kPlenty);
  const std::string artifact("a\0b", 3);
  const Result<ArtifactInfo> put = store_->Put(Key(1), artifact);
  ASSERT_TRUE(put.ok());
  EXPECT_EQ(*put, (ArtifactInfo{Key(1), 3, DigestOfArtifact(artifact)}));
  EXPECT_EQ(store_->Get(Key(1)).value(), artifact);
  EXPECT_EQ(store_->Find(Key(1)), *put);
  EXPECT_EQ(store_->Get(Key(2)).status().code(), ErrorCode::kUnavailable);
}

TEST_F(ArtifactStoreTest, KeepsWhatItsCallerHasVerifiedUnderThatDigest) {
  Open(kPlenty);
  const ArtifactInfo info{Key(1), 3, DigestOfArtifact("one")};
  ASSERT_TRUE(store_->PutVerified(info, "one").ok());
  EXPECT_EQ(store_->Find(Key(1)), info);
  EXPECT_EQ(store_->Get(Key(1)).value(), "one");
  // A caller that was wrong is found out.
  ASSERT_TRUE(store_->PutVerified({Key(2), 3, DigestOfArtifact("one")}, "two").ok());
  EXPECT_EQ(store_->Get(Key(2)).status().code(), ErrorCode::kCorrupt);
}

TEST_F(ArtifactStoreTest, KeepsTheFileOfWhatIsPutAgain) {
  Open(kPlenty);
  const ArtifactInfo info{Key(1), 3, DigestOfArtifact("one")};
  ASSERT_TRUE(store_->PutVerified(info, "one").ok());
  ASSERT_TRUE(store_->PutVerified(info, "one, which is not read again").ok());
  EXPECT_EQ(store_->Get(Key(1)).value(), "one");
  EXPECT_TRUE(store_->TakeDropped().empty());
}

TEST_F(ArtifactStoreTest, KeepsAnEmptyArtifact) {
  Open(kPlenty);
  ASSERT_TRUE(store_->Put(Key(1), "").ok());
  EXPECT_EQ(store_->Get(Key(1)).value(), "");
  EXPECT_EQ(store_->ReadChunk(Key(1), 0, 10).value().data.view(), "");
}

TEST_F(ArtifactStoreTest, SurvivesARestart) {
  Open(kPlenty);
  ASSERT_TRUE(store_->Put(Key(1), "one").ok());
  ASSERT_TRUE(store_->Put(Key(2), "two").ok());
  const std::vector<ArtifactInfo> before = store_->List();
  Open(kPlenty);
  EXPECT_EQ(store_->List(), before);
  EXPECT_EQ(store_->Get(Key(2)).value(), "two");
  EXPECT_EQ(store_->total_bytes(), 2 * (kStoreFileHeaderBytes + 3));
}

TEST_F(ArtifactStoreTest, RemovesWhatAKilledWorkerLeftButNothingElse) {
  Open(kPlenty);
  ASSERT_TRUE(store_->Put(Key(1), "one").ok());
  const fs::path leftover = FileOf(Key(1)).string() + ".tmp-1-2";
  std::ofstream(leftover) << "half";
  const fs::path foreign = folder_.path() / "notes.tmp";
  std::ofstream(foreign) << "mine";
  Open(kPlenty);
  EXPECT_FALSE(fs::exists(leftover));
  EXPECT_TRUE(fs::exists(foreign));
  EXPECT_THAT(Keys(*store_), ElementsAre(Key(1)));
}

TEST_F(ArtifactStoreTest, FindsWhatEarlierVersionsStoredInFoldersOfTwoBytes) {
  Open(kPlenty);
  const ArtifactInfo stored = store_->Put(Key(1), "one").value();
  store_.reset();
  const std::string name = Hex(Key(1));
  const fs::path first_byte = folder_.path() / name.substr(0, 2);
  fs::create_directories(first_byte / name.substr(2, 2));
  fs::rename(FileOf(Key(1)), first_byte / name.substr(2, 2) / name);
  Open(kPlenty);
  EXPECT_EQ(store_->Find(Key(1)), stored);
  EXPECT_EQ(store_->Get(Key(1)).value(), "one");
  EXPECT_EQ(store_->total_bytes(), RoomFor(1, 3));
  EXPECT_FALSE(fs::exists(first_byte));
}

TEST_F(ArtifactStoreTest, DropsATruncatedFileAtStart) {
  Open(kPlenty);
  ASSERT_TRUE(store_->Put(Key(1), "a longer artifact").ok());
  store_.reset();
  fs::resize_file(FileOf(Key(1)), kStoreFileHeaderBytes + 5);
  Open(kPlenty);
  EXPECT_THAT(store_->List(), IsEmpty());
  EXPECT_FALSE(fs::exists(FileOf(Key(1))));
  EXPECT_EQ(store_->total_bytes(), 0);
}

TEST_F(ArtifactStoreTest, DropsAndReportsADamagedFileWhenItIsReadInWhole) {
  Open(kPlenty);
  ASSERT_TRUE(store_->Put(Key(1), "artifact").ok());
  DamageByte(Key(1), kStoreFileHeaderBytes + 2);
  EXPECT_EQ(store_->Get(Key(1)).status().code(), ErrorCode::kCorrupt);
  EXPECT_THAT(store_->TakeDropped(), ElementsAre(Key(1)));
  EXPECT_EQ(store_->Get(Key(1)).status().code(), ErrorCode::kUnavailable);
}

TEST_F(ArtifactStoreTest, ChecksTheDigestBeforeTheFirstChunkAfterARestart) {
  Open(kPlenty);
  ASSERT_TRUE(store_->Put(Key(1), "artifact").ok());
  DamageByte(Key(1), kStoreFileHeaderBytes + 7);
  Open(kPlenty);
  EXPECT_EQ(store_->ReadChunk(Key(1), 0, 2).status().code(), ErrorCode::kCorrupt);
  EXPECT_THAT(store_->TakeDropped(), ElementsAre(Key(1)));
}

TEST_F(ArtifactStoreTest, ReportsAnArtifactWhoseFileVanished) {
  Open(kPlenty);
  ASSERT_TRUE(store_->Put(Key(1), "artifact").ok());
  fs::remove(FileOf(Key(1)));
  EXPECT_EQ(store_->Get(Key(1)).status().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(store_->TakeDropped(), ElementsAre(Key(1)));
}

TEST_F(ArtifactStoreTest, ChunksJoinToTheArtifact) {
  Open(kPlenty);
  const std::string artifact = "0123456789";
  ASSERT_TRUE(store_->Put(Key(1), artifact).ok());
  std::string joined;
  for (std::uint64_t offset = 0; offset < artifact.size(); offset += 4) {
    const ArtifactChunk chunk = store_->ReadChunk(Key(1), offset, 4).value();
    EXPECT_EQ(chunk.total_bytes, artifact.size());
    joined += chunk.data.view();
  }
  EXPECT_EQ(joined, artifact);
  EXPECT_EQ(store_->ReadChunk(Key(1), 10, 4).value().data.view(), "");
  EXPECT_EQ(store_->ReadChunk(Key(1), 11, 4).status().code(), ErrorCode::kInvalidArgument);
}

TEST_F(ArtifactStoreTest, EvictsTheLeastRecentlyUsedAndReportsIt) {
  Open(RoomFor(3, 4));
  for (int i = 1; i <= 3; ++i) ASSERT_TRUE(store_->Put(Key(i), "data").ok());
  ASSERT_TRUE(store_->Get(Key(1)).ok());
  ASSERT_TRUE(store_->Put(Key(4), "data").ok());
  EXPECT_THAT(Keys(*store_), ElementsAre(Key(1), Key(3), Key(4)));
  EXPECT_THAT(store_->TakeDropped(), ElementsAre(Key(2)));
  EXPECT_THAT(store_->TakeDropped(), IsEmpty());
  EXPECT_FALSE(fs::exists(FileOf(Key(2))));
}

TEST_F(ArtifactStoreTest, EvictsReleasedArtifactsFirst) {
  Open(RoomFor(3, 4));
  for (int i = 1; i <= 3; ++i) ASSERT_TRUE(store_->Put(Key(i), "data").ok());
  store_->Release({Key(3), Key(9)});
  ASSERT_TRUE(store_->Put(Key(4), "data").ok());
  EXPECT_THAT(Keys(*store_), ElementsAre(Key(1), Key(2), Key(4)));
}

TEST_F(ArtifactStoreTest, WhatIsKeptNoMoreGoesInItsTurn) {
  Open(RoomFor(3, 4));
  for (int i = 1; i <= 3; ++i) ASSERT_TRUE(store_->Put(Key(i), "data").ok());
  store_->Keep({Key(1), Key(2)});
  store_->KeepNone();
  store_->Keep({Key(2)});
  ASSERT_TRUE(store_->Put(Key(4), "data").ok());
  EXPECT_THAT(Keys(*store_), ElementsAre(Key(2), Key(3), Key(4)));
}

TEST_F(ArtifactStoreTest, EvictsKeptArtifactsLast) {
  Open(RoomFor(3, 4));
  for (int i = 1; i <= 3; ++i) ASSERT_TRUE(store_->Put(Key(i), "data").ok());
  store_->Keep({Key(1), Key(2), Key(9)});
  ASSERT_TRUE(store_->Put(Key(4), "data").ok());
  EXPECT_THAT(Keys(*store_), ElementsAre(Key(1), Key(2), Key(4)));
  store_->Keep({Key(4)});
  ASSERT_TRUE(store_->Put(Key(5), "data").ok());
  EXPECT_THAT(Keys(*store_), ElementsAre(Key(2), Key(4), Key(5))) << "the least recently used of those that are kept";
  store_->Release({Key(4)});
  ASSERT_TRUE(store_->Put(Key(6), "data").ok());
  EXPECT_THAT(Keys(*store_), ElementsAre(Key(2), Key(5), Key(6)));
  ASSERT_TRUE(store_->Put(Key(2), "more").ok());  // replaced, and counted once
  EXPECT_EQ(store_->Get(Key(2)).value(), "more");
}

TEST_F(ArtifactStoreTest, NeverEvictsWhatIsPinned) {
  Open(RoomFor(2, 4));
  ArtifactPins pins = store_->Pin({Key(1), Key(2), Key(1)});  // before they are stored
  ASSERT_TRUE(store_->Put(Key(1), "data").ok());
  ASSERT_TRUE(store_->Put(Key(2), "data").ok());
  store_->Release({Key(1)});
  const auto refused = store_->Put(Key(3), "data");
  EXPECT_EQ(refused.status().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(refused.status().message(), HasSubstr("--cache-size"));
  pins = {};
  ASSERT_TRUE(store_->Put(Key(3), "data").ok());
  EXPECT_THAT(Keys(*store_), ElementsAre(Key(2), Key(3)));
}

TEST_F(ArtifactStoreTest, RefusesWhatCanNeverFitWithoutEvictingForIt) {
  Open(RoomFor(2, 4));
  ASSERT_TRUE(store_->Put(Key(1), "data").ok());
  EXPECT_EQ(store_->Put(Key(2), std::string(1000, 'x')).status().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(Keys(*store_), ElementsAre(Key(1)));
}

TEST_F(ArtifactStoreTest, ASmallerBoundAfterARestartEvictsTheOldest) {
  Open(kPlenty);
  for (int i = 1; i <= 3; ++i) {
    ASSERT_TRUE(store_->Put(Key(i), "data").ok());
    fs::last_write_time(FileOf(Key(i)), fs::file_time_type(std::chrono::hours(24 * 365 * 40 - i)));
  }
  Open(RoomFor(1, 4));
  EXPECT_THAT(Keys(*store_), ElementsAre(Key(1)));
  EXPECT_THAT(store_->TakeDropped(), IsEmpty());
}

TEST_F(ArtifactStoreTest, APutReplacesAndCountsOnce) {
  Open(kPlenty);
  ASSERT_TRUE(store_->Put(Key(1), "old artifact").ok());
  ASSERT_TRUE(store_->Put(Key(1), "new").ok());
  EXPECT_EQ(store_->Get(Key(1)).value(), "new");
  EXPECT_EQ(store_->total_bytes(), kStoreFileHeaderBytes + 3);
}

TEST_F(ArtifactStoreTest, NeverExceedsItsBound) {
  const std::uint64_t bound = 5000;
  Open(bound);
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    const std::string artifact(random() % 900, 'x');
    ASSERT_TRUE(store_->Put(Key(static_cast<int>(random() % 40)), artifact).ok());
    ASSERT_LE(store_->total_bytes(), bound);
  }
  std::uint64_t on_disk = 0;
  for (const auto& file : fs::recursive_directory_iterator(folder_.path())) {
    const bool artifact = file.path().filename().string().size() == 2 * sizeof(ArtifactKey);
    if (file.is_regular_file() && artifact) on_disk += file.file_size();
  }
  EXPECT_EQ(on_disk, store_->total_bytes());
}

TEST_F(ArtifactStoreTest, ServesChunksWhileAnotherThreadStoresAndEvicts) {
  Open(RoomFor(4, 1000));
  std::atomic<bool> done = false;
  std::atomic<int> wrong = 0;
  const auto content = [](int i) { return std::string(1000, static_cast<char>('a' + i)); };
  std::thread server([&] {
    std::mt19937 random(2);
    do {
      const int i = static_cast<int>(random() % 8);
      const Result<ArtifactChunk> chunk = store_->ReadChunk(Key(i), 0, 1000);
      if (chunk.ok() && chunk->data.view() != content(i)) ++wrong;
      if (!chunk.ok() && chunk.status().code() != ErrorCode::kUnavailable) ++wrong;
    } while (!done);
  });
  for (int round = 0; round < 50; ++round) {
    for (int i = 0; i < 8; ++i) {
      const ArtifactPins pins = store_->Pin({Key(i)});
      EXPECT_TRUE(store_->Put(Key(i), content(i)).ok());
      EXPECT_TRUE(store_->Get(Key(i)).ok());
    }
    (void)store_->TakeDropped();
  }
  done = true;
  server.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace depthfarm
