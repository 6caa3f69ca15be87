#include "worker/media_cli/colour_command.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "common/files/atomic_file.h"
#include "common/files/writable_folder.h"
#include "common/media/colour_map.h"
#include "common/media/depth_file.h"
#include "common/sequence/depth_manifest.h"

namespace depthfarm {
namespace {

constexpr int kSheetColumns = 4;
constexpr int kSheetGap = 8;             // pixels
constexpr int kSheetPictureWidth = 640;  // larger pictures are shrunk to at most this

// The colours of a folder span what its maps hold, not what its cameras could: a camera that stands close to the depth
// planes has an own range of which the scene fills a sliver. Of every camera's first map, without its extreme 0.5 %.
Result<DepthCode> SharedRange(const std::string& depth_dir, const DepthManifest& manifest) {
  constexpr std::size_t kStep = 7;  // every 7th pixel is sample enough
  std::vector<float> depths;
  for (const DepthManifestCamera& camera : manifest.cameras) {
    DEPTHFARM_ASSIGN_OR_RETURN(const DepthMap depth, ReadDepthOf(depth_dir, camera, 0));
    for (std::size_t i = 0; i < depth.size(); i += kStep) {
      if (depth.values()[i] > 0) depths.push_back(depth.values()[i]);
    }
  }
  if (depths.empty()) return InvalidArgument(depth_dir + ": the first depth maps hold no depth");
  std::sort(depths.begin(), depths.end());
  const std::size_t tail = depths.size() / 200;
  const double z_near = static_cast<double>(depths[tail]);
  const double z_far = static_cast<double>(depths[depths.size() - 1 - tail]);
  return DepthCode::Create(z_near, std::max(z_far, 1.1 * z_near));
}

Status WritePng(const std::filesystem::path& path, const RgbImage& picture) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string png, EncodeRgbPng(picture));
  return WriteFileAtomically(path.string(), png);
}

// Before anything is written.
Status CheckFilesAreThere(const std::filesystem::path& depth_dir, const DepthManifest& manifest) {
  for (const DepthManifestCamera& camera : manifest.cameras) {
    for (const DepthManifestFile& file : camera.files) {
      std::error_code error;
      if (std::filesystem::is_regular_file(depth_dir / file.path, error)) continue;
      return InvalidArgument((depth_dir / file.path).string() + " of camera '" + camera.camera.name +
                             "' is missing: see depthfarm verify " + depth_dir.string());
    }
  }
  return {};
}

}  // namespace

Status RunColour(const ColourCommandOptions& options, std::ostream& out) {
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthManifest manifest, ReadDepthManifest(options.depth_dir));
  if (manifest.cameras.empty() || manifest.cameras.front().files.empty()) {
    return InvalidArgument(options.depth_dir + ": depth.json lists no depth maps");
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckWritableFolder(options.output));
  DEPTHFARM_RETURN_IF_ERROR(CheckFilesAreThere(options.depth_dir, manifest));
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthCode range, SharedRange(options.depth_dir, manifest));
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
