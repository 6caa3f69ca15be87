#include "common/calibration/msr.h"

#include "common/calibration/camera_block.h"
#include "common/calibration/camera_collector.h"

namespace depthfarm {
namespace {

constexpr std::uint64_t kMaxNumber = 1'000'000;

}  // namespace

Result<Calibration> ParseMsrCameras(std::string_view text, const std::string& file, const PictureSize& size) {
  DEPTHFARM_ASSIGN_OR_RETURN(TokenReader reader, TokenReader::Of(text, file));
  CameraCollector cameras(file);
  while (!reader.AtEnd()) {
    const std::string position = reader.Position();
    DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t number, reader.Whole("the number of a camera", kMaxNumber));
    CalibratedCamera result;
    Camera& camera = result.camera;
    camera.name = "cam" + std::to_string(number);
    camera.width = size.width;
    camera.height = size.height;
    DEPTHFARM_ASSIGN_OR_RETURN(const CameraBlock block, ReadCameraBlock(reader, camera.name));
    Eigen::Matrix3d& k = camera.intrinsics;
    k = block.intrinsics;
    k(0, 1) = -k(0, 1);
    k(1, 2) = size.height - 1 - k(1, 2);
    Eigen::Matrix3d& r = camera.cam_from_world_rotation;
    r = block.pose.left;
    r.row(1) = -r.row(1);
    r.col(1) = -r.col(1);
    camera.cam_from_world_translation = block.pose.right;
    camera.cam_from_world_translation[1] = -block.pose.right[1];
    DEPTHFARM_RETURN_IF_ERROR(cameras.Add(std::move(result), position));
  }
  Calibration calibration;
  DEPTHFARM_ASSIGN_OR_RETURN(calibration.cameras, cameras.Take());
  return calibration;
}

}  // namespace depthfarm
