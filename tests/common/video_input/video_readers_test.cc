#include "common/video_input/video_readers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "tests/common/video_input/written_video.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using testing::StartsWith;

class OpenVideos : public testing::Test {
 protected:
  VideoFile Written(const std::string& name, const test::VideoRecipe& recipe = {.encoder = "ffv1", .frames = 6}) {
    const std::string path = folder_.File(name);
    test::WriteVideo(recipe, path);
    return {path, {.kind = PictureFormat::Kind::kVideo}, recipe.width, recipe.height};
  }
  testing_support::TemporaryFolder folder_;
};

TEST_F(OpenVideos, StayOpenOneForEachVideo) {
  const VideoFile a = Written("a.mkv");
  const VideoFile b = Written("b.mkv");
  VideoReaders videos;
  for (const int frame : {0, 1, 2}) {
    EXPECT_TRUE(videos.Read(a, frame)->bytes == test::PlanesOfFrame({}, frame));
    EXPECT_TRUE(videos.Read(b, frame)->bytes == test::PlanesOfFrame({}, frame));
  }
  EXPECT_EQ(videos.num_idle(), 2);
}

TEST_F(OpenVideos, AReplacedFileIsOpenedAnew) {
  const VideoFile file = Written("a.mkv");
  VideoReaders videos;
  EXPECT_TRUE(videos.Read(file, 3)->bytes == test::PlanesOfFrame({}, 3));
  // Frame f of the other one is frame f + 20.
  const test::VideoRecipe later{
      .encoder = "ffv1", .frames = 26, .place = [](int frame) { return frame < 20 ? -1 : frame - 20; }};
  const VideoFile other = Written("b.mkv", later);
  std::filesystem::rename(other.path, file.path);
  EXPECT_TRUE(videos.Read(file, 3)->bytes == test::PlanesOfFrame({}, 23));
  EXPECT_EQ(videos.num_idle(), 1);
}

TEST_F(OpenVideos, ErrorsBeginWithThePathAndKeepNothingOpen) {
  const VideoFile file = Written("a.mkv");
  VideoReaders videos;
  EXPECT_THAT(videos.Read(file, 99).status().message(), StartsWith(file.path + ": has no picture for frame 99"));
  VideoFile none = file;
  none.path = folder_.File("none.mkv");
  EXPECT_EQ(videos.Read(none, 0).status().message(), none.path + ": cannot be opened: No such file or directory");
  EXPECT_EQ(videos.num_idle(), 0);
}

TEST_F(OpenVideos, AJobThatNeedsMoreFramesIsToldAtOnceThoughTheVideoIsOpen) {
  VideoFile file = Written("a.mkv");
  VideoReaders videos;
  EXPECT_TRUE(videos.Read(file, 0).ok());
  file.frames = 60;
  EXPECT_THAT(videos.Read(file, 1).status().message(), testing::HasSubstr("of 60 expected frames"));
}

TEST_F(OpenVideos, ThreadsGetTheSamePictures) {
  const VideoFile file = Written("a.mkv");
  VideoReaders videos;
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 3; ++thread) {
    threads.emplace_back([&, thread] {
      for (int i = 0; i < 30; ++i) {
        const int frame = (i * (thread + 1)) % 6;
        const auto picture = videos.Read(file, frame);
        ASSERT_TRUE(picture.ok()) << picture.status().message();
        EXPECT_TRUE(picture->bytes == test::PlanesOfFrame({}, frame));
      }
    });
  }
  threads.clear();
  EXPECT_LE(videos.num_idle(), 3);
}

}  // namespace
}  // namespace depthfarm
