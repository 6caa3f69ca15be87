#include "common/media/colour_map.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "common/image/colour_conversion.h"
#include "common/media/png_encoder.h"

namespace depthfarm {
namespace {

constexpr std::int64_t kMaxSheetPixels = std::int64_t{1} << 28;
constexpr Rgb8 kWhite = {255, 255, 255};

// The 256 colours of TURBO: 0 dark blue, 255 dark red.
Result<std::array<Rgb8, 256>> TurboColours() {
  try {
    cv::Mat ramp(1, 256, CV_8UC1);
    for (int i = 0; i < 256; ++i) ramp.at<std::uint8_t>(0, i) = static_cast<std::uint8_t>(i);
    cv::Mat bgr;
    cv::applyColorMap(ramp, bgr, cv::COLORMAP_TURBO);
    std::array<Rgb8, 256> colours;
    for (int i = 0; i < 256; ++i) {
      const auto& pixel = bgr.at<cv::Vec3b>(0, i);
      colours[static_cast<std::size_t>(i)] = {pixel[2], pixel[1], pixel[0]};
    }
    return colours;
  } catch (const cv::Exception& error) {
    return Internal(std::string("colour map: ") + error.what());
  }
}

}  // namespace

Result<RgbImage> ColourMapped(const DepthMap& depth, const DepthCode& code) {
  DEPTHFARM_ASSIGN_OR_RETURN(const auto colours, TurboColours());
  const Grid<std::uint16_t> codes = EncodeDepth(depth, code);
  RgbImage result(depth.width(), depth.height());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    if (codes.values()[i] != 0) result.values()[i] = colours[codes.values()[i] >> 8];
  }
  return result;
}

RgbImage ToRgb(const YcbcrImage& picture) {
  RgbImage result(picture.width(), picture.height());
  std::transform(picture.values().begin(), picture.values().end(), result.values().begin(), [](const Ycbcr& pixel) {
    const double cb = pixel.cb - 128;
    const double cr = pixel.cr - 128;
    const double r = pixel.y + 1.402 * cr;
    const double b = pixel.y + 1.772 * cb;
    const double g = (pixel.y - 0.299 * r - 0.114 * b) / 0.587;
    return Rgb8{RoundedToByte(r), RoundedToByte(g), RoundedToByte(b)};
  });
  return result;
}

Result<RgbImage> ContactSheet(const std::vector<RgbImage>& pictures, int columns, int gap) {
  if (pictures.empty() || columns < 1 || gap < 0) {
    return InvalidArgument("a contact sheet of " + std::to_string(pictures.size()) + " pictures in " +
                           std::to_string(columns) + " columns with a gap of " + std::to_string(gap) +
                           " pixels, expected at least one picture, one column and no negative gap");
  }
  std::int64_t cell_width = 0;
  std::int64_t cell_height = 0;
  for (const RgbImage& picture : pictures) {
    cell_width = std::max<std::int64_t>(cell_width, picture.width());
    cell_height = std::max<std::int64_t>(cell_height, picture.height());
  }
  const auto count = static_cast<std::int64_t>(pictures.size());
  const std::int64_t across = std::min<std::int64_t>(columns, count);
  const std::int64_t down = (count + across - 1) / across;
  const std::int64_t width = across * cell_width + (across - 1) * gap;
  const std::int64_t height = down * cell_height + (down - 1) * gap;
  if (width < 1 || height < 1 || width > kMaxSheetPixels / height) {
    return InvalidArgument("a contact sheet of " + std::to_string(width) + "x" + std::to_string(height) +
                           " pixels, expected 1 to " + std::to_string(kMaxSheetPixels));
  }
  RgbImage sheet(static_cast<int>(width), static_cast<int>(height), kWhite);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const auto index = static_cast<std::int64_t>(i);
    const auto left = static_cast<int>(index % across * (cell_width + gap));
    const auto top = static_cast<int>(index / across * (cell_height + gap));
    for (int y = 0; y < pictures[i].height(); ++y) {
      const Rgb8* row = pictures[i].row(y);
      std::copy(row, row + pictures[i].width(), sheet.row(top + y) + left);
    }
  }
  return sheet;
}

RgbImage Shrunk(const RgbImage& picture, int factor) {
  RgbImage result(picture.width() / factor, picture.height() / factor);
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      std::array<std::int64_t, 3> sum = {0, 0, 0};
      for (int sy = y * factor; sy < (y + 1) * factor; ++sy) {
        for (int sx = x * factor; sx < (x + 1) * factor; ++sx) {
          const Rgb8& pixel = picture(sx, sy);
          sum[0] += pixel.r;
          sum[1] += pixel.g;
          sum[2] += pixel.b;
        }
      }
      const auto mean = [&](std::int64_t value) {
        return RoundedToByte(static_cast<double>(value) / (factor * factor));
      };
      result(x, y) = {mean(sum[0]), mean(sum[1]), mean(sum[2])};
    }
  }
  return result;
}

Result<std::string> EncodeRgbPng(const RgbImage& picture) {
  std::vector<std::uint8_t> bgr;
  bgr.reserve(picture.size() * 3);
  for (const Rgb8& pixel : picture.values()) bgr.insert(bgr.end(), {pixel.b, pixel.g, pixel.r});
  return EncodePng(cv::Mat(picture.height(), picture.width(), CV_8UC3, bgr.data()));
}

}  // namespace depthfarm
