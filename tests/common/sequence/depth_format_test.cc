#include "common/sequence/depth_format.h"

#include <gtest/gtest.h>

#include <string>

namespace depthfarm {
namespace {

TEST(DepthFormat, HasANameAndAnEndingOfItsOwn) {
  for (const DepthFormat format :
       {DepthFormat::kPng16, DepthFormat::kPfm, DepthFormat::kExr, DepthFormat::kYuv420p16}) {
    EXPECT_EQ(DepthFormatOfName(NameOf(format)), format);
    EXPECT_EQ(DepthFormatOfFile("depth/cam.0/0000." + ExtensionOf(format)), format);
    EXPECT_NE(DepthFormatNames().find(NameOf(format)), std::string_view::npos);
  }
}

TEST(DepthFormat, OtherNamesAndEndingsAreNone) {
  for (const char* name : {"", "png", "PFM", "exr ", "yuv"}) EXPECT_EQ(DepthFormatOfName(name), std::nullopt) << name;
  for (const char* path : {"", "png", "a.PNG", "a.png/b", "a.jpg", "a.", ".png/"})
    EXPECT_EQ(DepthFormatOfFile(path), std::nullopt) << path;
}

}  // namespace
}  // namespace depthfarm
