#include "common/media/picture_png.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "common/media/png_encoder.h"

namespace depthfarm {
namespace {

constexpr int kMostPixelsOfASide = 65535;

}  // namespace

Result<std::string> EncodePicturePng(const PictureSamples& picture) {
  if (picture.data == nullptr || picture.width < 1 || picture.height < 1 || picture.width > kMostPixelsOfASide ||
      picture.height > kMostPixelsOfASide) {
    return InvalidArgument("a picture of " + std::to_string(picture.width) + "x" + std::to_string(picture.height) +
                           (picture.data == nullptr ? " without samples" : " pixels"));
  }
  if ((picture.channels != 1 && picture.channels != 3) ||
      (picture.bytes_per_sample != 1 && picture.bytes_per_sample != 2)) {
    return InvalidArgument("a picture has " + std::to_string(picture.channels) + " channels of " +
                           std::to_string(picture.bytes_per_sample) + " bytes, expected 1 or 3 of 1 or 2");
  }
  const std::size_t packed = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.channels) *
                             static_cast<std::size_t>(picture.bytes_per_sample);
  const std::size_t row_bytes = picture.row_bytes == 0 ? packed : picture.row_bytes;
  if (row_bytes < packed) {
    return InvalidArgument("rows of a picture are " + std::to_string(row_bytes) + " bytes apart, they take " +
                           std::to_string(packed));
  }
  const int type = CV_MAKETYPE(picture.bytes_per_sample == 1 ? CV_8U : CV_16U, picture.channels);
  // OpenCV has no view of constant samples; it only reads them here.
  const cv::Mat view(picture.height, picture.width, type, const_cast<void*>(picture.data), row_bytes);
  if (picture.channels == 1) return EncodePng(view);
  cv::Mat bgr;
  cv::cvtColor(view, bgr, cv::COLOR_RGB2BGR);
  return EncodePng(bgr);
}

}  // namespace depthfarm
