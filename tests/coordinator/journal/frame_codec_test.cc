#include "coordinator/journal/frame_codec.h"

#include <gtest/gtest.h>

#include "common/digest/sha256.h"

namespace depthfarm {
namespace {

CommittedFrame SomeFrame() {
  return {{{Sha256("a"), 1}, {Sha256("b"), std::uint64_t{1} << 40}},
          {Sha256("p"), Sha256("q"), Sha256("r")},
          ArtifactInfo{Sha256("k"), 77, Sha256("c")}};
}

TEST(FrameCodec, GivesBackWhatWasWritten) {
  for (const CommittedFrame& frame : {SomeFrame(), CommittedFrame(), CommittedFrame{{{Sha256("a"), 0}}, {}}}) {
    const Result<CommittedFrame> read = DecodeFrame(EncodeFrame(frame));
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(*read, frame);
  }
}

TEST(FrameCodec, RefusesWhatIsShorterOrLongerOrCountsTooMuch) {
  const std::string bytes = EncodeFrame(SomeFrame());
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_EQ(DecodeFrame(bytes.substr(0, size)).status().code(), ErrorCode::kCorrupt) << size;
  EXPECT_FALSE(DecodeFrame(bytes + "x").ok());
  std::string many = bytes;
  many[3] = '\xff';
  EXPECT_FALSE(DecodeFrame(many).ok());
}

}  // namespace
}  // namespace depthfarm
