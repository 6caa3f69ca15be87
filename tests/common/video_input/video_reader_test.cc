// Videos by the module that programs load: the same pictures in any order, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include "common/files/atomic_file.h"
#include "common/video_input/video_module.h"
#include "tests/common/video_input/written_video.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using Kind = PictureFormat::Kind;
using test::PlanesOfFrame;
using test::VideoRecipe;
using test::WriteVideo;
using testing::AllOf;
using testing::HasSubstr;

constexpr PictureFormat kAsTagged{.kind = Kind::kVideo};

VideoFile FileOf(const VideoRecipe& recipe, const std::string& path) {
  return {path, kAsTagged, recipe.width, recipe.height};
}

// The error of opening a video and reading a frame.
std::string ErrorOf(const VideoFile& file, int frame = 0) {
  const auto reader = OpenVideo(file);
  if (!reader.ok()) return reader.status().message();
  return (*reader)->Read(frame).status().message();
}

struct Case {
  std::string name;
  VideoRecipe recipe;
  std::string ending;
  PictureFormat format;  // of the planes
  bool lossless = false;
};

std::ostream& operator<<(std::ostream& out, const Case& of) { return out << of.name; }

class EveryVideo : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    file_ = FileOf(GetParam().recipe, folder_.File("video." + GetParam().ending));
    WriteVideo(GetParam().recipe, file_.path);
    frames_ = GetParam().recipe.frames;
  }
  [[nodiscard]] std::vector<std::string> Read(const std::vector<int>& order) const {
    std::vector<std::string> pictures(static_cast<std::size_t>(frames_));
    const auto reader = OpenVideo(file_);
    EXPECT_TRUE(reader.ok()) << reader.status().message();
    if (!reader.ok()) return pictures;
    for (const int frame : order) {
      const auto picture = (*reader)->Read(frame);
      EXPECT_TRUE(picture.ok()) << frame << ": " << picture.status().message();
      if (!picture.ok()) continue;
      EXPECT_EQ(picture->format, GetParam().format);
      pictures[static_cast<std::size_t>(frame)] = picture->bytes;
    }
    return pictures;
  }

  testing_support::TemporaryFolder folder_;
  VideoFile file_;
  int frames_ = 0;
};

TEST_P(EveryVideo, HasTheSamePicturesInAnyOrder) {
  std::vector<int> order(static_cast<std::size_t>(frames_));
  std::iota(order.begin(), order.end(), 0);
  const std::vector<std::string> forward = Read(order);
  std::vector<int> backward(order.rbegin(), order.rend());
  EXPECT_TRUE(Read(backward) == forward);
  std::shuffle(order.begin(), order.end(), std::mt19937(7));
  EXPECT_TRUE(Read(order) == forward);
  for (int frame = 0; frame < frames_; ++frame) {  // each as the first that is asked for
    const auto reader = OpenVideo(file_);
    ASSERT_TRUE(reader.ok());
    EXPECT_TRUE((*reader)->Read(frame)->bytes == forward[static_cast<std::size_t>(frame)]) << frame;
  }
}

TEST_P(EveryVideo, HasThePicturesThatWereWritten) {
  std::vector<int> order(static_cast<std::size_t>(frames_));
  std::iota(order.begin(), order.end(), 0);
  const std::vector<std::string> pictures = Read(order);
  for (int frame = 0; frame < frames_; ++frame) {
    const std::string written = PlanesOfFrame(GetParam().recipe, frame);
    const std::string& read = pictures[static_cast<std::size_t>(frame)];
    ASSERT_EQ(read.size(), written.size());
    if (GetParam().lossless) {
      EXPECT_TRUE(read == written) << frame;
      continue;
    }
    // Luma is nearer to its own frame's than to those of the frames beside it.
    const auto distance = [&](int other) {
      const std::string planes = PlanesOfFrame(GetParam().recipe, other);
      const int bytes = GetParam().format.bits > 8 ? 2 : 1;
      double sum = 0;
      for (std::size_t i = static_cast<std::size_t>(bytes - 1); i < static_cast<std::size_t>(64 * 48 * bytes);
           i += static_cast<std::size_t>(bytes))
        sum += std::abs(static_cast<unsigned char>(read[i]) - static_cast<unsigned char>(planes[i]));
      return sum;
    };
    EXPECT_LT(distance(frame), distance(frame + 1)) << frame;
    EXPECT_LT(distance(frame), distance(frame - 1)) << frame;
  }
}

const PictureFormat kYuv420P8{.kind = Kind::kYuv420, .bits = 8};

INSTANTIATE_TEST_SUITE_P(
    Of, EveryVideo,
    testing::Values(Case{"h264_mp4", {.b_frames = 3}, "mp4", kYuv420P8},
                    Case{"h264_open_gops_mkv",
                         {.b_frames = 3, .options = {{"x264-params", "open-gop=1:b-pyramid=normal"}}},
                         "mkv",
                         kYuv420P8},
                    Case{"h264_no_key_but_the_first_mp4", {.key_interval = 1000, .b_frames = 2}, "mp4", kYuv420P8},
                    Case{"h264_parts_that_are_coded_alone_mp4",
                         {.frames = 60, .key_interval = 20, .options = {{"x264-params", "intra-refresh=1"}}},
                         "mp4",
                         kYuv420P8},
                    Case{"mpeg4_avi", {.encoder = "mpeg4", .b_frames = 2}, "avi", kYuv420P8},
                    Case{"h264_ts", {.b_frames = 3}, "ts", kYuv420P8},
                    Case{"h264_ntsc_mov", {.rate = {30000, 1001}, .b_frames = 1}, "mov", kYuv420P8},
                    Case{"h264_lossless_444_mp4",
                         {.samples = AV_PIX_FMT_YUV444P, .options = {{"qp", "0"}}},
                         "mp4",
                         {.kind = Kind::kYuv444, .bits = 8},
                         true},
                    Case{"hevc_10_bits_open_gops_mp4",
                         {.encoder = "libx265",
                          .samples = AV_PIX_FMT_YUV420P10,
                          .b_frames = 3,
                          .options = {{"x265-params", "log-level=none:open-gop=1"}}},
                         "mp4",
                         {.kind = Kind::kYuv420, .bits = 10}},
                    Case{"mpeg2_mxf", {.encoder = "mpeg2video", .b_frames = 2}, "mxf", kYuv420P8},
                    Case{"mpeg2_ts", {.encoder = "mpeg2video", .b_frames = 2}, "ts", kYuv420P8},
                    Case{"prores_422_10_mov",
                         {.encoder = "prores_ks", .samples = AV_PIX_FMT_YUV422P10},
                         "mov",
                         {.kind = Kind::kYuv422, .bits = 10}},
                    Case{"ffv1_12_bits_mkv",
                         {.encoder = "ffv1", .samples = AV_PIX_FMT_YUV420P12},
                         "mkv",
                         {.kind = Kind::kYuv420, .bits = 12},
                         true},
                    Case{"ffv1_grey_16_mkv",
                         {.encoder = "ffv1", .samples = AV_PIX_FMT_GRAY16},
                         "mkv",
                         {.kind = Kind::kYuv400, .bits = 16},
                         true},
                    Case{"mjpeg_avi",
                         {.encoder = "mjpeg", .samples = AV_PIX_FMT_YUVJ420P, .range = AVCOL_RANGE_JPEG},
                         "avi",
                         {.kind = Kind::kYuv420, .bits = 8, .full_range = true}},
                    Case{"y4m", {.encoder = "wrapped_avframe"}, "y4m", kYuv420P8, true}),
    [](const auto& of) { return of.param.name; });

class BadVideos : public testing::Test {
 protected:
  // Written as the recipe says; returns the file.
  VideoFile Written(const VideoRecipe& recipe, const std::string& name = "video.mp4") {
    const VideoFile file = FileOf(recipe, folder_.File(name));
    WriteVideo(recipe, file.path);
    return file;
  }
  testing_support::TemporaryFolder folder_;
};

TEST_F(BadVideos, AFrameThatIsNotThere) {
  const VideoFile file = Written({.frames = 5});
  EXPECT_EQ(ErrorOf(file, 4), "");
  EXPECT_THAT(ErrorOf(file, 5), HasSubstr("has no picture for frame 5: it ends before"));
  EXPECT_THAT(ErrorOf(file, 500), HasSubstr("frame 500"));
  EXPECT_THAT(ErrorOf(file, -1), HasSubstr("frame -1"));
}

TEST_F(BadVideos, FewerFramesThanExpectedAreFoundAtTheFirst) {
  VideoFile file = Written({.frames = 5, .b_frames = 2});
  file.frames = 5;
  EXPECT_EQ(ErrorOf(file), "");
  file.frames = 6;
  EXPECT_EQ(ErrorOf(file), "has 5 of 6 expected frames");
  // With a gap: five frame times, four pictures.
  VideoFile gap = Written({.frames = 5, .place = [](int frame) { return frame == 2 ? -1 : frame; }}, "gap.mp4");
  gap.frames = 5;
  EXPECT_EQ(ErrorOf(gap), "");
}

TEST_F(BadVideos, AFileThatIsNone) {
  VideoFile file = {folder_.Write("text.mp4", std::string(5000, 'a')), kAsTagged, 64, 48};
  EXPECT_THAT(ErrorOf(file), HasSubstr("is no video of a kind that can be read (mp4, mov"));
  file.path = folder_.Write("empty.mp4", "");
  EXPECT_THAT(ErrorOf(file), HasSubstr("is no video"));
  file.path = folder_.File("none.mp4");
  EXPECT_THAT(ErrorOf(file), HasSubstr("No such file"));
  file.path = folder_.path().string();
  EXPECT_THAT(ErrorOf(file), HasSubstr("not a regular file"));
}

// Lists of other files, which libav would open.
TEST_F(BadVideos, AListOfOtherFilesOpensNone) {
  const VideoFile real = Written({});
  for (const char* const list :
       {"ffconcat version 1.0\nfile video.mp4\n", "#EXTM3U\n#EXT-X-TARGETDURATION:10\n#EXTINF:10,\nvideo.mp4\n"}) {
    EXPECT_THAT(ErrorOf({folder_.Write("list.mp4", list), kAsTagged, 64, 48}), HasSubstr("is no video"));
  }
}

TEST_F(BadVideos, AnotherSizeThanTheCameras) {
  VideoFile file = Written({});
  file.width = 640;
  EXPECT_THAT(ErrorOf(file), HasSubstr("has 64x48 pixels, expected 640x48, the camera's size"));
}

TEST_F(BadVideos, AGapIsNotClosedUp) {
  const VideoFile file = Written({.place = [](int frame) { return frame == 7 ? -1 : frame; }});
  EXPECT_EQ(ErrorOf(file, 6), "");
  EXPECT_EQ(ErrorOf(file, 8), "");
  EXPECT_THAT(ErrorOf(file, 7), HasSubstr("has no picture for frame 7: there is a gap at that time"));
}

TEST_F(BadVideos, UnevenTimes) {
  // One frame and a half from each to the next after the tenth.
  const VideoFile file =
      Written({.rate = {50, 1}, .place = [](int frame) { return frame < 10 ? 2 * frame : 3 * frame - 10; }});
  const std::string error = ErrorOf(file, 15);
  EXPECT_THAT(error, testing::AnyOf(HasSubstr("the time between its pictures varies"), HasSubstr("there is a gap")));
}

TEST_F(BadVideos, Interlaced) {
  const VideoFile file = Written({.encoder = "mpeg2video", .interlaced = true}, "video.mxf");
  EXPECT_THAT(ErrorOf(file), HasSubstr("is interlaced"));
}

TEST_F(BadVideos, SamplesThatAreNoPlanesOfYcbcr) {
  const VideoFile file = Written({.encoder = "ffv1", .samples = AV_PIX_FMT_GBRP10}, "video.mkv");
  EXPECT_THAT(ErrorOf(file), AllOf(HasSubstr("its samples are gbrp10le"), HasSubstr("ffmpeg -pix_fmt yuv444p10le")));
}

// Within the group of pictures other bytes may look like a picture, too: no decoder finds all damage.
TEST_F(BadVideos, DamageIsFoundAndDoesNotReachBeyondTheNextKeyPicture) {
  const VideoFile file = Written({.frames = 36, .options = {{"x264-params", "scenecut=0"}}});
  std::string bytes = ReadFileBytes(file.path, 1 << 24).value();
  for (std::size_t i = bytes.size() * 45 / 100; i < bytes.size() * 47 / 100; ++i)
    bytes[i] = static_cast<char>(~bytes[i]);  // of frames 12 to 23, since pictures follow each other in mp4
  const VideoFile damaged{folder_.Write("damaged.mp4", bytes), kAsTagged, 64, 48};
  const auto whole = OpenVideo(file).value();
  int bad = 0;
  for (int frame = 0; frame < 36; ++frame) {
    const auto reader = OpenVideo(damaged);
    ASSERT_TRUE(reader.ok()) << reader.status().message();
    const auto picture = (*reader)->Read(frame);
    if (frame >= 12 && frame < 24) {
      bad += picture.ok() ? 0 : 1;
      continue;
    }
    ASSERT_TRUE(picture.ok()) << frame << ": " << picture.status().message();
    EXPECT_TRUE(picture->bytes == whole->Read(frame)->bytes) << frame;
  }
  EXPECT_GT(bad, 0);
}

TEST_F(BadVideos, OneThatIsCutShortHasItsFirstFrames) {
  const VideoFile file = Written({.frames = 36}, "video.mkv");
  const std::string bytes = ReadFileBytes(file.path, 1 << 24).value();
  const VideoFile cut{folder_.Write("cut.mkv", bytes.substr(0, bytes.size() / 2)), kAsTagged, 64, 48};
  EXPECT_EQ(ErrorOf(cut, 3), "");
  EXPECT_THAT(ErrorOf(cut, 35), HasSubstr("has no picture for frame 35"));
}

TEST(VideoColour, IsThatOfTheStreamUnlessTheSequenceSaysIt) {
  const testing_support::TemporaryFolder folder;
  const VideoRecipe recipe{.frames = 2, .range = AVCOL_RANGE_JPEG, .matrix = AVCOL_SPC_BT709};
  VideoFile file = FileOf(recipe, folder.File("video.mp4"));
  WriteVideo(recipe, file.path);
  EXPECT_EQ(OpenVideo(file).value()->Read(0)->format,
            (PictureFormat{.kind = Kind::kYuv420, .bits = 8, .full_range = true, .bt709 = true}));
  file.format.colour_said = true;
  EXPECT_EQ(OpenVideo(file).value()->Read(0)->format, kYuv420P8);

  VideoRecipe wide = recipe;
  wide.matrix = AVCOL_SPC_BT2020_NCL;
  VideoFile other = FileOf(wide, folder.File("wide.mp4"));
  WriteVideo(wide, other.path);
  EXPECT_THAT(ErrorOf(other), HasSubstr("its matrix is bt2020nc, expected BT.601 or BT.709"));
  other.format.colour_said = true;
  EXPECT_EQ(ErrorOf(other), "");
}

}  // namespace
}  // namespace depthfarm
