#include "common/calibration/camera_block.h"

namespace depthfarm {

Result<CameraBlock> ReadCameraBlock(TokenReader& reader, const std::string& camera) {
  const std::string of = " of camera " + Quoted(camera);
  CameraBlock block;
  DEPTHFARM_ASSIGN_OR_RETURN(block.intrinsics, reader.Matrix3("one of the 9 numbers of K" + of));
  for (int i = 0; i < 2; ++i) {
    DEPTHFARM_ASSIGN_OR_RETURN(const double distortion, reader.Number("one of the 2 numbers of lens distortion" + of));
    if (distortion != 0) {
      return reader.Bad("camera " + Quoted(camera) +
                        " has lens distortion: remove it from its pictures, then give it zeros here");
    }
  }
  DEPTHFARM_ASSIGN_OR_RETURN(block.pose, reader.Matrix3x4("one of the 12 numbers of the pose" + of));
  return block;
}

}  // namespace depthfarm
