#include "common/calibration/byte_reader.h"
#include "common/calibration/colmap_parts.h"

namespace depthfarm {
namespace {

// Fewest bytes of an entry.
constexpr std::size_t kCameraBytes = 4 + 4 + 8 + 8 + 3 * 8;
constexpr std::size_t kImageBytes = 4 + 7 * 8 + 4 + 1 + 8;
constexpr std::size_t kSeenBytes = 8 + 8 + 8;
constexpr std::size_t kPointBytes = 8 + 3 * 8 + 3 + 8 + 8;
constexpr std::size_t kTrackBytes = 4 + 4;

}  // namespace

Result<ColmapCameras> ParseColmapCamerasBinary(const ColmapFile& file) {
  ByteReader reader(file.content, file.name);
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t count, reader.Count("cameras", kCameraBytes));
  ColmapCameras cameras;
  for (std::uint64_t i = 0; i < count; ++i) {
    DEPTHFARM_ASSIGN_OR_RETURN(const std::uint32_t id, reader.U32("the id of a camera"));
    const std::string name = "camera " + std::to_string(id);
    ColmapCamera camera;
    DEPTHFARM_ASSIGN_OR_RETURN(const std::uint32_t lens, reader.U32(name));
    camera.lens = ColmapLensOf(lens);
    if (camera.lens == nullptr) {
      return reader.Bad(name + " has the model number " + std::to_string(lens) +
                        ", which is not supported: run 'colmap image_undistorter' and import what it writes");
    }
    DEPTHFARM_ASSIGN_OR_RETURN(camera.width, reader.U64(name));
    DEPTHFARM_ASSIGN_OR_RETURN(camera.height, reader.U64(name));
    for (std::size_t p = 0; p < camera.lens->num_params; ++p) {
      DEPTHFARM_ASSIGN_OR_RETURN(const double number, reader.Float64(name));
      camera.params.push_back(number);
    }
    if (!cameras.emplace(id, std::move(camera)).second) return reader.Bad(name + " is there twice");
  }
  DEPTHFARM_RETURN_IF_ERROR(reader.ExpectEnd());
  return cameras;
}

Result<std::vector<ColmapImage>> ParseColmapImagesBinary(const ColmapFile& file) {
  ByteReader reader(file.content, file.name);
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t count, reader.Count("images", kImageBytes));
  std::vector<ColmapImage> images;
  for (std::uint64_t i = 0; i < count; ++i) {
    ColmapImage image;
    image.position = reader.Position();
    DEPTHFARM_ASSIGN_OR_RETURN(image.id, reader.U32("the id of an image"));
    const std::string name = "image " + std::to_string(image.id);
    for (double& number : image.rotation) {
      DEPTHFARM_ASSIGN_OR_RETURN(number, reader.Float64(name));
    }
    DEPTHFARM_ASSIGN_OR_RETURN(image.translation, reader.Vector3(name));
    DEPTHFARM_ASSIGN_OR_RETURN(image.camera, reader.U32(name));
    DEPTHFARM_ASSIGN_OR_RETURN(image.name, reader.ZeroTerminated("the name of " + name));
    DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t seen, reader.Count("points seen in " + name, kSeenBytes));
    DEPTHFARM_RETURN_IF_ERROR(reader.Skip(seen * kSeenBytes, name));
    images.push_back(std::move(image));
  }
  DEPTHFARM_RETURN_IF_ERROR(reader.ExpectEnd());
  return images;
}

Status ParseColmapPointsBinary(const ColmapFile& file, const ColmapPointSink& sink) {
  ByteReader reader(file.content, file.name);
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t count, reader.Count("points", kPointBytes));
  const std::string what = "a point";
  std::vector<std::uint32_t> images;
  for (std::uint64_t i = 0; i < count; ++i) {
    DEPTHFARM_RETURN_IF_ERROR(reader.U64(what).status());
    DEPTHFARM_ASSIGN_OR_RETURN(const Eigen::Vector3d point, reader.Vector3(what));
    DEPTHFARM_RETURN_IF_ERROR(reader.Skip(3 + 8, what));  // colour and error
    DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t length, reader.Count("images that see a point", kTrackBytes));
    images.clear();
    for (std::uint64_t k = 0; k < length; ++k) {
      DEPTHFARM_ASSIGN_OR_RETURN(const std::uint32_t image, reader.U32(what));
      DEPTHFARM_RETURN_IF_ERROR(reader.Skip(4, what));
      images.push_back(image);
    }
    sink(point, images);
  }
  return reader.ExpectEnd();
}

}  // namespace depthfarm
