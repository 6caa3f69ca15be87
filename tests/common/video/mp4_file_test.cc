#include "common/video/mp4_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include "tests/common/video/test_video.h"

namespace depthfarm {
namespace {

class Mp4FileTest : public testing::Test {
 protected:
  Mp4FileTest() { std::filesystem::create_directories(folder_); }
  ~Mp4FileTest() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::size_t Files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) /
                                  ("mp4_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
  std::string path_ = (folder_ / "views.mp4").string();
};

// Mean squared error of the luma of each picture in the file against TestPicture(i, i, 0).
std::vector<double> DecodedErrors(const std::string& path) {
  std::vector<double> errors;
  AVFormatContext* container = nullptr;
  EXPECT_GE(avformat_open_input(&container, path.c_str(), nullptr, nullptr), 0);
  if (container == nullptr) return errors;
  AVCodecContext* decoder = avcodec_alloc_context3(avcodec_find_decoder(container->streams[0]->codecpar->codec_id));
  avcodec_parameters_to_context(decoder, container->streams[0]->codecpar);
  EXPECT_GE(avcodec_open2(decoder, nullptr, nullptr), 0);
  AVPacket* packet = av_packet_alloc();
  AVFrame* frame = av_frame_alloc();
  bool more = true;
  while (more) {
    more = av_read_frame(container, packet) >= 0;
    avcodec_send_packet(decoder, more ? packet : nullptr);
    av_packet_unref(packet);
    while (avcodec_receive_frame(decoder, frame) >= 0) {
      const std::string expected = TestPicture(0, static_cast<double>(errors.size()), 0);
      double sum = 0;
      for (int y = 0; y < kVideoHeight; ++y) {
        for (int x = 0; x < kVideoWidth; ++x) {
          const int a = frame->data[0][y * frame->linesize[0] + x];
          sum += std::pow(a - static_cast<unsigned char>(expected[static_cast<std::size_t>(y * kVideoWidth + x)]), 2);
        }
      }
      errors.push_back(sum / (kVideoWidth * kVideoHeight));
    }
  }
  av_frame_free(&frame);
  av_packet_free(&packet);
  avcodec_free_context(&decoder);
  avformat_close_input(&container);
  return errors;
}

TEST_F(Mp4FileTest, HoldsThePicturesInOrder) {
  Result<Mp4File> file = Mp4File::Create(path_, kVideoWidth, kVideoHeight, 25);
  ASSERT_TRUE(file.ok()) << file.status().message();
  for (int i = 0; i < 12; ++i) ASSERT_TRUE(file->Put(TestPicture(0, i, 0)).ok());
  const Status status = file->Finish();
  ASSERT_TRUE(status.ok()) << status.message();
  const std::vector<double> errors = DecodedErrors(path_);
  EXPECT_EQ(errors.size(), 12U);
  EXPECT_THAT(errors, testing::Each(testing::Lt(6.5)));  // 40 dB
  EXPECT_EQ(Files(), 1U);
}

TEST_F(Mp4FileTest, LeavesNothingBehindWhenItIsNotFinished) {
  {
    Result<Mp4File> file = Mp4File::Create(path_, kVideoWidth, kVideoHeight, 25);
    ASSERT_TRUE(file.ok());
    ASSERT_TRUE(file->Put(TestPicture(0, 0, 0)).ok());
    EXPECT_EQ(Files(), 1U);
  }
  EXPECT_EQ(Files(), 0U);
}

TEST_F(Mp4FileTest, KeepsTheFileThatWasThereUntilItIsComplete) {
  std::ofstream(path_) << "old";
  Result<Mp4File> file = Mp4File::Create(path_, kVideoWidth, kVideoHeight, 25);
  ASSERT_TRUE(file.ok());
  ASSERT_TRUE(file->Put(TestPicture(0, 0, 0)).ok());
  EXPECT_EQ(std::filesystem::file_size(path_), 3U);
  ASSERT_TRUE(file->Finish().ok());
  EXPECT_GT(std::filesystem::file_size(path_), 100U);
}

TEST_F(Mp4FileTest, SaysWhatIsWrong) {
  const Result<Mp4File> odd = Mp4File::Create(path_, 63, 48, 25);
  EXPECT_THAT(odd.status().message(), testing::HasSubstr("63x48"));
  const std::string nowhere = (folder_ / "no" / "views.mp4").string();
  const Result<Mp4File> missing = Mp4File::Create(nowhere, 64, 48, 25);
  EXPECT_EQ(missing.status().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(missing.status().message(), testing::AllOf(testing::HasSubstr(nowhere), testing::HasSubstr("No such")));
}

}  // namespace
}  // namespace depthfarm
