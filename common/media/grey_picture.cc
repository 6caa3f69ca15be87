#include "common/media/grey_picture.h"

#include <opencv2/core.hpp>

#include "common/files/atomic_file.h"
#include "common/media/image_codec.h"
#include "common/media/png_encoder.h"

namespace depthfarm {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 30;

// Copies the one channel, or the first of equal ones; false at a pixel with a colour. Alpha is ignored.
template <typename Sample>
bool CopyGrey(const cv::Mat& image, Grid<std::uint16_t>* values) {
  const int channels = image.channels();
  for (int y = 0; y < image.rows; ++y) {
    const Sample* pixel = image.ptr<Sample>(y);
    for (int x = 0; x < image.cols; ++x, pixel += channels) {
      if (channels >= 3 && (pixel[0] != pixel[1] || pixel[0] != pixel[2])) return false;
      (*values)(x, y) = pixel[0];
    }
  }
  return true;
}

template <typename Sample>
Result<std::string> EncodeGrid(const Grid<Sample>& values) {
  // The encoder only reads.
  const cv::Mat image(values.height(), values.width(), cv::DataType<Sample>::type,
                      const_cast<Sample*>(values.values().data()));
  return EncodePng(image);
}

}  // namespace

Result<GreyPicture> DecodeGrey(std::string_view bytes) {
  DEPTHFARM_ASSIGN_OR_RETURN(const cv::Mat image, DecodeImage(bytes));
  GreyPicture grey;
  grey.bits = image.depth() == CV_8U ? 8 : 16;
  grey.values = Grid<std::uint16_t>(image.cols, image.rows);
  const bool is_grey =
      grey.bits == 8 ? CopyGrey<std::uint8_t>(image, &grey.values) : CopyGrey<std::uint16_t>(image, &grey.values);
  if (!is_grey) return InvalidArgument("is coloured, expected a grey picture");
  return grey;
}

Result<GreyPicture> ReadGrey(const std::string& path) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, ReadFileBytes(path, kMaxFileBytes));
  auto grey = DecodeGrey(bytes);
  if (!grey.ok()) return grey.status().WithContext(path);
  return grey;
}

Result<std::string> EncodeGreyPng(const Grid<std::uint8_t>& values) { return EncodeGrid(values); }
Result<std::string> EncodeGreyPng(const Grid<std::uint16_t>& values) { return EncodeGrid(values); }

}  // namespace depthfarm
