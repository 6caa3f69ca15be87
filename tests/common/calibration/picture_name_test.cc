#include "common/calibration/picture_name.h"

#include <gtest/gtest.h>

namespace depthfarm {
namespace {

TEST(NameOfPicture, IsFitToNameFiles) {
  EXPECT_EQ(NameOfPicture("left.jpg"), "left");
  EXPECT_EQ(NameOfPicture("rig/left/0001.jpg"), "rig_left_0001");
  EXPECT_EQ(NameOfPicture("no-ending"), "no-ending");
  EXPECT_EQ(NameOfPicture("v1.5/left"), "v1.5_left") << "that of a folder is none";
  EXPECT_EQ(NameOfPicture(".hidden"), ".hidden");
  EXPECT_EQ(NameOfPicture("../a...b.png"), "__a_.b");
  EXPECT_EQ(NameOfPicture("rig/left.jpg", KeepEnding::kYes), "rig_left.jpg");
}

}  // namespace
}  // namespace depthfarm
