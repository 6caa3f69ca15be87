#include "common/media/ground_truth.h"

#include <cmath>
#include <string>

#include "common/media/grey_picture.h"
#include "common/media/pfm.h"

namespace depthfarm {
namespace {

template <typename T>
Status CheckSize(const std::string& path, const Grid<T>& grid, int width, int height) {
  if (grid.width() == width && grid.height() == height) return {};
  return InvalidArgument(path + ": has " + std::to_string(grid.width()) + "x" + std::to_string(grid.height()) +
                         " pixels, expected " + std::to_string(width) + "x" + std::to_string(height) +
                         ", the camera's size");
}

// A z as a depth map holds it.
float KnownDepth(double z) { return std::isfinite(z) && z > 0 ? static_cast<float>(z) : 0.0F; }

Result<DepthMap> ReadDepth(const GroundTruthView& view, const std::string& path, int width, int height) {
  DepthMap depth(width, height);
  if (view.encoding == GroundTruthView::Encoding::kDisparityPng) {
    DEPTHFARM_ASSIGN_OR_RETURN(const GreyPicture grey, ReadGrey(path));
    DEPTHFARM_RETURN_IF_ERROR(CheckSize(path, grey.values, width, height));
    for (std::size_t i = 0; i < depth.size(); ++i) {
      const double value = grey.values.values()[i];
      if (value > 0) depth.values()[i] = KnownDepth(view.scale / (value / view.divisor + view.offset));
    }
    return depth;
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const Grid<float> values, ReadPfm(path));
  DEPTHFARM_RETURN_IF_ERROR(CheckSize(path, values, width, height));
  const bool disparity = view.encoding == GroundTruthView::Encoding::kDisparityPfm;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const double value = values.values()[i];
    if (!std::isfinite(value)) continue;  // scale / infinity would be a depth of 0 by luck only
    depth.values()[i] = KnownDepth(disparity ? view.scale / (value + view.offset) : value);
  }
  return depth;
}

Result<Grid<std::uint8_t>> ReadBytes(const std::string& path, int width, int height) {
  DEPTHFARM_ASSIGN_OR_RETURN(const GreyPicture grey, ReadGrey(path));
  DEPTHFARM_RETURN_IF_ERROR(CheckSize(path, grey.values, width, height));
  if (grey.bits != 8) return InvalidArgument(path + ": has 16 bits per sample, expected 8");
  Grid<std::uint8_t> result(width, height);
  for (std::size_t i = 0; i < result.size(); ++i) {
    result.values()[i] = static_cast<std::uint8_t>(grey.values.values()[i]);
  }
  return result;
}

}  // namespace

Result<GroundTruthFrame> ReadGroundTruth(const GroundTruthView& view, int frame, int width, int height) {
  const auto position = static_cast<std::size_t>(frame);
  if (frame < 0 || position >= view.depth.size()) {
    return InvalidArgument("ground truth of view '" + view.view + "' has " + std::to_string(view.depth.size()) +
                           " frames, there is no frame " + std::to_string(frame));
  }
  GroundTruthFrame result;
  DEPTHFARM_ASSIGN_OR_RETURN(result.depth, ReadDepth(view, view.depth[position], width, height));
  if (position < view.zones.size()) {
    DEPTHFARM_ASSIGN_OR_RETURN(result.zones, ReadBytes(view.zones[position], width, height));
  }
  if (!view.nonoccluded_mask.empty()) {
    DEPTHFARM_ASSIGN_OR_RETURN(result.nonoccluded, ReadBytes(view.nonoccluded_mask, width, height));
    for (std::uint8_t& value : result.nonoccluded.values()) value = value == 255 ? 1 : 0;
  }
  return result;
}

}  // namespace depthfarm
