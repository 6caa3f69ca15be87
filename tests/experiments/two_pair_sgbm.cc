#include "tests/experiments/two_pair_sgbm.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

#include "tests/experiments/rectified_pair.h"

namespace depthfarm {
namespace {

constexpr int kBlock = 5;
constexpr int kMostDisparities = 512;  // the matcher's memory grows with them
constexpr double kAgreement = 0.02;    // of the inverse depth
constexpr float kSameSurface = 0.5;    // pixels of disparity

// 1/z; 0 = not known.
using InverseDepths = Grid<float>;

cv::Mat Warped(const YcbcrImage& picture, const Eigen::Matrix3d& homography, int width, int height) {
  cv::Mat source(picture.height(), picture.width(), CV_8UC3);
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) {
      const Ycbcr& p = picture(x, y);
      source.at<cv::Vec3b>(y, x) = {p.y, p.cb, p.cr};
    }
  }
  cv::Matx33d h;
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) h(row, col) = homography(row, col);
  cv::Mat warped;
  cv::warpPerspective(source, warped, h, cv::Size(width, height), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return warped;
}

// Disparity at a place between pixels: bilinear on one surface, else the nearest pixel's; < 1 = not known.
float DisparityAt(const cv::Mat& disparity, double x, double y) {
  // Where rows are parallel, the last one lies on the border but for rounding.
  x = std::clamp(x, 0.0, disparity.cols - 1.0);
  y = std::clamp(y, 0.0, disparity.rows - 1.0);
  const int x0 = std::min(static_cast<int>(x), disparity.cols - 2);
  const int y0 = std::min(static_cast<int>(y), disparity.rows - 2);
  const auto at = [&](int dx, int dy) {
    return static_cast<float>(disparity.at<short>(y0 + dy, x0 + dx)) / float{cv::StereoMatcher::DISP_SCALE};
  };
  const auto [low, high] = std::minmax({at(0, 0), at(1, 0), at(0, 1), at(1, 1)});
  const double fx = x - x0;
  const double fy = y - y0;
  if (low < 1 || high - low > kSameSurface) return at(fx >= 0.5 ? 1 : 0, fy >= 0.5 ? 1 : 0);
  return static_cast<float>((1 - fy) * ((1 - fx) * at(0, 0) + fx * at(1, 0)) +
                            fy * ((1 - fx) * at(0, 1) + fx * at(1, 1)));
}

Result<InverseDepths> OfPair(const StereoView& view, const StereoView& neighbour, const DepthRange& range) {
  DEPTHFARM_ASSIGN_OR_RETURN(const RectifiedPair pair, Rectify(view.camera, neighbour.camera, range, kMostDisparities));
  const cv::Mat first = Warped(*view.picture, pair.first, pair.width, pair.height);
  const cv::Mat second = Warped(*neighbour.picture, pair.second, pair.width, pair.height);
  const auto sgbm = cv::StereoSGBM::create(1, pair.disparities, kBlock, 8 * 3 * kBlock * kBlock,
                                           32 * 3 * kBlock * kBlock, 1, 0, 5, 100, 2, cv::StereoSGBM::MODE_HH);
  cv::Mat disparity;
  sgbm->compute(first, second, disparity);
  InverseDepths result(view.camera.width, view.camera.height);
  for (int y = 0; y < result.height(); ++y) {
    for (int x = 0; x < result.width(); ++x) {
      const Eigen::Vector3d pixel(x, y, 1);
      const Eigen::Vector3d rectified = pair.first * pixel;
      const float d = DisparityAt(disparity, rectified.x() / rectified.z(), rectified.y() / rectified.z());
      const double inverse = (d - pair.offset) * pair.scale * pair.ray_z.dot(pixel);
      if (d >= 1 && inverse > 0) result(x, y) = static_cast<float>(inverse);
    }
  }
  return result;
}

float Merged(float a, float b) {
  if (a <= 0 || b <= 0) return std::max(a, b);
  return std::abs(a - b) <= kAgreement * std::max(a, b) ? 0.5F * (a + b) : std::min(a, b);
}

void FillRow(float* row, int width) {
  std::vector<float> right(static_cast<std::size_t>(width));
  float last = 0;
  for (int x = width - 1; x >= 0; --x) {
    if (row[x] > 0) last = row[x];
    right[static_cast<std::size_t>(x)] = last;
  }
  last = 0;
  for (int x = 0; x < width; ++x) {
    if (row[x] > 0) {
      last = row[x];
    } else {
      const float other = right[static_cast<std::size_t>(x)];
      row[x] = last > 0 && other > 0 ? std::min(last, other) : std::max(last, other);
    }
  }
}

// Rows in which no pixel is known have the depths of the nearest that is not empty, the upper one of two.
void FillEmptyRows(InverseDepths& map) {
  std::vector<int> known;
  for (int y = 0; y < map.height(); ++y)
    if (map(0, y) > 0) known.push_back(y);  // FillRow fills all of a row or nothing
  if (known.empty()) return;
  for (int y = 0; y < map.height(); ++y) {
    if (map(0, y) > 0) continue;
    const auto nearer = [y](int a, int b) { return std::abs(a - y) < std::abs(b - y); };
    const int from = *std::min_element(known.begin(), known.end(), nearer);
    std::copy_n(map.row(from), map.width(), map.row(y));
  }
}

}  // namespace

Result<DepthMap> EstimateBySgbm(const StereoView& view, const std::vector<StereoView>& neighbours,
                                const DepthRange& range) {
  InverseDepths merged(view.camera.width, view.camera.height);
  Status failed = InvalidArgument("camera '" + view.camera.name + "' has no neighbour");
  bool any = false;
  for (const StereoView& neighbour : neighbours) {
    const Result<InverseDepths> pair = OfPair(view, neighbour, range);
    if (!pair.ok()) {
      failed = pair.status();
      continue;  // the other neighbour may do
    }
    any = true;
    for (std::size_t i = 0; i < merged.size(); ++i) merged.values()[i] = Merged(merged.values()[i], pair->values()[i]);
  }
  if (!any) return failed;
  for (int y = 0; y < merged.height(); ++y) FillRow(merged.row(y), merged.width());
  FillEmptyRows(merged);
  DepthMap depth(merged.width(), merged.height());
  for (std::size_t i = 0; i < merged.size(); ++i) {
    const float inverse = merged.values()[i];
    depth.values()[i] = inverse > 0 ? 1 / inverse : 0;
  }
  return depth;
}

}  // namespace depthfarm
