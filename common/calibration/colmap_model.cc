#include "common/calibration/colmap_model.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "common/calibration/camera_collector.h"
#include "common/calibration/colmap_parts.h"
#include "common/calibration/picture_name.h"
#include "common/calibration/token_reader.h"

namespace depthfarm {
namespace {

constexpr double kLengthTolerance = 0.01;  // of a rotation's quaternion, which programs write with few digits
constexpr double kMostDepth = 1e30;        // fits a float

// False: the quaternion w, x, y, z is no rotation.
bool RotationOf(const std::array<double, 4>& quaternion, Eigen::Matrix3d& rotation) {
  double square = 0;
  for (const double number : quaternion) square += number * number;
  const double length = std::sqrt(square);
  if (!(std::abs(length - 1) <= kLengthTolerance)) return false;
  const double w = quaternion[0] / length;
  const double x = quaternion[1] / length;
  const double y = quaternion[2] / length;
  const double z = quaternion[3] / length;
  rotation << 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),  //
      2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),          //
      2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y);
  return true;
}

Result<CalibratedCamera> CameraOf(const ColmapImage& image, const ColmapCameras& cameras, const ColmapFiles& files) {
  const std::string where = files.images.name + ": " + image.position + ": image " + Quoted(image.name);
  const auto lens = cameras.find(image.camera);
  if (lens == cameras.end()) {
    return InvalidArgument(where + " is of camera " + std::to_string(image.camera) + ", which is not in " +
                           files.cameras.name + ": are the files of one model?");
  }
  Result<Camera> camera = CameraOf(lens->second);
  if (!camera.ok()) {
    return InvalidArgument(files.cameras.name + ": camera " + std::to_string(image.camera) + " (of image " +
                           Quoted(image.name) + ") " + camera.status().message());
  }
  CalibratedCamera result{.camera = *std::move(camera), .picture = image.name, .z_near = {}, .z_far = {}};
  if (!RotationOf(image.rotation, result.camera.cam_from_world_rotation)) {
    return InvalidArgument(where + " has a rotation that is none: expected a quaternion of length 1");
  }
  result.camera.cam_from_world_translation = image.translation;
  return result;
}

Result<std::vector<ColmapImage>> ImagesByName(const ColmapFiles& files) {
  DEPTHFARM_ASSIGN_OR_RETURN(std::vector<ColmapImage> images, files.binary ? ParseColmapImagesBinary(files.images)
                                                                           : ParseColmapImagesText(files.images));
  std::ranges::stable_sort(images, {}, &ColmapImage::name);
  return images;
}

Result<std::vector<CalibratedCamera>> Cameras(const std::vector<ColmapImage>& images, const ColmapFiles& files) {
  DEPTHFARM_ASSIGN_OR_RETURN(const ColmapCameras cameras, files.binary ? ParseColmapCamerasBinary(files.cameras)
                                                                       : ParseColmapCamerasText(files.cameras));
  std::map<std::string, int> uses;
  for (const ColmapImage& image : images) ++uses[NameOfPicture(image.name)];
  CameraCollector collector(files.images.name);
  for (const ColmapImage& image : images) {
    DEPTHFARM_ASSIGN_OR_RETURN(CalibratedCamera camera, CameraOf(image, cameras, files));
    const std::string name = NameOfPicture(image.name);
    camera.camera.name = uses.at(name) == 1 ? name : NameOfPicture(image.name, KeepEnding::kYes);
    DEPTHFARM_RETURN_IF_ERROR(collector.Add(std::move(camera), image.position));
  }
  return collector.Take();
}

}  // namespace

Result<ColmapModel> ParseColmapModel(const ColmapFiles& files) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::vector<ColmapImage> images, ImagesByName(files));
  ColmapModel model;
  DEPTHFARM_ASSIGN_OR_RETURN(model.calibration.cameras, Cameras(images, files));
  std::map<std::uint32_t, std::size_t> index_of_image;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (!index_of_image.emplace(images[i].id, i).second) {
      return InvalidArgument(files.images.name + ": " + images[i].position + ": image " + std::to_string(images[i].id) +
                             " is there twice");
    }
  }
  model.depths.resize(images.size());
  if (!files.points) return model;
  const auto note = [&](const Eigen::Vector3d& point, std::span<const std::uint32_t> seen_by) {
    for (const std::uint32_t id : seen_by) {
      const auto image = index_of_image.find(id);
      if (image == index_of_image.end()) continue;  // one that is not registered
      const Camera& camera = model.calibration.cameras[image->second].camera;
      const double depth = OrderedDot(OpticalAxisInWorld(camera), point) + camera.cam_from_world_translation[2];
      if (std::abs(depth) < kMostDepth) model.depths[image->second].push_back(static_cast<float>(depth));
    }
  };
  DEPTHFARM_RETURN_IF_ERROR(files.binary ? ParseColmapPointsBinary(*files.points, note)
                                         : ParseColmapPointsText(*files.points, note));
  return model;
}

}  // namespace depthfarm
