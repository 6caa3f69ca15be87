#include "worker/artifacts/artifact_digest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "worker/artifacts/leaf_digests.h"

namespace depthfarm {
namespace {

std::string Bytes(std::size_t size) {
  std::string bytes(size, '\0');
  for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>(i * 7 + i / 256 + i / kLeafBytes);
  return bytes;
}

// As the header says, one leaf after the other.
ContentDigest Plain(const std::string& bytes) {
  std::string tree = "depthfarm artifact\n";
  for (std::size_t i = 0; i < 8; ++i) tree += static_cast<char>(bytes.size() >> (8 * i) & 0xff);
  for (std::size_t at = 0; at < bytes.size(); at += kLeafBytes) {
    const Sha256Digest leaf = Sha256(std::string_view(bytes).substr(at, kLeafBytes));
    tree.append(leaf.begin(), leaf.end());
  }
  return Sha256(tree);
}

// Golden values of Python's hashlib: what other builds and processors must find too.
TEST(ArtifactDigest, IsTheSameEverywhere) {
  EXPECT_EQ(Hex(DigestOfArtifact("")), "562b2103e7c35084a95f9e48e91bc2babc578f2a4cd65966aa6953b9319f7408");
  EXPECT_EQ(Hex(DigestOfArtifact("artifact")), "41ced2162be39bf2f1cb6c74dd046ca1d357a9b554c883701e5e6f889746a9ff");
  EXPECT_EQ(Hex(DigestOfArtifact(std::string(100'000, 'x'))),
            "88fbc5c23fbcd54b6447cb0bf256edf76fd8a92b538ae7500c22820a6f094ba6");
}

TEST(ArtifactDigest, IsThatOfItsLeavesHoweverManyThereAre) {
  // Around what vectors hash at a time, and around ends of leaves.
  for (const std::size_t leaves : {0, 1, 2, 3, 7, 8, 9, 15, 16, 17, 33, 64}) {
    for (const std::size_t more : {std::size_t{0}, std::size_t{1}, kLeafBytes - 1}) {
      const std::string bytes = Bytes(leaves * kLeafBytes + more);
      EXPECT_EQ(DigestOfArtifact(bytes), Plain(bytes)) << bytes.size();
    }
  }
}

TEST(ArtifactDigest, IsThatOfTheWholeHoweverItComes) {
  const std::string bytes = Bytes(9 * kLeafBytes + 1234);
  const ContentDigest whole = Plain(bytes);
  ArtifactHasher hasher;  // one for all: each Finish begins anew
  for (const std::size_t step :
       {std::size_t{999}, kLeafBytes - 1, kLeafBytes, kLeafBytes + 1, 3 * kLeafBytes + 5, bytes.size()}) {
    for (std::size_t at = 0; at < bytes.size(); at += step) hasher.Update(std::string_view(bytes).substr(at, step));
    hasher.Update("");
    EXPECT_EQ(hasher.Finish(), whole) << step;
  }
}

TEST(ArtifactDigest, EveryByteAndTheLengthCount) {
  std::string bytes = Bytes(3 * kLeafBytes + 100);
  std::set<ContentDigest> digests = {DigestOfArtifact(bytes)};
  for (const std::size_t at : {std::size_t{0}, kLeafBytes - 1, kLeafBytes, 2 * kLeafBytes + 77, bytes.size() - 1}) {
    bytes[at] ^= 1;
    EXPECT_TRUE(digests.insert(DigestOfArtifact(bytes)).second) << at;
    bytes[at] ^= 1;
  }
  EXPECT_TRUE(digests.insert(DigestOfArtifact(bytes + '\0')).second);
  std::swap_ranges(bytes.begin(), bytes.begin() + kLeafBytes, bytes.begin() + kLeafBytes);
  EXPECT_TRUE(digests.insert(DigestOfArtifact(bytes)).second) << "order of leaves";
}

}  // namespace
}  // namespace depthfarm
