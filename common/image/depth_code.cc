#include "common/image/depth_code.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace depthfarm {
namespace {

constexpr double kSteps = 65534;

template <typename To, typename From, typename Function>
Grid<To> Map(const Grid<From>& from, Function function) {
  Grid<To> to(from.width(), from.height());
  std::transform(from.values().begin(), from.values().end(), to.values().begin(), function);
  return to;
}

}  // namespace

DepthCode::DepthCode(double z_near, double z_far)
    : z_near_(z_near), z_far_(z_far), inverse_far_(1.0 / z_far), inverse_span_(1.0 / z_near - 1.0 / z_far) {}

Result<DepthCode> DepthCode::Create(double z_near, double z_far) {
  const DepthCode code(z_near, z_far);
  if (!(z_near > 0) || !(z_far > z_near) || !std::isfinite(z_far) || !(code.inverse_span_ > 0) ||
      !std::isfinite(code.inverse_span_)) {
    std::ostringstream text;
    text << "depth range is " << z_near << " to " << z_far << ", expected 0 < zNear < zFar, both finite";
    return InvalidArgument(text.str());
  }
  return code;
}

std::uint16_t DepthCode::FromInverseDepth(double inverse_depth) const {
  if (!(inverse_depth > 0) || !std::isfinite(inverse_depth)) return 0;
  const double position = (inverse_depth - inverse_far_) / inverse_span_;
  return static_cast<std::uint16_t>(1 + std::floor(kSteps * std::clamp(position, 0.0, 1.0) + 0.5));
}

double DepthCode::ToInverseDepth(std::uint16_t code) const {
  if (code == 0) return 0;
  return inverse_far_ + inverse_span_ * ((code - 1) / kSteps);
}

Grid<std::uint16_t> EncodeDepth(const DepthMap& depth, const DepthCode& code) {
  return Map<std::uint16_t>(depth, [&](float z) { return z > 0 ? code.FromInverseDepth(1.0 / z) : std::uint16_t{0}; });
}

DepthMap DecodeDepth(const Grid<std::uint16_t>& codes, const DepthCode& code) {
  return Map<float>(codes, [&](std::uint16_t value) {
    return value == 0 ? 0.0F : static_cast<float>(1.0 / code.ToInverseDepth(value));
  });
}

Grid<std::uint16_t> EncodeInverseDepth(const Grid<float>& inverse_depth, const DepthCode& code) {
  return Map<std::uint16_t>(inverse_depth, [&](float value) { return code.FromInverseDepth(value); });
}

}  // namespace depthfarm
