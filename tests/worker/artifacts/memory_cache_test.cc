#include "worker/artifacts/memory_cache.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

ArtifactKey Key(int number) {
  ArtifactKey key{};
  key[0] = static_cast<std::uint8_t>(number);
  return key;
}

std::shared_ptr<const LabelField> Labels(std::size_t segments) {
  LabelField field;
  field.views.push_back({std::vector<Level>(segments), std::vector<std::uint8_t>(segments)});
  return std::make_shared<const LabelField>(std::move(field));
}

std::shared_ptr<const ViewAnalysis> Analysis(int width, int height) {
  ViewAnalysis analysis;
  analysis.picture = YcbcrImage(width, height);
  analysis.segments.labels = Grid<SegmentIndex>(width, height);
  return std::make_shared<const ViewAnalysis>(std::move(analysis));
}

TEST(MemoryCache, SharesOneObject) {
  MemoryCache cache(1 << 20);
  const auto field = Labels(10);
  cache.Put(Key(1), field);
  EXPECT_EQ(cache.Find<LabelField>(Key(1)), field);
  EXPECT_EQ(cache.total_bytes(), MemoryBytes(*field));
}

TEST(MemoryCache, CountsEveryPlaneOfAnAnalysis) {
  EXPECT_GE(MemoryBytes(*Analysis(100, 50)), 100 * 50 * (sizeof(Ycbcr) + sizeof(SegmentIndex)));
}

TEST(MemoryCache, DropsTheLeastRecentlyUsed) {
  const std::uint64_t one = MemoryBytes(*Labels(1000));
  MemoryCache cache(2 * one);
  cache.Put(Key(1), Labels(1000));
  cache.Put(Key(2), Labels(1000));
  EXPECT_NE(cache.Find<LabelField>(Key(1)), nullptr);
  cache.Put(Key(3), Labels(1000));
  EXPECT_EQ(cache.Find<LabelField>(Key(2)), nullptr);
  EXPECT_NE(cache.Find<LabelField>(Key(1)), nullptr);
  EXPECT_NE(cache.Find<LabelField>(Key(3)), nullptr);
  EXPECT_EQ(cache.total_bytes(), 2 * one);
}

TEST(MemoryCache, DoesNotKeepWhatExceedsItsBoundAndKeepsTheRest) {
  MemoryCache cache(MemoryBytes(*Labels(1000)));
  cache.Put(Key(1), Labels(1000));
  cache.Put(Key(2), Labels(2000));
  EXPECT_EQ(cache.Find<LabelField>(Key(2)), nullptr);
  EXPECT_NE(cache.Find<LabelField>(Key(1)), nullptr);
}

TEST(MemoryCache, AnObjectInUseOutlivesItsEviction) {
  MemoryCache cache(MemoryBytes(*Labels(1000)));
  cache.Put(Key(1), Labels(1000));
  const auto used = cache.Find<LabelField>(Key(1));
  cache.Put(Key(2), Labels(1000));
  EXPECT_EQ(used->views[0].levels.size(), 1000);
}

TEST(MemoryCache, TakesAKeyForOneKindOfObjectOnly) {
  MemoryCache cache(1 << 20);
  cache.Put(Key(1), Analysis(4, 4));
  EXPECT_EQ(cache.Find<LabelField>(Key(1)), nullptr);
  EXPECT_NE(cache.Find<ViewAnalysis>(Key(1)), nullptr);
  cache.Put(Key(1), Labels(5));
  EXPECT_EQ(cache.Find<ViewAnalysis>(Key(1)), nullptr);
  EXPECT_EQ(cache.total_bytes(), MemoryBytes(*Labels(5)));
}

TEST(MemoryCache, CanBeTurnedOff) {
  MemoryCache cache(0);
  cache.Put(Key(1), Labels(1));
  EXPECT_EQ(cache.Find<LabelField>(Key(1)), nullptr);
  EXPECT_EQ(cache.total_bytes(), 0);
}

}  // namespace
}  // namespace depthfarm
