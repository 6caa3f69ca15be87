#include "common/calibration/ftv.h"

#include "common/calibration/camera_block.h"
#include "common/calibration/camera_collector.h"

namespace depthfarm {
namespace {

void SetPose(const TokenReader::Matrix34& pose, const FtvConvention& convention, Camera& camera) {
  Eigen::Matrix3d& r = camera.cam_from_world_rotation;
  Eigen::Vector3d& t = camera.cam_from_world_translation;
  r = pose.left;
  switch (convention.pose) {
    case FtvConvention::Pose::kCentre:
      t = -OrderedProduct(r, pose.right);
      break;
    case FtvConvention::Pose::kCameraToWorld:
      r.transposeInPlace();
      t = -OrderedProduct(r, pose.right);
      break;
    case FtvConvention::Pose::kWorldToCamera:
      t = pose.right;
      break;
  }
  if (convention.scene_behind) t = -t;  // -(R X + t) = R (-X) - t
}

}  // namespace

Result<Calibration> ParseFtvCameras(std::string_view text, const std::string& file, const PictureSize& size,
                                    const FtvConvention& convention) {
  DEPTHFARM_ASSIGN_OR_RETURN(TokenReader reader, TokenReader::Of(text, file));
  CameraCollector cameras(file);
  for (reader.SkipComments(); !reader.AtEnd(); reader.SkipComments()) {
    const std::string position = reader.Position();
    DEPTHFARM_ASSIGN_OR_RETURN(const std::string_view name, reader.Word("the name of a camera"));
    if (double number = 0; ParseFinite(name, &number)) {
      return reader.Bad(Quoted(name) +
                        " stands where the name of a camera is expected: a camera is a name, 9 numbers "
                        "of K, 2 of distortion and 12 of [R | T] (numbered cameras are format msr)");
    }
    CalibratedCamera camera;
    camera.camera.name = name;
    camera.camera.width = size.width;
    camera.camera.height = size.height;
    DEPTHFARM_ASSIGN_OR_RETURN(const CameraBlock block, ReadCameraBlock(reader, camera.camera.name));
    camera.camera.intrinsics = block.intrinsics;
    SetPose(block.pose, convention, camera.camera);
    DEPTHFARM_RETURN_IF_ERROR(cameras.Add(std::move(camera), position));
  }
  Calibration calibration;
  DEPTHFARM_ASSIGN_OR_RETURN(calibration.cameras, cameras.Take());
  return calibration;
}

}  // namespace depthfarm
