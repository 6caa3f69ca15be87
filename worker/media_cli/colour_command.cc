#include "worker/media_cli/colour_command.h"

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <vector>

#include "common/files/atomic_file.h"
#include "common/media/colour_map.h"
#include "common/media/depth_file.h"
#include "common/sequence/depth_manifest.h"

namespace depthfarm {
namespace {

constexpr int kSheetColumns = 4;
constexpr int kSheetGap = 8;             // pixels
constexpr int kSheetPictureWidth = 640;  // larger pictures are shrunk to at most this

Result<DepthCode> SharedRange(const DepthManifest& manifest) {
  double z_near = manifest.cameras.front().z_near;
  double z_far = manifest.cameras.front().z_far;
  for (const DepthManifestCamera& camera : manifest.cameras) {
    z_near = std::min(z_near, camera.z_near);
    z_far = std::max(z_far, camera.z_far);
  }
  return DepthCode::Create(z_near, z_far);
}

Status WritePng(const std::filesystem::path& path, const RgbImage& picture) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string png, EncodeRgbPng(picture));
  return WriteFileAtomically(path.string(), png);
}

}  // namespace

Status RunColour(const ColourCommandOptions& options, std::ostream& out) {
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthManifest manifest, ReadDepthManifest(options.depth_dir));
  if (manifest.cameras.empty() || manifest.cameras.front().files.empty()) {
    return InvalidArgument(options.depth_dir + ": depth.json lists no depth maps");
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthCode range, SharedRange(manifest));
  const std::filesystem::path output(options.output);
  std::vector<RgbImage> sheet;
  std::size_t written = 0;
  for (const DepthManifestCamera& camera : manifest.cameras) {
    DEPTHFARM_RETURN_IF_ERROR(MakeDirectories((output / camera.camera.name).string()));
    for (std::size_t i = 0; i < camera.files.size(); ++i) {
      DEPTHFARM_ASSIGN_OR_RETURN(const DepthMap depth, ReadDepthOf(options.depth_dir, camera, i));
      DEPTHFARM_ASSIGN_OR_RETURN(const RgbImage picture, ColourMapped(depth, range));
      const std::string name = std::filesystem::path(camera.files[i].path).stem().string() + ".png";
      DEPTHFARM_RETURN_IF_ERROR(WritePng(output / camera.camera.name / name, picture));
      ++written;
      if (i == 0) {
        const int factor = (picture.width() + kSheetPictureWidth - 1) / kSheetPictureWidth;
        sheet.push_back(factor > 1 ? Shrunk(picture, factor) : picture);
      }
    }
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const RgbImage contact, ContactSheet(sheet, kSheetColumns, kSheetGap));
  const std::filesystem::path contact_file = output / "contact.png";
  DEPTHFARM_RETURN_IF_ERROR(WritePng(contact_file, contact));
  out << "wrote " << written << " pictures and " << contact_file.string() << "\n";
  return {};
}

}  // namespace depthfarm
