#include "common/calibration/middlebury.h"

#include "common/calibration/camera_collector.h"
#include "common/calibration/picture_name.h"
#include "common/calibration/token_reader.h"
#include "common/sequence/read_sequence.h"

namespace depthfarm {

Result<Calibration> ParseMiddleburyCameras(std::string_view text, const std::string& file, const PictureSize& size) {
  DEPTHFARM_ASSIGN_OR_RETURN(TokenReader reader, TokenReader::Of(text, file));
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t count, reader.Whole("the number of cameras", kMaxCameras));
  CameraCollector cameras(file);
  std::uint64_t found = 0;
  for (; !reader.AtEnd(); ++found) {
    const std::string position = reader.Position();
    DEPTHFARM_ASSIGN_OR_RETURN(const std::string_view picture, reader.Word("the name of a picture"));
    const std::string of = " of picture " + Quoted(picture);
    CalibratedCamera result;
    result.picture = picture;
    Camera& camera = result.camera;
    camera.name = NameOfPicture(picture);
    camera.width = size.width;
    camera.height = size.height;
    DEPTHFARM_ASSIGN_OR_RETURN(camera.intrinsics, reader.Matrix3("one of the 9 numbers of K" + of));
    DEPTHFARM_ASSIGN_OR_RETURN(camera.cam_from_world_rotation, reader.Matrix3("one of the 9 numbers of R" + of));
    DEPTHFARM_ASSIGN_OR_RETURN(camera.cam_from_world_translation, reader.Vector3("one of the 3 numbers of t" + of));
    if (reader.LineGoesOn()) return reader.Bad("goes on after the 21 numbers" + of);
    DEPTHFARM_RETURN_IF_ERROR(cameras.Add(std::move(result), position));
  }
  if (found != count) {
    return InvalidArgument(file + ": line 1 says " + std::to_string(count) + " cameras, " + std::to_string(found) +
                           " follow: is the file whole?");
  }
  Calibration calibration;
  DEPTHFARM_ASSIGN_OR_RETURN(calibration.cameras, cameras.Take());
  return calibration;
}

}  // namespace depthfarm
