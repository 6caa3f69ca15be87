#include "common/media/picture_reader.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

#include "common/files/atomic_file.h"
#include "common/image/colour_conversion.h"
#include "common/media/image_codec.h"
#include "common/media/raw_picture.h"

namespace depthfarm {
namespace {

constexpr std::uint64_t kMaxImageFileBytes = std::uint64_t{1} << 30;

// Sums of the box of pixels that becomes pixel (x, y), channel by channel.
template <typename Sample>
std::array<std::int64_t, 3> BoxSum(const cv::Mat& image, int x, int y, int downscale) {
  const int channels = image.channels();
  if (downscale == 1 && channels >= 3) {  // nearly every picture
    const Sample* pixel = image.ptr<Sample>(y) + static_cast<std::ptrdiff_t>(x) * channels;
    return {pixel[0], pixel[1], pixel[2]};
  }
  std::array<std::int64_t, 3> sum = {0, 0, 0};
  for (int sy = y * downscale; sy < (y + 1) * downscale; ++sy) {
    const Sample* pixel = image.ptr<Sample>(sy) + static_cast<std::ptrdiff_t>(x) * downscale * channels;
    for (int i = 0; i < downscale; ++i, pixel += channels) {
      for (int c = 0; c < std::min(channels, 3); ++c) sum[static_cast<std::size_t>(c)] += pixel[c];
    }
  }
  return sum;
}

template <typename Sample>
YcbcrImage Converted(const cv::Mat& image, int downscale, double max) {
  YcbcrImage result(image.cols / downscale, image.rows / downscale);
  // Sums to 0..255. For 8 bits and no downscaling this divides by 1: integers stay exact.
  const double divisor = downscale * downscale * (max / 255);
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      const std::array<std::int64_t, 3> sum = BoxSum<Sample>(image, x, y, downscale);
      const double first = static_cast<double>(sum[0]) / divisor;
      if (image.channels() == 1) {
        result(x, y) = RoundedTo8Bit({first, 0, 0});
      } else {
        result(x, y) = RoundedTo8Bit(
            Bt601FromRgb(static_cast<double>(sum[2]) / divisor, static_cast<double>(sum[1]) / divisor, first));
      }
    }
  }
  return result;
}

}  // namespace

Result<PictureBytes> ReadPictureBytes(const PictureFile& file, VideoReaders* videos) {
  if (file.format.kind == PictureFormat::Kind::kVideo) {
    VideoReaders alone;
    return (videos != nullptr ? videos : &alone)
        ->Read({file.path, file.format, file.width, file.height, file.frames}, file.position);
  }
  PictureBytes picture{.bytes = {}, .format = file.format};
  picture.format.all_frames = false;
  const std::uint64_t raw_bytes = file.format.raw() ? RawPictureBytes(file.format, file.width, file.height) : 0;
  if (file.format.all_frames) {
    DEPTHFARM_ASSIGN_OR_RETURN(
        picture.bytes, ReadFileRange(file.path, static_cast<std::uint64_t>(file.position) * raw_bytes, raw_bytes));
  } else {
    DEPTHFARM_ASSIGN_OR_RETURN(picture.bytes, ReadFileBytes(file.path, std::max(raw_bytes, kMaxImageFileBytes)));
  }
  return picture;
}

Sha256Digest DigestOf(const PictureFile& file, const PictureBytes& picture) {
  if (file.format.kind != PictureFormat::Kind::kVideo) return Sha256(picture.bytes);
  const PictureFormat& format = picture.format;
  return Sha256(RawFormatName(format) + (format.full_range ? " full" : " limited") +
                (format.bt709 ? " bt709 " : " bt601 ") + Hex(Sha256(picture.bytes)));
}

Result<YcbcrImage> DecodePicture(std::string_view bytes, const PictureFormat& format, int width, int height,
                                 int downscale) {
  if (downscale != 1 && downscale != 2 && downscale != 4) {
    return InvalidArgument("downscale is " + std::to_string(downscale) + ", expected 1, 2 or 4");
  }
  if (width < downscale || height < downscale) {
    return InvalidArgument("a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                           " pixels has nothing left when it is made " + std::to_string(downscale) + " times smaller");
  }
  if (format.raw()) return DecodeRawPicture(bytes, format, width, height, downscale);
  DEPTHFARM_ASSIGN_OR_RETURN(const cv::Mat image, DecodeImage(bytes));
  if (image.cols != width || image.rows != height) {
    return InvalidArgument("has " + std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                           " pixels, expected " + std::to_string(width) + "x" + std::to_string(height) +
                           ", the camera's size");
  }
  return image.depth() == CV_8U ? Converted<std::uint8_t>(image, downscale, 255)
                                : Converted<std::uint16_t>(image, downscale, 65535);
}

Result<YcbcrImage> ReadPicture(const PictureFile& file, int downscale, VideoReaders* videos) {
  DEPTHFARM_ASSIGN_OR_RETURN(const PictureBytes read, ReadPictureBytes(file, videos));
  auto picture = DecodePicture(read.bytes, read.format, file.width, file.height, downscale);
  if (!picture.ok()) return picture.status().WithContext(file.path);
  return picture;
}

}  // namespace depthfarm
