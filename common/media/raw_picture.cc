#include "common/media/raw_picture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/image/colour_conversion.h"

namespace depthfarm {
namespace {

int BytesPerSample(int bits) { return bits > 8 ? 2 : 1; }

Status CheckSize(std::string_view bytes, const PictureFormat& format, int width, int height) {
  const std::uint64_t expected = RawPictureBytes(format, width, height);
  if (bytes.size() == expected) return {};
  return InvalidArgument("holds " + std::to_string(bytes.size()) + " bytes, expected " + std::to_string(expected) +
                         " for one picture of " + std::to_string(width) + "x" + std::to_string(height) + " " +
                         RawFormatName(format));
}

// Takes one plane off the front of `bytes`.
Result<Grid<std::uint16_t>> TakePlane(std::string_view* bytes, const PictureFormat& format, int width, int height) {
  Grid<std::uint16_t> plane(width, height);
  const auto* data = reinterpret_cast<const unsigned char*>(bytes->data());
  const std::size_t size = static_cast<std::size_t>(BytesPerSample(format.bits));
  const int max = (1 << format.bits) - 1;
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const int sample = size == 1 ? data[i] : data[2 * i] | (data[2 * i + 1] << 8);
    if (sample > max) {
      return InvalidArgument("holds the sample " + std::to_string(sample) + ", expected at most " +
                             std::to_string(max) + " in " + RawFormatName(format));
    }
    plane.values()[i] = static_cast<std::uint16_t>(sample);
  }
  bytes->remove_prefix(size * plane.size());
  return plane;
}

constexpr std::int64_t kUpsamplingScale = 8;

// Chroma at pixel (x, y) of the full resolution, times kUpsamplingScale.
std::int64_t ChromaAt(const Grid<std::uint16_t>& plane, ChromaShift shift, int x, int y) {
  const auto across = [&](int row) {
    if (shift.x == 0) return 2 * std::int64_t{plane(x, row)};
    const int column = x / 2;
    return std::int64_t{plane(column, row)} + plane(std::min(column + x % 2, plane.width() - 1), row);
  };
  if (shift.y == 0) return 4 * across(y);
  const int row = y / 2;
  return 3 * across(row) + across(std::clamp(y % 2 == 0 ? row - 1 : row + 1, 0, plane.height() - 1));
}

// What turns averaged samples into 8-bit units.
struct RangeConversion {
  double black;  // in samples
  double y_scale;
  double chroma_zero;  // in samples
  double chroma_scale;
};

RangeConversion ConversionOf(const PictureFormat& format) {
  const double unit = 1 << (format.bits - 8);  // samples per 8-bit unit
  const double max = (1 << format.bits) - 1;
  if (format.full_range) return {0, 255 / max, 128 * unit, 255 / max};
  return {16 * unit, 255 / (219 * unit), 128 * unit, 255 / (224 * unit)};
}

void AppendSample(double value, int bits, std::string& bytes) {
  const double max = (1 << bits) - 1;
  const auto sample = static_cast<std::uint32_t>(std::clamp(std::floor(value + 0.5), 0.0, max));
  for (int i = 0; i < BytesPerSample(bits); ++i) bytes.push_back(static_cast<char>(sample >> (8 * i) & 0xff));
}

// The colour of a pixel, edges repeated.
YcbcrReal ColourAt(const RgbImage& picture, int x, int y) {
  const Rgb8& pixel = picture(std::clamp(x, 0, picture.width() - 1), std::clamp(y, 0, picture.height() - 1));
  return Bt601FromRgb(pixel.r, pixel.g, pixel.b);
}

}  // namespace

Result<YcbcrImage> DecodeRawPicture(std::string_view bytes, const PictureFormat& format, int width, int height,
                                    int downscale) {
  DEPTHFARM_RETURN_IF_ERROR(CheckSize(bytes, format, width, height));
  DEPTHFARM_ASSIGN_OR_RETURN(const Grid<std::uint16_t> luma, TakePlane(&bytes, format, width, height));
  std::array<Grid<std::uint16_t>, 2> chroma;
  const bool coloured = format.kind != PictureFormat::Kind::kYuv400;
  const ChromaShift shift = ChromaShiftOf(format.kind);
  for (Grid<std::uint16_t>& plane : chroma) {
    if (!coloured) break;
    DEPTHFARM_ASSIGN_OR_RETURN(plane,
                               TakePlane(&bytes, format, (width + shift.x) >> shift.x, (height + shift.y) >> shift.y));
  }
  const RangeConversion conversion = ConversionOf(format);
  const double pixels = downscale * downscale;
  YcbcrImage result(width / downscale, height / downscale);
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      std::int64_t y_sum = 0;
      std::array<std::int64_t, 2> chroma_sum = {0, 0};
      for (int sy = y * downscale; sy < (y + 1) * downscale; ++sy) {
        for (int sx = x * downscale; sx < (x + 1) * downscale; ++sx) {
          y_sum += luma(sx, sy);
          for (std::size_t c = 0; coloured && c < 2; ++c) chroma_sum[c] += ChromaAt(chroma[c], shift, sx, sy);
        }
      }
      YcbcrReal colour;
      colour.y = (static_cast<double>(y_sum) / pixels - conversion.black) * conversion.y_scale;
      if (coloured) {
        const auto scaled = [&](std::int64_t sum) {
          const double sample = static_cast<double>(sum) / (pixels * kUpsamplingScale);
          return (sample - conversion.chroma_zero) * conversion.chroma_scale;
        };
        colour.cb = scaled(chroma_sum[0]);
        colour.cr = scaled(chroma_sum[1]);
      }
      result(x, y) = RoundedTo8Bit(format.bt709 ? Bt601FromBt709(colour) : colour);
    }
  }
  return result;
}

std::string EncodeRawYuv420(const RgbImage& picture, int bits) {
  const PictureFormat format = {.kind = PictureFormat::Kind::kYuv420, .bits = bits, .full_range = true};
  const RangeConversion conversion = ConversionOf(format);
  std::string bytes;
  bytes.reserve(RawPictureBytes(format, picture.width(), picture.height()));
  for (const Rgb8& pixel : picture.values()) {
    AppendSample(Bt601FromRgb(pixel.r, pixel.g, pixel.b).y / conversion.y_scale, bits, bytes);
  }
  for (const auto channel : {&YcbcrReal::cb, &YcbcrReal::cr}) {
    const auto across = [&](int x, int y) {
      return ColourAt(picture, x - 1, y).*channel + 2 * ColourAt(picture, x, y).*channel +
             ColourAt(picture, x + 1, y).*channel;
    };
    for (int y = 0; y < picture.height(); y += 2) {
      for (int x = 0; x < picture.width(); x += 2) {
        const double mean = (across(x, y) + across(x, y + 1)) / 8;
        AppendSample(conversion.chroma_zero + mean / conversion.chroma_scale, bits, bytes);
      }
    }
  }
  return bytes;
}

std::string EncodeRawLuma16(const Grid<std::uint16_t>& luma) {
  constexpr int kBits = 16;
  constexpr double kGrey = 32768;
  const PictureFormat format = {.kind = PictureFormat::Kind::kYuv420, .bits = kBits, .full_range = true};
  const std::size_t size = RawPictureBytes(format, luma.width(), luma.height());
  std::string bytes;
  bytes.reserve(size);
  for (const std::uint16_t sample : luma.values()) AppendSample(sample, kBits, bytes);
  while (bytes.size() < size) AppendSample(kGrey, kBits, bytes);
  return bytes;
}

std::string EncodeLimitedYuv420(const YcbcrImage& picture) {
  // Of whole 8-bit units there are few: a table for luma and one for the eightfold mean of chroma.
  const PictureFormat format = {.kind = PictureFormat::Kind::kYuv420};
  const RangeConversion conversion = ConversionOf(format);
  std::string luma;
  for (int y = 0; y < 256; ++y) AppendSample(conversion.black + y / conversion.y_scale, 8, luma);
  std::string chroma;
  for (int sum = 0; sum <= 8 * 255; ++sum)
    AppendSample(conversion.chroma_zero + (sum / 8.0 - 128) / conversion.chroma_scale, 8, chroma);

  std::string bytes;
  bytes.reserve(RawPictureBytes(format, picture.width(), picture.height()));
  for (const Ycbcr& pixel : picture.values()) bytes.push_back(luma[pixel.y]);
  const int right = picture.width() - 1;
  for (const auto channel : {&Ycbcr::cb, &Ycbcr::cr}) {
    for (int y = 0; y < picture.height(); y += 2) {
      const Ycbcr* upper = picture.row(y);
      const Ycbcr* lower = picture.row(std::min(y + 1, picture.height() - 1));
      for (int x = 0; x <= right; x += 2) {
        const int before = std::max(x - 1, 0);
        const int after = std::min(x + 1, right);
        const int sum = upper[before].*channel + 2 * (upper[x].*channel) + upper[after].*channel +
                        lower[before].*channel + 2 * (lower[x].*channel) + lower[after].*channel;
        bytes.push_back(chroma[static_cast<std::size_t>(sum)]);
      }
    }
  }
  return bytes;
}

Result<Grid<std::uint16_t>> DecodeRawLuma(std::string_view bytes, const PictureFormat& format, int width, int height) {
  DEPTHFARM_RETURN_IF_ERROR(CheckSize(bytes, format, width, height));
  return TakePlane(&bytes, format, width, height);
}

}  // namespace depthfarm
