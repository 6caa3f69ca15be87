#include "worker/artifacts/chunk_memory.h"

#include <gtest/gtest.h>

#include <optional>
#include <set>
#include <thread>
#include <vector>

namespace depthfarm {
namespace {

constexpr std::size_t kWhole = std::size_t{1} << 20;

TEST(ChunkMemory, GivesWhatAWholeChunkLeft) {
  ChunkMemory memory;
  std::optional<SharedBytes> sent = memory.Share(std::string(kWhole, 'x'));
  const char* const place = sent->view().data();
  EXPECT_EQ(sent->view(), std::string(kWhole, 'x'));
  const std::string other = memory.Take(kWhole).value();
  EXPECT_NE(other.data(), place) << "it is still being sent";
  sent.reset();
  const std::string again = memory.Take(kWhole).value();
  EXPECT_EQ(again.data(), place);
  EXPECT_EQ(again.size(), kWhole);
}

TEST(ChunkMemory, GivesAnySize) {
  ChunkMemory memory;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, kWhole - 1, kWhole, kWhole + 1}) {
    std::string bytes = memory.Take(size).value();
    EXPECT_EQ(bytes.size(), size);
    EXPECT_EQ(memory.Share(std::move(bytes)).size(), size);
  }
}

TEST(ChunkMemory, KeepsFourMebibytes) {
  ChunkMemory memory;
  std::set<const char*> left;
  {
    std::vector<SharedBytes> sent;
    for (int i = 0; i < 8; ++i) {
      sent.push_back(memory.Share(std::string(kWhole, 'x')));
      left.insert(sent.back().view().data());
    }
  }
  std::vector<std::string> taken;
  for (int i = 0; i < 4; ++i) {
    taken.push_back(memory.Take(kWhole).value());
    EXPECT_TRUE(left.contains(taken.back().data()));
    EXPECT_EQ(taken.back().front(), 'x') << "not set anew";
  }
  EXPECT_EQ(memory.Take(kWhole).value().front(), '\0');
}

TEST(ChunkMemory, EndsBeforeWhatItSharedAndTakesBackFromAnyThread) {
  std::optional<ChunkMemory> memory(std::in_place);
  SharedBytes sent = memory->Share(std::string(kWhole, 'x'));
  SharedBytes later = memory->Share(std::string(kWhole, 'y'));
  std::thread([bytes = std::move(sent)] { EXPECT_EQ(bytes.view().front(), 'x'); }).join();
  EXPECT_EQ(memory->Take(kWhole).value().front(), 'x');
  memory.reset();
  EXPECT_EQ(later.view().back(), 'y');
}

}  // namespace
}  // namespace depthfarm
