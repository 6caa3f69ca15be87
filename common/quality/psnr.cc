#include "common/quality/psnr.h"

#include <cmath>
#include <limits>

namespace depthfarm {
namespace {

double Psnr(const LumaError& error, double scale) {
  if (error.pixels == 0) return std::numeric_limits<double>::quiet_NaN();
  if (error.squared_sum == 0) return std::numeric_limits<double>::infinity();
  const double mean = scale * scale * error.squared_sum / static_cast<double>(error.pixels);
  return 10.0 * std::log10(255.0 * 255.0 / mean);
}

}  // namespace

LumaError MeasureLumaError(const YcbcrImage& a, const YcbcrImage& b, const PixelMask* counted) {
  std::int64_t sum = 0;
  LumaError error;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (counted != nullptr && counted->values()[i] == 0) continue;
    const int difference = static_cast<int>(a.values()[i].y) - static_cast<int>(b.values()[i].y);
    sum += difference * difference;
    ++error.pixels;
  }
  error.squared_sum = static_cast<double>(sum);
  return error;
}

double PsnrVideoRange(const LumaError& error) { return Psnr(error, 219.0 / 255.0); }

double PsnrFullRange(const LumaError& error) { return Psnr(error, 1.0); }

}  // namespace depthfarm
