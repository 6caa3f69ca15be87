#ifndef DEPTHFARM_COMMON_IMAGE_DEPTH_CODE_H_
#define DEPTHFARM_COMMON_IMAGE_DEPTH_CODE_H_

#include <cstdint>

#include "common/base/status.h"
#include "common/image/grid.h"
#include "common/image/picture.h"

namespace depthfarm {

// The 16-bit form of a depth map (design, Output), uniform in inverse depth over the camera's own range:
//
//   code = 1 + round(65534 (1/z - 1/zFar) / (1/zNear - 1/zFar)),   0 = no depth
//
// so 1 is zFar, 65535 is zNear and the error of 1/z is at most half a step of (1/zNear - 1/zFar) / 65534.
// Only + - * / and floor in a stated order: the same codes on every machine.
class DepthCode {
 public:
  // Errors (kInvalidArgument): not 0 < z_near < z_far finite.
  [[nodiscard]] static Result<DepthCode> Create(double z_near, double z_far);

  [[nodiscard]] double z_near() const { return z_near_; }
  [[nodiscard]] double z_far() const { return z_far_; }

  // 0 for an inverse depth that is not a number > 0 (a ray that meets no plane); one outside the range gets its nearer
  // end.
  [[nodiscard]] std::uint16_t FromInverseDepth(double inverse_depth) const;
  // 1/z; 0 for code 0.
  [[nodiscard]] double ToInverseDepth(std::uint16_t code) const;

 private:
  DepthCode(double z_near, double z_far);

  double z_near_;
  double z_far_;
  double inverse_far_;
  double inverse_span_;  // 1/zNear - 1/zFar
};

// Depth map (z, 0 = no depth) <-> codes, pixel by pixel.
[[nodiscard]] Grid<std::uint16_t> EncodeDepth(const DepthMap& depth, const DepthCode& code);
[[nodiscard]] DepthMap DecodeDepth(const Grid<std::uint16_t>& codes, const DepthCode& code);

// Codes of inverse depths (1/z; anything not > 0 = no depth), without the detour over z.
[[nodiscard]] Grid<std::uint16_t> EncodeInverseDepth(const Grid<float>& inverse_depth, const DepthCode& code);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_IMAGE_DEPTH_CODE_H_
