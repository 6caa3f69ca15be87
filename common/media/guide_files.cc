#include "common/media/guide_files.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "common/image/depth_code.h"
#include "common/media/depth_file.h"
#include "common/media/exr.h"
#include "common/media/grey_picture.h"
#include "common/media/pfm.h"
#include "common/media/raw_picture.h"

namespace depthfarm {
namespace {

using Holds = PriorFormat::Holds;

// 2 %: sides are rounded, and networks want multiples of 14 or 32.
constexpr std::int64_t kProportionPercent = 2;

template <typename T>
Result<Grid<T>> SampledAt(const Grid<T>& map, int width, int height) {
  if (map.width() == width && map.height() == height) return map;
  const std::int64_t a = std::int64_t{map.width()} * height;
  const std::int64_t b = std::int64_t{map.height()} * width;
  if (std::abs(a - b) * 100 > std::max(a, b) * kProportionPercent) {
    return InvalidArgument("has " + std::to_string(map.width()) + "x" + std::to_string(map.height()) +
                           " pixels, expected the proportions of " + std::to_string(width) + "x" +
                           std::to_string(height));
  }
  Grid<T> sampled(width, height);
  for (int y = 0; y < height; ++y) {
    const auto from_y = static_cast<int>((2 * std::int64_t{y} + 1) * map.height() / (2 * std::int64_t{height}));
    for (int x = 0; x < width; ++x) {
      const auto from_x = static_cast<int>((2 * std::int64_t{x} + 1) * map.width() / (2 * std::int64_t{width}));
      sampled(x, y) = map(from_x, from_y);
    }
  }
  return sampled;
}

// What no float can hold is no depth.
float Known(double value) {
  return value > 0 && value < std::numeric_limits<float>::max() ? static_cast<float>(value) : 0.0F;
}

float InverseDepthOf(double value, const PriorFormat& format) {
  if (!std::isfinite(value) || !(value > 0)) return 0;
  switch (format.holds) {
    case Holds::kDepth:
      return Known(1 / (value * format.unit));
    case Holds::kInverseDepth:
      return Known(value / format.unit);
    case Holds::kRelativeDepth:
      return Known(value);
    case Holds::kNothing:
    case Holds::kCodes:
      break;
  }
  return 0;
}

bool IsPfm(std::string_view bytes) { return bytes.starts_with("Pf") || bytes.starts_with("PF"); }

Result<Grid<float>> Values(std::string_view bytes) {
  if (IsPfm(bytes)) return DecodePfm(bytes);
  if (IsExr(bytes)) return DecodeExr(bytes);
  DEPTHFARM_ASSIGN_OR_RETURN(const GreyPicture grey, DecodeGrey(bytes));
  Grid<float> values(grey.values.width(), grey.values.height());
  for (std::size_t i = 0; i < values.size(); ++i) values.values()[i] = grey.values.values()[i];
  return values;
}

// As depth maps of codes are written: PNG, or a raw picture, which says nothing of its size.
Result<Grid<std::uint16_t>> Codes(std::string_view bytes, int width, int height) {
  if (bytes.size() == RawPictureBytes(kRawCodes, width, height) && !bytes.starts_with("\x89PNG"))
    return DecodeRawLuma(bytes, kRawCodes, width, height);
  return DecodeDepthPng(bytes);
}

}  // namespace

Result<Grid<float>> DecodePrior(std::string_view bytes, const PriorFormat& format, int width, int height) {
  if (format.holds == Holds::kCodes) {
    DEPTHFARM_ASSIGN_OR_RETURN(const DepthCode code, DepthCode::Create(format.z_near, format.z_far));
    DEPTHFARM_ASSIGN_OR_RETURN(const Grid<std::uint16_t> stored, Codes(bytes, width, height));
    DEPTHFARM_ASSIGN_OR_RETURN(const Grid<std::uint16_t> codes, SampledAt(stored, width, height));
    Grid<float> inverse(width, height);
    for (std::size_t i = 0; i < codes.size(); ++i)
      inverse.values()[i] = static_cast<float>(code.ToInverseDepth(codes.values()[i]));
    return inverse;
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const Grid<float> values, Values(bytes));
  DEPTHFARM_ASSIGN_OR_RETURN(Grid<float> inverse, SampledAt(values, width, height));
  for (float& value : inverse.values()) value = InverseDepthOf(value, format);
  return inverse;
}

Result<Grid<float>> DecodeShare(std::string_view bytes, int width, int height) {
  DEPTHFARM_ASSIGN_OR_RETURN(const GreyPicture grey, DecodeGrey(bytes));
  DEPTHFARM_ASSIGN_OR_RETURN(const Grid<std::uint16_t> values, SampledAt(grey.values, width, height));
  const float full = grey.bits == 8 ? 255.0F : 65535.0F;
  Grid<float> share(width, height);
  for (std::size_t i = 0; i < share.size(); ++i) share.values()[i] = static_cast<float>(values.values()[i]) / full;
  return share;
}

Status ApplyMask(std::string_view bytes, YcbcrImage& picture) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Grid<float> share, DecodeShare(bytes, picture.width(), picture.height()));
  for (std::size_t i = 0; i < share.size(); ++i)
    picture.values()[i].matte = static_cast<std::uint8_t>(std::lround(share.values()[i] * kForegroundMatte));
  return {};
}

}  // namespace depthfarm
