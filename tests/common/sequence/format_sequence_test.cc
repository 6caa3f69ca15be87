#include "common/sequence/format_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "common/sequence/read_sequence.h"
#include "tests/common/sequence/sequence_text.h"

namespace depthfarm {
namespace {

using testing::HasSubstr;

Sequence Small() { return ParseSequence(kSequenceText, "/sets/small/s.json").value(); }

// A sequence whose first camera has a video of such a format.
Sequence WithVideo(const PictureFormat& format) {
  Sequence sequence = Small();
  sequence.cameras[0].format = format;
  sequence.cameras[0].images = {"/sets/small/v.bin", "/sets/small/v.bin"};
  return sequence;
}

class FormattedSequence : public testing::TestWithParam<Sequence> {};

TEST_P(FormattedSequence, IsReadBackUnchanged) {
  const Sequence small = GetParam();
  const auto text = FormatSequence(small);
  ASSERT_TRUE(text.ok()) << text.status().message();
  const auto read = ParseSequence(*text, small.file);
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->name, small.name);
  EXPECT_EQ(read->z_near, small.z_near);
  EXPECT_EQ(read->z_far, small.z_far);
  EXPECT_EQ(read->frame_rate, small.frame_rate);
  EXPECT_EQ(read->reference, small.reference);
  ASSERT_EQ(read->cameras.size(), small.cameras.size());
  for (std::size_t i = 0; i < small.cameras.size(); ++i) {
    EXPECT_EQ(read->cameras[i].camera, small.cameras[i].camera);
    EXPECT_EQ(read->cameras[i].format, small.cameras[i].format);
    EXPECT_EQ(read->cameras[i].images, small.cameras[i].images);
    EXPECT_EQ(read->cameras[i].masks, small.cameras[i].masks);
    EXPECT_EQ(read->cameras[i].depth, small.cameras[i].depth);
    EXPECT_EQ(read->cameras[i].z_near, small.cameras[i].z_near);
    EXPECT_EQ(read->cameras[i].z_far, small.cameras[i].z_far);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, FormattedSequence,
    testing::Values(
        Small(), WithVideo({.kind = PictureFormat::Kind::kVideo}),
        WithVideo({.kind = PictureFormat::Kind::kVideo, .bt709 = true, .colour_said = true}),
        WithVideo({.kind = PictureFormat::Kind::kYuv444, .bits = 12, .full_range = true, .all_frames = true})));

TEST(FormatSequence, PicturesOutsideItsFolderNeedTheReadersConsent) {
  Sequence small = Small();
  small.file = "/sets/elsewhere/s.json";
  const auto text = FormatSequence(small);
  ASSERT_TRUE(text.ok()) << text.status().message();
  EXPECT_THAT(ParseSequence(*text, small.file).status().message(), HasSubstr("--allow-outside"));
  const auto read = ParseSequence(*text, small.file, {.allow_outside = true});
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->cameras[0].images, small.cameras[0].images);
}

TEST(FormatSequence, WhatJsonCannotHoldIsRefused) {
  Sequence not_finite = Small();
  not_finite.cameras[1].camera.cam_from_world_translation[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(FormatSequence(not_finite).status().message(), HasSubstr("camera 'b'"));
  Sequence no_text = Small();
  no_text.cameras[1].camera.name = "\xff";
  EXPECT_EQ(FormatSequence(no_text).status().code(), ErrorCode::kInvalidArgument);
}

}  // namespace
}  // namespace depthfarm
