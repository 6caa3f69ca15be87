#include "common/media/png_encoder.h"

#include <libdeflate.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <opencv2/core.hpp>
#include <string_view>
#include <vector>

namespace depthfarm {
namespace {

constexpr std::string_view kSignature = "\x89PNG\r\n\x1a\n";
constexpr std::uint8_t kGrey = 0;
constexpr std::uint8_t kTruecolour = 2;
constexpr std::uint8_t kUp = 2;
constexpr std::uint8_t kPaeth = 4;
constexpr std::size_t kMostBytesOfChunk = std::size_t{1} << 30;  // PNG: less than 2^31

// What is done to rows before they are compressed. Pictures have noise, of which a search for repetitions finds
// nothing; depth has rows that resemble the one above (benchmarks.md, "PNG files").
struct Settings {
  std::uint8_t filter;
  int level;
};
constexpr Settings kOfPictures{.filter = kPaeth, .level = 1};
constexpr Settings kOfDepth{.filter = kUp, .level = 4};

void AppendBigEndian(std::uint32_t value, std::string& bytes) {
  for (int shift = 24; shift >= 0; shift -= 8) bytes.push_back(static_cast<char>(value >> shift & 0xFFU));
}

void AppendChunk(std::string_view type, std::string_view content, std::string& bytes) {
  AppendBigEndian(static_cast<std::uint32_t>(content.size()), bytes);
  const std::size_t checked = bytes.size();
  bytes.append(type).append(content);
  AppendBigEndian(libdeflate_crc32(0, bytes.data() + checked, bytes.size() - checked), bytes);
}

// A row as PNG has it: red first, the high byte of a sample first.
template <typename Sample>
void CopyRow(const cv::Mat& image, int y, std::uint8_t* bytes) {
  const auto put = [&bytes](Sample sample) {
    if constexpr (sizeof(Sample) == 2) *bytes++ = static_cast<std::uint8_t>(sample >> 8U);
    *bytes++ = static_cast<std::uint8_t>(sample);
  };
  const auto* pixel = image.ptr<Sample>(y);
  if (image.channels() == 1) {
    for (int x = 0; x < image.cols; ++x) put(pixel[x]);
    return;
  }
  for (int x = 0; x < image.cols; ++x, pixel += 3) {
    put(pixel[2]);
    put(pixel[1]);
    put(pixel[0]);
  }
}

std::uint8_t PaethPredictor(int left, int above, int above_left) {
  const int estimate = left + above - above_left;
  const int of_left = std::abs(estimate - left);
  const int of_above = std::abs(estimate - above);
  const int of_above_left = std::abs(estimate - above_left);
  if (of_left <= of_above && of_left <= of_above_left) return static_cast<std::uint8_t>(left);
  return static_cast<std::uint8_t>(of_above <= of_above_left ? above : above_left);
}

// `above`: the row before, zeros for the first one. `pixel_bytes`: how far the one to the left is.
void FilterRow(std::uint8_t filter, const std::vector<std::uint8_t>& row, const std::vector<std::uint8_t>& above,
               std::size_t pixel_bytes, std::uint8_t* filtered) {
  *filtered++ = filter;
  if (filter == kUp) {
    for (std::size_t i = 0; i < row.size(); ++i) filtered[i] = static_cast<std::uint8_t>(row[i] - above[i]);
    return;
  }
  for (std::size_t i = 0; i < pixel_bytes; ++i) filtered[i] = static_cast<std::uint8_t>(row[i] - above[i]);
  for (std::size_t i = pixel_bytes; i < row.size(); ++i) {
    const std::uint8_t predicted = PaethPredictor(row[i - pixel_bytes], above[i], above[i - pixel_bytes]);
    filtered[i] = static_cast<std::uint8_t>(row[i] - predicted);
  }
}

std::vector<std::uint8_t> FilteredRows(const cv::Mat& image, std::uint8_t filter) {
  const std::size_t pixel_bytes = image.elemSize();
  const std::size_t row_bytes = static_cast<std::size_t>(image.cols) * pixel_bytes;
  std::vector<std::uint8_t> filtered((row_bytes + 1) * static_cast<std::size_t>(image.rows));
  std::vector<std::uint8_t> row(row_bytes);
  std::vector<std::uint8_t> above(row_bytes, 0);
  std::uint8_t* to = filtered.data();
  for (int y = 0; y < image.rows; ++y, to += row_bytes + 1) {
    image.depth() == CV_8U ? CopyRow<std::uint8_t>(image, y, row.data()) : CopyRow<std::uint16_t>(image, y, row.data());
    FilterRow(filter, row, above, pixel_bytes, to);
    row.swap(above);
  }
  return filtered;
}

std::string Compressed(const std::vector<std::uint8_t>& bytes, int level) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> compressor(
      libdeflate_alloc_compressor(level), libdeflate_free_compressor);
  if (compressor == nullptr) throw std::bad_alloc();
  std::string compressed(libdeflate_zlib_compress_bound(compressor.get(), bytes.size()), '\0');
  compressed.resize(
      libdeflate_zlib_compress(compressor.get(), bytes.data(), bytes.size(), compressed.data(), compressed.size()));
  return compressed;
}

std::string Header(const cv::Mat& image) {
  std::string header;
  AppendBigEndian(static_cast<std::uint32_t>(image.cols), header);
  AppendBigEndian(static_cast<std::uint32_t>(image.rows), header);
  header.push_back(static_cast<char>(8 * image.elemSize1()));
  header.push_back(static_cast<char>(image.channels() == 1 ? kGrey : kTruecolour));
  header.append(3, '\0');  // deflate, the five filters, not interlaced
  return header;
}

}  // namespace

Result<std::string> EncodePng(const cv::Mat& image) {
  const bool depth = image.depth() == CV_8U || image.depth() == CV_16U;
  if (image.empty() || image.dims != 2 || !depth || (image.channels() != 1 && image.channels() != 3)) {
    return InvalidArgument("a picture of " + std::to_string(image.cols) + "x" + std::to_string(image.rows) +
                           " pixels of " + std::to_string(image.channels()) + " channels cannot be encoded as PNG");
  }
  try {
    const Settings settings = image.depth() == CV_8U ? kOfPictures : kOfDepth;
    std::string png(kSignature);
    AppendChunk("IHDR", Header(image), png);
    const std::string data = Compressed(FilteredRows(image, settings.filter), settings.level);
    for (std::size_t at = 0; at < data.size(); at += kMostBytesOfChunk)
      AppendChunk("IDAT", std::string_view(data).substr(at, kMostBytesOfChunk), png);
    AppendChunk("IEND", {}, png);
    return png;
  } catch (const std::bad_alloc&) {
    return Unavailable("no memory to encode a picture as PNG");
  }
}

}  // namespace depthfarm
