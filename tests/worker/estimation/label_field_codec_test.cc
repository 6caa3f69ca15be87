#include "worker/estimation/label_field_codec.h"

#include <gtest/gtest.h>

#include "tests/support/random.h"

namespace depthfarm {
namespace {

LabelField RandomField(std::uint64_t seed) {
  test::Random random(seed);
  LabelField field;
  const int views = random.Int(1, 5);
  for (int v = 0; v < views; ++v) {
    ViewLabels view;
    const int segments = random.Int(1, 300);
    for (int s = 0; s < segments; ++s) {
      view.levels.push_back(static_cast<Level>(random.Int(0, 65533)));
      view.unchanged.push_back(random.Chance(50) ? 1 : 0);
    }
    field.views.push_back(view);
  }
  return field;
}

TEST(LabelFieldCodec, GivesBackWhatWasEncoded) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const LabelField field = RandomField(seed);
    const std::string bytes = EncodeLabelField(field);
    EXPECT_EQ(bytes, EncodeLabelField(field));
    const Result<LabelField> decoded = DecodeLabelField(bytes);
    ASSERT_TRUE(decoded.ok()) << decoded.status().message();
    EXPECT_EQ(*decoded, field);
  }
}

TEST(LabelFieldCodec, RefusesDamagedBytes) {
  const LabelField field = RandomField(3);
  const std::string bytes = EncodeLabelField(field);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string damaged = bytes;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x55);
    const Result<LabelField> decoded = DecodeLabelField(damaged);
    // A changed bit that zstd does not use may decode; then it must decode to the same field.
    if (decoded.ok()) {
      EXPECT_EQ(*decoded, field) << "byte " << i;
    } else {
      const bool in_version = i >= 4 && i < 8;
      EXPECT_EQ(decoded.status().code(), in_version ? ErrorCode::kIncompatible : ErrorCode::kCorrupt) << "byte " << i;
    }
    EXPECT_FALSE(DecodeLabelField(bytes.substr(0, i)).ok()) << "cut at " << i;
  }
}

}  // namespace
}  // namespace depthfarm
