#include "common/digest/sha256.h"

#include <gtest/gtest.h>

#include <string>

namespace depthfarm {
namespace {

// FIPS 180-4 examples.
TEST(Sha256, MatchesThePublishedDigests) {
  EXPECT_EQ(Hex(Sha256("")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Hex(Sha256("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Hex(Sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
}

TEST(Sha256, PiecesGiveTheDigestOfTheWholeWhereverTheyAreCut) {
  std::string bytes;
  for (int i = 0; i < 300; ++i) bytes += static_cast<char>(i * 7);
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    Sha256Hasher hasher;
    hasher.Update(std::string_view(bytes).substr(0, cut));
    hasher.Update(std::string_view(bytes).substr(cut));
    ASSERT_EQ(hasher.Finish(), Sha256(bytes)) << cut;
  }
}

TEST(Sha256, AFinishedHasherBeginsAnew) {
  Sha256Hasher hasher;
  hasher.Update("left over");
  (void)hasher.Finish();
  hasher.Update("abc");
  EXPECT_EQ(hasher.Finish(), Sha256("abc"));
}

}  // namespace
}  // namespace depthfarm
