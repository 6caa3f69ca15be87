#include "common/media/picture_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/base/little_endian.h"
#include "common/media/colour_map.h"
#include "common/media/grey_picture.h"
#include "common/media/image_codec.h"
#include "tests/support/temporary_folder.h"

namespace depthfarm {
namespace {

using ::testing::HasSubstr;
using testing_support::TemporaryFolder;

const PictureFormat kImageFile;

std::string Encoded(const std::string& extension, const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  EXPECT_TRUE(cv::imencode(extension, image, bytes));
  return {bytes.begin(), bytes.end()};
}

cv::Mat NoiseBgr(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  std::mt19937 random(5);
  for (int i = 0; i < height * width * 3; ++i) image.data[i] = static_cast<unsigned char>(random() & 0xff);
  return image;
}

// The colour of a PNG of one pixel.
Ycbcr Decoded(int r, int g, int b) {
  const auto picture = DecodePicture(Encoded(".png", cv::Mat(1, 1, CV_8UC3, cv::Scalar(b, g, r))), kImageFile, 1, 1, 1);
  EXPECT_TRUE(picture.ok()) << picture.status().message();
  return picture.ok() ? (*picture)(0, 0) : Ycbcr{};
}

TEST(DecodePicture, PrimariesHaveTheirBt601Values) {
  EXPECT_EQ(Decoded(0, 0, 0), (Ycbcr{0, 128, 128, 0}));
  EXPECT_EQ(Decoded(255, 255, 255), (Ycbcr{255, 128, 128, 0}));
  EXPECT_EQ(Decoded(255, 0, 0), (Ycbcr{76, 85, 255, 0}));    // 76.245, 84.97, 255.5 clamped
  EXPECT_EQ(Decoded(0, 255, 0), (Ycbcr{150, 44, 21, 0}));    // 149.685, 43.53, 21.23
  EXPECT_EQ(Decoded(0, 0, 255), (Ycbcr{29, 255, 107, 0}));   // 29.07, 255.5 clamped, 107.27
  EXPECT_EQ(Decoded(255, 255, 0), (Ycbcr{226, 1, 149, 0}));  // 225.93, 0.5 up, 148.73
}

TEST(DecodePicture, GreyRampHasNeutralChromaInColourAndInGrey) {
  cv::Mat grey(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i) grey.at<unsigned char>(0, i) = static_cast<unsigned char>(i);
  const auto picture = DecodePicture(Encoded(".png", grey), kImageFile, 256, 1, 1);
  ASSERT_TRUE(picture.ok()) << picture.status().message();
  for (int i = 0; i < 256; ++i) {
    EXPECT_EQ((*picture)(i, 0), (Ycbcr{static_cast<std::uint8_t>(i), 128, 128, 0}));
    EXPECT_EQ(Decoded(i, i, i), (*picture)(i, 0));
  }
}

TEST(DecodePicture, SixteenBitsAreRoundedOnceToEightBitUnits) {
  cv::Mat grey(1, 5, CV_16UC1);
  const std::vector<std::pair<int, int>> values = {{0, 0}, {65535, 255}, {257 * 100, 100}, {128, 0}, {129, 1}};
  for (int i = 0; i < 5; ++i) {
    grey.at<unsigned short>(0, i) = static_cast<unsigned short>(values[static_cast<std::size_t>(i)].first);
  }
  const auto picture = DecodePicture(Encoded(".png", grey), kImageFile, 5, 1, 1);
  ASSERT_TRUE(picture.ok()) << picture.status().message();
  for (int i = 0; i < 5; ++i) EXPECT_EQ((*picture)(i, 0).y, values[static_cast<std::size_t>(i)].second) << i;
}

TEST(DecodePicture, AlphaIsIgnored) {
  const auto picture =
      DecodePicture(Encoded(".png", cv::Mat(1, 1, CV_8UC4, cv::Scalar(255, 0, 0, 3))), kImageFile, 1, 1, 1);
  ASSERT_TRUE(picture.ok()) << picture.status().message();
  EXPECT_EQ((*picture)(0, 0), Decoded(0, 0, 255));
}

TEST(DecodePicture, LosslessKindsGiveTheSamePicture) {
  const cv::Mat image = NoiseBgr(31, 17);
  const auto png = DecodePicture(Encoded(".png", image), kImageFile, 31, 17, 1);
  ASSERT_TRUE(png.ok()) << png.status().message();
  for (const char* extension : {".ppm", ".tiff", ".bmp"}) {
    const auto other = DecodePicture(Encoded(extension, image), kImageFile, 31, 17, 1);
    ASSERT_TRUE(other.ok()) << extension << " " << other.status().message();
    EXPECT_EQ(*other, *png) << extension;
  }
}

TEST(DecodePicture, DownscalingIsTheRoundedMeanOfTheBoxAndCutsOffTheRest) {
  const cv::Mat image = NoiseBgr(11, 7);
  for (const int factor : {2, 4}) {
    const auto picture = DecodePicture(Encoded(".png", image), kImageFile, 11, 7, factor);
    ASSERT_TRUE(picture.ok()) << picture.status().message();
    ASSERT_EQ(picture->width(), 11 / factor);
    ASSERT_EQ(picture->height(), 7 / factor);
    for (int y = 0; y < picture->height(); ++y) {
      for (int x = 0; x < picture->width(); ++x) {
        double luma = 0;
        for (int i = 0; i < factor * factor; ++i) {
          const auto& pixel = image.at<cv::Vec3b>(y * factor + i / factor, x * factor + i % factor);
          luma += (0.299 * pixel[2] + 0.587 * pixel[1] + 0.114 * pixel[0]) / (factor * factor);
        }
        EXPECT_NEAR((*picture)(x, y).y, luma, 0.5 + 1e-9);
      }
    }
  }
}

TEST(DecodePicture, OtherSizeIsAnErrorWithBothSizes) {
  const auto picture = DecodePicture(Encoded(".png", NoiseBgr(4, 3)), kImageFile, 3, 4, 1);
  EXPECT_EQ(picture.status().code(), ErrorCode::kInvalidArgument);
  EXPECT_THAT(picture.status().message(), HasSubstr("has 4x3 pixels, expected 3x4"));
}

TEST(DecodePicture, RefusesOtherDownscaleFactorsAndWhatLeavesNothing) {
  const std::string bytes = Encoded(".png", NoiseBgr(3, 3));
  for (const int factor : {-1, 0, 3, 8}) {
    EXPECT_THAT(DecodePicture(bytes, kImageFile, 3, 3, factor).status().message(), HasSubstr("expected 1, 2 or 4"));
  }
  EXPECT_THAT(DecodePicture(bytes, kImageFile, 3, 3, 4).status().message(), HasSubstr("nothing left"));
}

TEST(DecodePicture, EveryTruncationOfAPngOrJpegIsAnError) {
  for (const char* extension : {".png", ".jpg"}) {
    const std::string bytes = Encoded(extension, NoiseBgr(16, 16));
    ASSERT_TRUE(DecodePicture(bytes, kImageFile, 16, 16, 1).ok());
    for (std::size_t size = 0; size < bytes.size(); size += (size < 64 ? 1 : 7)) {
      const auto picture = DecodePicture(bytes.substr(0, size), kImageFile, 16, 16, 1);
      EXPECT_EQ(picture.status().code(), ErrorCode::kInvalidArgument) << extension << " cut to " << size;
    }
  }
}

TEST(DecodePicture, ProgressiveJpegWithRestartMarkersIsComplete) {
  std::vector<unsigned char> bytes;
  ASSERT_TRUE(cv::imencode(".jpg", NoiseBgr(64, 64), bytes,
                           {cv::IMWRITE_JPEG_PROGRESSIVE, 1, cv::IMWRITE_JPEG_RST_INTERVAL, 2}));
  const std::string text(bytes.begin(), bytes.end());
  EXPECT_TRUE(IsCompleteJpeg(text));
  EXPECT_TRUE(DecodePicture(text, kImageFile, 64, 64, 1).ok());
  EXPECT_FALSE(IsCompleteJpeg(text.substr(0, text.size() - 2)));
}

TEST(DecodePicture, DamageWithinAPngIsAnError) {
  std::string bytes = Encoded(".png", NoiseBgr(32, 32));
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 0x55);
  EXPECT_FALSE(DecodePicture(bytes, kImageFile, 32, 32, 1).ok());
}

TEST(ReadPicture, MessagesBeginWithThePath) {
  const TemporaryFolder folder;
  const std::string empty = folder.Write("empty.png", "");
  const std::string text = folder.Write("text.png", "no picture");
  const std::string raw = folder.Write("raw.yuv", "123");
  EXPECT_THAT(ReadPicture({empty, kImageFile, 4, 4}, 1).status().message(), HasSubstr(empty + ": holds no bytes"));
  EXPECT_THAT(ReadPicture({text, kImageFile, 4, 4}, 1).status().message(), HasSubstr(text + ": cannot be decoded"));
  const PictureFormat yuv = {PictureFormat::Kind::kYuv420, 8, false, false};
  EXPECT_THAT(ReadPicture({raw, yuv, 4, 4}, 1).status().message(), HasSubstr(raw + ": holds 3 bytes, expected 24"));
  const auto missing = ReadPicture({folder.File("none.png"), kImageFile, 4, 4}, 1);
  EXPECT_EQ(missing.status().code(), ErrorCode::kUnavailable);
  EXPECT_THAT(missing.status().message(), HasSubstr("none.png"));
}

TEST(ReadPicture, OfAFileOfAllFramesIsAPartOfIt) {
  const TemporaryFolder folder;
  PictureFile file{
      folder.Write("all.yuv", "aaaabbbbcccc"), {.kind = PictureFormat::Kind::kYuv400, .all_frames = true}, 2, 2};
  for (const auto& [position, bytes] : {std::pair{0, "aaaa"}, std::pair{2, "cccc"}, std::pair{1, "bbbb"}}) {
    file.position = position;
    const auto read = ReadPictureBytes(file);
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(read->bytes, bytes);
    EXPECT_EQ(read->format, (PictureFormat{.kind = PictureFormat::Kind::kYuv400}));
    EXPECT_EQ(DigestOf(file, *read), Sha256(bytes)) << "that of a file of its own";
  }
  file.position = 3;
  EXPECT_THAT(ReadPictureBytes(file).status().message(),
              HasSubstr(file.path + ": holds 12 bytes, expected 4 from byte 12 on"));
}

// The same samples are another picture where they hold something else.
TEST(DigestOf, OfAVideoSaysWhatTheBytesHold) {
  const PictureFile file{.path = "v.mp4", .format = {.kind = PictureFormat::Kind::kVideo}};
  std::vector<Sha256Digest> digests;
  for (const PictureFormat& format :
       std::vector<PictureFormat>{{.kind = PictureFormat::Kind::kYuv420},
                                  {.kind = PictureFormat::Kind::kYuv444},
                                  {.kind = PictureFormat::Kind::kYuv420, .bits = 10},
                                  {.kind = PictureFormat::Kind::kYuv420, .full_range = true},
                                  {.kind = PictureFormat::Kind::kYuv420, .bt709 = true}})
    digests.push_back(DigestOf(file, {"samples", format}));
  std::ranges::sort(digests);
  EXPECT_EQ(std::ranges::adjacent_find(digests), digests.end());
}

TEST(ReadPicture, IsDecodingOfTheFilesBytes) {
  const TemporaryFolder folder;
  const std::string bytes = Encoded(".png", NoiseBgr(8, 8));
  const std::string path = folder.Write("p.png", bytes);
  EXPECT_EQ(ReadPictureBytes({path, kImageFile, 8, 8})->bytes, bytes);
  EXPECT_EQ(*ReadPicture({path, kImageFile, 8, 8}, 2), *DecodePicture(bytes, kImageFile, 8, 8, 2));
}

TEST(ToRgb, UndoesTheConversionUpToRounding) {
  const cv::Mat image = NoiseBgr(40, 40);
  const auto picture = DecodePicture(Encoded(".png", image), kImageFile, 40, 40, 1);
  ASSERT_TRUE(picture.ok());
  const RgbImage rgb = ToRgb(*picture);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      const auto& pixel = image.at<cv::Vec3b>(y, x);
      // Half a grey level in Y' and in C, times at most 1.772, and the final rounding.
      EXPECT_NEAR(rgb(x, y).r, pixel[2], 2);
      EXPECT_NEAR(rgb(x, y).g, pixel[1], 2);
      EXPECT_NEAR(rgb(x, y).b, pixel[0], 2);
    }
  }
}

// 16 x 16 grey pixels of 7 in one strip, with offsets of 64 bits.
std::string BigTiff() {
  constexpr std::uint64_t kPixels = 256;
  struct Tag {
    std::uint16_t tag;
    std::uint16_t type;  // 3, 4, 16: of 16, 32, 64 bits
    std::uint64_t value;
  };
  constexpr std::uint64_t kDirectory = 16;
  constexpr std::size_t kTags = 9;
  constexpr std::uint64_t kData = kDirectory + 8 + kTags * 20 + 8;
  const std::array<Tag, kTags> tags{{{256, 4, 16},
                                     {257, 4, 16},
                                     {258, 3, 8},
                                     {259, 3, 1},
                                     {262, 3, 1},
                                     {273, 16, kData},
                                     {277, 3, 1},
                                     {278, 4, 16},
                                     {279, 16, kPixels}}};
  std::string bytes("II+\0\10\0\0\0", 8);
  AppendU64(kDirectory, bytes);
  AppendU64(kTags, bytes);
  for (const Tag& tag : tags) {
    for (const std::uint16_t half : {tag.tag, tag.type}) {
      bytes.push_back(static_cast<char>(half & 0xff));
      bytes.push_back(static_cast<char>(half >> 8));
    }
    AppendU64(1, bytes);
    AppendU64(tag.value, bytes);
  }
  AppendU64(0, bytes);
  return bytes + std::string(kPixels, '\7');
}

TEST(DecodeImage, TakesTiffsOf64Bits) {
  const auto grey = DecodeGrey(BigTiff());
  ASSERT_TRUE(grey.ok()) << grey.status().message();
  EXPECT_EQ(grey->values.width(), 16);
  EXPECT_EQ(grey->values(15, 15), 7);
}

// OpenCV would write them to a file first, and leave that when they are damaged.
TEST(DecodeImage, LeavesNoFileBehind) {
  const TemporaryFolder folder;
  setenv("OPENCV_TEMP_PATH", folder.path().c_str(), 1);  // NOLINT(concurrency-mt-unsafe): one thread
  const std::string nitf = "NITF02.10" + std::string(400, '0');
  for (const std::string& other :
       {std::string("Pf\n5294 120602\n-1\n0123"), std::string("Pf\n1 1\n-1\n0123"), std::string("PF\n1 1\n-1\n0123"),
        std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 9999 +X 9999\n"),
        std::string("\x76\x2f\x31\x01\2\0\0\0", 8), std::string("\x59\xa6\x6a\x95\0\1\0\0", 8), nitf,
        std::string("P7\nWIDTH 1\n"), std::string("P")}) {
    const auto grey = DecodeGrey(other);
    EXPECT_EQ(grey.status().code(), ErrorCode::kInvalidArgument) << other;
    EXPECT_THAT(grey.status().message(), HasSubstr("begins like no PNG")) << other;
  }
  for (const std::string extension : {".png", ".jpg", ".tiff", ".bmp", ".pbm", ".pgm", ".ppm", ".webp", ".jp2"}) {
    const int type = extension == ".pbm" || extension == ".pgm" ? CV_8UC1 : CV_8UC3;
    const std::string bytes = Encoded(extension, cv::Mat(64, 64, type, cv::Scalar(9, 9, 9)));
    EXPECT_TRUE(DecodeImage(bytes).ok()) << extension << " " << DecodeImage(bytes).status().message();
    EXPECT_FALSE(DecodeImage(bytes.substr(0, 11)).ok()) << extension;
  }
  unsetenv("OPENCV_TEMP_PATH");  // NOLINT(concurrency-mt-unsafe): same
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(DecodeImage, TakesNoMemoryForPixelsThatAFileCannotHold) {
  for (const char* header : {"P5 30000 30000 255\n", "P6 32000 32000 65535\n"}) {
    const auto grey = DecodeGrey(std::string(header) + "0123456789");
    EXPECT_EQ(grey.status().code(), ErrorCode::kInvalidArgument) << header;
    EXPECT_THAT(grey.status().message(), HasSubstr("bytes cannot hold")) << header;
  }
}

TEST(DecodeImage, TakesLargePicturesOfOneColour) {
  const Grid<std::uint8_t> white(9000, 9000, 255);  // 81 MB in some 80 KB
  EXPECT_EQ(DecodeGrey(EncodeGreyPng(white).value()).value().values(8999, 8999), 255);
}

}  // namespace
}  // namespace depthfarm
