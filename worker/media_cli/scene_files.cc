#include "worker/media_cli/scene_files.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <exception>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <system_error>

namespace depthfarm {
namespace {

Result<Bytes> EncodeMat(const cv::Mat& picture) {
  try {
    Bytes bytes;
    if (!cv::imencode(".png", picture, bytes)) return Internal("png: the encoder refused a picture");
    return bytes;
  } catch (const std::exception& error) {
    return Internal(std::string("png: ") + error.what());
  }
}

void AppendLittleEndian(Bytes& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes.push_back(static_cast<unsigned char>(value >> (8 * i)));
}

void AppendSample(Bytes& bytes, double value, double largest, int bits) {
  const double rounded = std::floor(std::clamp(value, 0.0, largest) + 0.5);
  AppendLittleEndian(bytes, static_cast<std::uint32_t>(rounded), bits > 8 ? 2 : 1);
}

double Luma(const Rgb8& rgb) { return 0.299 * rgb.r + 0.587 * rgb.g + 0.114 * rgb.b; }

}  // namespace

Result<Bytes> EncodePng(const RgbImage& rgb) {
  cv::Mat picture(rgb.height(), rgb.width(), CV_8UC3);
  for (int y = 0; y < rgb.height(); ++y) {
    auto* row = picture.ptr<cv::Vec3b>(y);
    for (int x = 0; x < rgb.width(); ++x) {
      const auto& [r, g, b] = rgb(x, y);
      row[x] = cv::Vec3b(b, g, r);  // the image library's order
    }
  }
  return EncodeMat(picture);
}

Result<Bytes> EncodePng(const ZoneMap& zones) {
  cv::Mat picture(zones.height(), zones.width(), CV_8UC1);
  for (int y = 0; y < zones.height(); ++y) std::copy_n(zones.row(y), zones.width(), picture.ptr(y));
  return EncodeMat(picture);
}

Bytes EncodePfm(const DepthMap& depth) {
  const std::string header = "Pf\n" + std::to_string(depth.width()) + " " + std::to_string(depth.height()) + "\n-1.0\n";
  Bytes bytes(header.begin(), header.end());
  bytes.reserve(bytes.size() + 4 * depth.size());
  for (int y = depth.height() - 1; y >= 0; --y) {
    for (int x = 0; x < depth.width(); ++x) AppendLittleEndian(bytes, std::bit_cast<std::uint32_t>(depth(x, y)), 4);
  }
  return bytes;
}

Bytes EncodeYuv420(const RgbImage& rgb, int bits) {
  const double largest = (1 << bits) - 1;
  const double unit = largest / 255;
  const double middle = 1 << (bits - 1);
  Bytes bytes;
  bytes.reserve((bits > 8 ? 2 : 1) * (rgb.size() * 3 / 2 + rgb.width() + rgb.height() + 2));
  for (const auto& pixel : rgb.values()) AppendSample(bytes, unit * Luma(pixel), largest, bits);
  for (const auto channel : {&Rgb8::b, &Rgb8::r}) {  // Cb from blue, Cr from red
    const double scale = unit / (channel == &Rgb8::b ? 1.772 : 1.402);
    for (int y = 0; y < rgb.height(); y += 2) {
      for (int x = 0; x < rgb.width(); x += 2) {
        double sum = 0;
        for (int i = 0; i < 4; ++i) {  // at an odd border the last column or row counts twice
          const auto& pixel = rgb(std::min(x + i % 2, rgb.width() - 1), std::min(y + i / 2, rgb.height() - 1));
          sum += pixel.*channel - Luma(pixel);
        }
        AppendSample(bytes, middle + scale * sum / 4, largest, bits);
      }
    }
  }
  return bytes;
}

Status WriteWhole(const std::filesystem::path& file, std::span<const unsigned char> bytes) {
  std::filesystem::path partial = file;
  partial += ".partial";
  {
    std::ofstream stream(partial, std::ios::binary | std::ios::trunc);
    stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    stream.close();
    if (!stream) {
      std::error_code ignored;
      std::filesystem::remove(partial, ignored);
      return Unavailable(file.string() + ": " + std::to_string(bytes.size()) +
                         " bytes could not be written: check the folder's permissions and the free space");
    }
  }
  std::error_code error;
  std::filesystem::rename(partial, file, error);
  if (error) return Unavailable(file.string() + ": could not be put in place: " + error.message());
  return {};
}

Status MakeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return Unavailable(folder.string() + ": the folder could not be made: " + error.message());
  return {};
}

}  // namespace depthfarm
