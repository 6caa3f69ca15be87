#include "coordinator/importing/picture_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace depthfarm {
namespace {

using testing::HasSubstr;

std::string PathOf(const std::string& pattern, const std::string& camera, int frame) {
  const auto parsed = PicturePattern::Parse(pattern);
  if (!parsed.ok()) return parsed.status().message();
  const auto path = parsed->PathOf(camera, frame);
  return path.ok() ? *path : path.status().message();
}

TEST(PicturePattern, FillsInNamesAndNumbers) {
  EXPECT_EQ(PathOf("a/{camera}/{frame}.png", "left", 7), "a/left/7.png");
  EXPECT_EQ(PathOf("{camera}-{frame:04}.png", "left", 7), "left-0007.png");
  EXPECT_EQ(PathOf("{camera}-{frame:02}.png", "left", 1234), "left-1234.png");
  EXPECT_EQ(PathOf("v{number}.yuv", "param_cam03", 0), "v3.yuv");
  EXPECT_EQ(PathOf("v{number:03}.yuv", "param_cam03", 0), "v003.yuv");
  EXPECT_EQ(PathOf("v{number}.yuv", "cam00", 0), "v0.yuv");
  EXPECT_EQ(PathOf("v{number}.yuv", "12", 0), "v12.yuv");
  EXPECT_EQ(PathOf("plain.png", "left", 0), "plain.png");
}

TEST(PicturePattern, KnowsWhatItDependsOn) {
  const auto both = PicturePattern::Parse("{number}/{frame}.png");
  ASSERT_TRUE(both.ok());
  EXPECT_TRUE(both->has_frames());
  EXPECT_TRUE(both->tells_cameras_apart());
  const auto frames = PicturePattern::Parse("{frame}.png");
  ASSERT_TRUE(frames.ok());
  EXPECT_FALSE(frames->tells_cameras_apart());
  EXPECT_FALSE(PicturePattern::IsPattern("images_4"));
}

TEST(PicturePattern, RefusesOtherFields) {
  EXPECT_THAT(PathOf("{view}.png", "left", 0), HasSubstr("there is no {view}; there are {camera}"));
  EXPECT_THAT(PathOf("{frame:4}.png", "left", 0), HasSubstr("there is no {frame:4}"));
  EXPECT_THAT(PathOf("{camera:04}.png", "left", 0), HasSubstr("there is no {camera:04}"));
  EXPECT_THAT(PathOf("{frame.png", "left", 0), HasSubstr("not closed"));
  EXPECT_THAT(PathOf("{number}.png", "left", 0), HasSubstr("camera 'left': its name ends in no number"));
}

}  // namespace
}  // namespace depthfarm
