#include "common/geometry/camera.h"

#include <cmath>
#include <sstream>

namespace depthfarm {
namespace {

constexpr int kMaxSide = 32768;
constexpr double kOrthonormalTolerance = 1e-3;

Status Bad(const Camera& camera, const std::string& what) {
  return InvalidArgument("camera '" + camera.name + "': " + what);
}

std::string Number(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

bool AllFinite(const Eigen::Matrix3d& m) {
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) {
      if (!std::isfinite(m(row, col))) return false;
    }
  }
  return true;
}

}  // namespace

Status ValidateCamera(const Camera& camera) {
  if (camera.width < 1 || camera.width > kMaxSide || camera.height < 1 || camera.height > kMaxSide) {
    return Bad(camera, "size is " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                           ", expected 1 to " + std::to_string(kMaxSide) + " pixels a side");
  }
  const Eigen::Matrix3d& k = camera.intrinsics;
  if (!AllFinite(k)) return Bad(camera, "K holds a value that is not a finite number");
  if (k(0, 0) <= 0 || k(1, 1) <= 0) {
    return Bad(camera, "focal lengths are " + Number(k(0, 0)) + " and " + Number(k(1, 1)) + ", expected > 0");
  }
  if (k(1, 0) != 0 || k(2, 0) != 0 || k(2, 1) != 0 || k(2, 2) != 1) {
    return Bad(camera, "K must be upper triangular with last row 0 0 1");
  }
  const Eigen::Matrix3d& r = camera.cam_from_world_rotation;
  if (!AllFinite(r)) return Bad(camera, "R holds a value that is not a finite number");
  const Eigen::Vector3d& t = camera.cam_from_world_translation;
  if (!std::isfinite(t[0]) || !std::isfinite(t[1]) || !std::isfinite(t[2])) {
    return Bad(camera, "t holds a value that is not a finite number");
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      const double dot = OrderedDot(r.row(i).transpose(), r.row(j).transpose());
      if (std::abs(dot - (i == j ? 1.0 : 0.0)) > kOrthonormalTolerance) {
        return Bad(camera, "R is not a rotation: rows " + std::to_string(i) + " and " + std::to_string(j) +
                               " have the product " + Number(dot) + ", expected " + (i == j ? "1" : "0"));
      }
    }
  }
  const Eigen::Vector3d cross(r(0, 1) * r(1, 2) - r(0, 2) * r(1, 1), r(0, 2) * r(1, 0) - r(0, 0) * r(1, 2),
                              r(0, 0) * r(1, 1) - r(0, 1) * r(1, 0));
  if (OrderedDot(cross, r.row(2).transpose()) < 0) {
    return Bad(camera, "R mirrors (determinant -1): the file may use another axis convention");
  }
  return {};
}

double OrderedDot(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Eigen::Vector3d OrderedProduct(const Eigen::Matrix3d& a, const Eigen::Vector3d& b) {
  Eigen::Vector3d result;
  for (int row = 0; row < 3; ++row) result[row] = a(row, 0) * b[0] + a(row, 1) * b[1] + a(row, 2) * b[2];
  return result;
}

Eigen::Matrix3d OrderedProduct(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  Eigen::Matrix3d result;
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) {
      result(row, col) = a(row, 0) * b(0, col) + a(row, 1) * b(1, col) + a(row, 2) * b(2, col);
    }
  }
  return result;
}

Eigen::Matrix3d InverseIntrinsics(const Eigen::Matrix3d& k) {
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Identity();
  inverse(0, 0) = 1.0 / k(0, 0);
  inverse(1, 1) = 1.0 / k(1, 1);
  inverse(0, 1) = -k(0, 1) / (k(0, 0) * k(1, 1));
  inverse(1, 2) = -k(1, 2) / k(1, 1);
  inverse(0, 2) = (k(0, 1) * k(1, 2) - k(0, 2) * k(1, 1)) / (k(0, 0) * k(1, 1));
  return inverse;
}

Eigen::Vector3d CenterInWorld(const Camera& camera) {
  const Eigen::Matrix3d transposed = camera.cam_from_world_rotation.transpose();
  return -OrderedProduct(transposed, camera.cam_from_world_translation);
}

Eigen::Vector3d OpticalAxisInWorld(const Camera& camera) { return camera.cam_from_world_rotation.row(2).transpose(); }

Camera Downscaled(const Camera& camera, int factor) {
  Camera result = camera;
  const double s = factor;
  result.width = camera.width / factor;
  result.height = camera.height / factor;
  Eigen::Matrix3d& k = result.intrinsics;
  k(0, 0) /= s;
  k(0, 1) /= s;
  k(1, 1) /= s;
  k(0, 2) = (k(0, 2) + 0.5) / s - 0.5;
  k(1, 2) = (k(1, 2) + 0.5) / s - 0.5;
  return result;
}

}  // namespace depthfarm
