#include <limits>

#include "common/calibration/colmap_parts.h"
#include "common/calibration/token_reader.h"

namespace depthfarm {
namespace {

constexpr std::uint64_t kMaxId = std::numeric_limits<std::uint32_t>::max();
constexpr std::uint64_t kMaxWhole = std::numeric_limits<std::uint64_t>::max();

Result<std::uint32_t> Id(TokenReader& reader, const std::string& what) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::uint64_t id, reader.Whole(what, kMaxId));
  return static_cast<std::uint32_t>(id);
}

Status BadCamera(const TokenReader& reader, std::uint32_t id, const std::string& position, const std::string& what) {
  return InvalidArgument(reader.file() + ": " + position + ": camera " + std::to_string(id) + " " + what);
}

// What follows the id of a camera, to the end of the line.
Result<ColmapCamera> ReadCamera(TokenReader& reader, std::uint32_t id, const std::string& position) {
  const std::string of = " of camera " + std::to_string(id);
  ColmapCamera camera;
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string_view lens, reader.Word("the model" + of));
  camera.lens = ColmapLensOf(lens);
  if (camera.lens == nullptr) {
    return BadCamera(reader, id, position,
                     "has the model " + Quoted(lens) +
                         ", which is not supported: run 'colmap image_undistorter' and import what it writes");
  }
  DEPTHFARM_ASSIGN_OR_RETURN(camera.width, reader.Whole("the width" + of, kMaxWhole));
  DEPTHFARM_ASSIGN_OR_RETURN(camera.height, reader.Whole("the height" + of, kMaxWhole));
  while (reader.LineGoesOn()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const double number, reader.Number("a parameter" + of));
    camera.params.push_back(number);
  }
  if (camera.params.size() == camera.lens->num_params) return camera;
  return BadCamera(reader, id, position,
                   "has " + std::to_string(camera.params.size()) + " parameters, expected the " +
                       std::to_string(camera.lens->num_params) + " of " + std::string(camera.lens->name));
}

}  // namespace

Result<ColmapCameras> ParseColmapCamerasText(const ColmapFile& file) {
  DEPTHFARM_ASSIGN_OR_RETURN(TokenReader reader, TokenReader::Of(file.content, file.name));
  ColmapCameras cameras;
  for (reader.SkipComments(); !reader.AtEnd(); reader.SkipComments()) {
    const std::string position = reader.Position();
    DEPTHFARM_ASSIGN_OR_RETURN(const std::uint32_t id, Id(reader, "the id of a camera"));
    DEPTHFARM_ASSIGN_OR_RETURN(ColmapCamera camera, ReadCamera(reader, id, position));
    if (!cameras.emplace(id, std::move(camera)).second) return BadCamera(reader, id, position, "is there twice");
  }
  return cameras;
}

Result<std::vector<ColmapImage>> ParseColmapImagesText(const ColmapFile& file) {
  DEPTHFARM_ASSIGN_OR_RETURN(TokenReader reader, TokenReader::Of(file.content, file.name));
  std::vector<ColmapImage> images;
  for (reader.SkipComments(); !reader.AtEnd(); reader.SkipComments()) {
    ColmapImage image;
    image.position = reader.Position();
    DEPTHFARM_ASSIGN_OR_RETURN(image.id, Id(reader, "the id of an image"));
    const std::string of = " of image " + std::to_string(image.id);
    for (double& number : image.rotation) {
      DEPTHFARM_ASSIGN_OR_RETURN(number, reader.Number("one of the 4 numbers of the rotation" + of));
    }
    DEPTHFARM_ASSIGN_OR_RETURN(image.translation, reader.Vector3("one of the 3 numbers of the translation" + of));
    DEPTHFARM_ASSIGN_OR_RETURN(image.camera, Id(reader, "the camera" + of));
    image.name = reader.RestOfLine();
    // The next line lists what was seen in the image, and may be empty.
    reader.NextLine();
    (void)reader.RestOfLine();
    images.push_back(std::move(image));
  }
  return images;
}

Status ParseColmapPointsText(const ColmapFile& file, const ColmapPointSink& sink) {
  DEPTHFARM_ASSIGN_OR_RETURN(TokenReader reader, TokenReader::Of(file.content, file.name));
  std::vector<std::uint32_t> images;
  for (reader.SkipComments(); !reader.AtEnd(); reader.SkipComments()) {
    DEPTHFARM_RETURN_IF_ERROR(reader.Whole("the id of a point", kMaxWhole).status());
    DEPTHFARM_ASSIGN_OR_RETURN(const Eigen::Vector3d point, reader.Vector3("one of the 3 coordinates of a point"));
    for (int i = 0; i < 3; ++i) DEPTHFARM_RETURN_IF_ERROR(reader.Word("the colour of a point").status());
    DEPTHFARM_RETURN_IF_ERROR(reader.Word("the error of a point").status());
    images.clear();
    while (reader.LineGoesOn()) {
      DEPTHFARM_ASSIGN_OR_RETURN(const std::uint32_t image, Id(reader, "an image that sees the point"));
      DEPTHFARM_RETURN_IF_ERROR(Id(reader, "where an image sees the point").status());
      images.push_back(image);
    }
    sink(point, images);
  }
  return {};
}

}  // namespace depthfarm
