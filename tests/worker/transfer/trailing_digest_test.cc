#include "worker/transfer/trailing_digest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "worker/artifacts/artifact_digest.h"

namespace depthfarm {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPatience{60'000};

std::string Bytes(std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 7 + i / 256);
  return bytes;
}

TEST(TrailingDigest, IsThatOfTheWholeHoweverItComes) {
  const std::string bytes = Bytes((std::size_t{2} << 20) + 17);
  for (const std::size_t step : {std::size_t{1000}, std::size_t{1} << 20, bytes.size()}) {
    std::string place(bytes.size(), '\0');
    const auto digest = TrailingDigest::Start(place.data(), place.size());
    ASSERT_NE(digest, nullptr);
    for (std::size_t at = 0; at < bytes.size(); at += step) {
      const std::size_t end = std::min(at + step, bytes.size());
      std::copy(bytes.data() + at, bytes.data() + end, place.data() + at);
      digest->Advance(end);
    }
    EXPECT_EQ(digest->Wait(kPatience), DigestOfArtifact(bytes));
    EXPECT_EQ(digest->Wait(milliseconds(0)), DigestOfArtifact(bytes)) << "asked again";
  }
}

TEST(TrailingDigest, IsNotThereBeforeTheLastByte) {
  const std::string bytes = Bytes(3000);
  const auto digest = TrailingDigest::Start(bytes.data(), bytes.size());
  ASSERT_NE(digest, nullptr);
  EXPECT_EQ(digest->Wait(milliseconds(0)), std::nullopt);
  digest->Advance(bytes.size() - 1);
  EXPECT_EQ(digest->Wait(milliseconds(20)), std::nullopt);
  digest->Advance(bytes.size());
  EXPECT_EQ(digest->Wait(kPatience), DigestOfArtifact(bytes));
}

TEST(TrailingDigest, OfNothingIsThereAtOnce) {
  const auto digest = TrailingDigest::Start(nullptr, 0);
  ASSERT_NE(digest, nullptr);
  EXPECT_EQ(digest->Wait(kPatience), DigestOfArtifact(""));
}

TEST(TrailingDigest, EndsAmidWhatItReads) {
  const std::string bytes = Bytes(std::size_t{4} << 20);
  const auto waiting = TrailingDigest::Start(bytes.data(), bytes.size());
  ASSERT_NE(waiting, nullptr);
  const auto busy = TrailingDigest::Start(bytes.data(), bytes.size());
  ASSERT_NE(busy, nullptr);
  busy->Advance(bytes.size() - 1);
}

}  // namespace
}  // namespace depthfarm
