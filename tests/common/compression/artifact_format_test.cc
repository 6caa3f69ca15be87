#include "common/compression/artifact_format.h"

#include <gtest/gtest.h>

#include "common/compression/zstd_frame.h"

namespace depthfarm {
namespace {

constexpr ArtifactFormat kFormat{.magic = "DFXX", .version = 3};

TEST(ArtifactFormat, GivesBackTheFrameOfItsContent) {
  const std::string bytes = EncodeArtifact(kFormat, "content");
  EXPECT_EQ(bytes.substr(0, 8), std::string("DFXX\3\0\0\0", 8));
  const auto frame = FrameOfArtifact(kFormat, bytes);
  ASSERT_TRUE(frame.ok()) << frame.status().message();
  EXPECT_EQ(ReadZstdFrame(*frame, 0, 100).value(), "content");
}

TEST(ArtifactFormat, RefusesAnotherKindAnotherVersionAndWhatIsTooShort) {
  const std::string bytes = EncodeArtifact(kFormat, "content");
  EXPECT_EQ(FrameOfArtifact({.magic = "DFYY", .version = 3}, bytes).status().code(), ErrorCode::kCorrupt);
  const Status version = FrameOfArtifact({.magic = "DFXX", .version = 4}, bytes).status();
  EXPECT_EQ(version.code(), ErrorCode::kIncompatible);
  EXPECT_EQ(version.message(), "version is 3, expected 4");
  for (std::size_t size = 0; size < 8; ++size)
    EXPECT_EQ(FrameOfArtifact(kFormat, bytes.substr(0, size)).status().code(), ErrorCode::kCorrupt) << size;
}

}  // namespace
}  // namespace depthfarm
