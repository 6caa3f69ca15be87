#include "common/sequence/read_cameras.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/common/sequence/sequence_text.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;
using testing_support::TemporaryFolder;

constexpr const char* kCamera = R"({"name": "above", "width": 64, "height": 48,
  "K": [[50, 0, 31.5], [0, 50, 23.5], [0, 0, 1]], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "t": [0, 0.5, 0]})";

TEST(ReadCameras, OneOrAList) {
  const TemporaryFolder folder;
  const auto one = ReadCameras(folder.Write("one.json", kCamera));
  ASSERT_TRUE(one.ok()) << one.status().message();
  ASSERT_EQ(one->size(), 1U);
  EXPECT_EQ((*one)[0].name, "above");
  EXPECT_EQ((*one)[0].cam_from_world_translation[1], 0.5);
  const std::string list = std::string(R"({"cameras": [)") + kCamera + "," + kCamera + R"(], "notes": "a path"})";
  const auto two = ReadCameras(folder.Write("two.json", list));
  ASSERT_TRUE(two.ok()) << two.status().message();
  EXPECT_EQ(two->size(), 2U);
}

TEST(ReadCameras, RefusesWhatIsNoCamera) {
  const TemporaryFolder folder;
  const auto message = [&](const std::string& text) {
    const auto cameras = ReadCameras(folder.Write("v.json", text));
    EXPECT_EQ(cameras.status().code(), ErrorCode::kInvalidArgument);
    return cameras.status().message();
  };
  EXPECT_THAT(message("{"), HasSubstr("v.json"));
  EXPECT_THAT(message("[1]"), HasSubstr("v.json"));
  EXPECT_THAT(message(R"({"cameras": []})"), HasSubstr("'cameras' is empty"));
  EXPECT_THAT(message(R"({"cameras": [{}]})"), HasSubstr("cameras[0]"));
  EXPECT_THAT(message(Replaced(kCamera, "above", "../above")), HasSubstr("without '/' and '..'"));
  EXPECT_THAT(message(Replaced(kCamera, "[[50, 0", "[[-50, 0")), HasSubstr("camera 'above': focal lengths"));
  EXPECT_THAT(message(Replaced(kCamera, "64", "0")), HasSubstr("'width' is 0"));
  EXPECT_THAT(message(Replaced(kCamera, R"("t")", R"("images": [], "t")")), HasSubstr("images"));
  EXPECT_THAT(ReadCameras(folder.File("none.json")).status().message(), HasSubstr("none.json"));
}

}  // namespace
}  // namespace depthfarm
