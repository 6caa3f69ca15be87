#include "common/media/depth_file.h"

#include <filesystem>

#include "common/files/atomic_file.h"
#include "common/media/grey_picture.h"

namespace depthfarm {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{4} << 30;  // 32768 x 32768 codes and PNG's overhead

}  // namespace

Result<std::string> EncodeDepthPng(const Grid<std::uint16_t>& codes) { return EncodeGreyPng(codes); }

Result<std::string> EncodeInverseDepthPng(const Grid<float>& inverse_depth, const DepthCode& code) {
  return EncodeDepthPng(EncodeInverseDepth(inverse_depth, code));
}

Result<std::string> EncodeDepthPng(const DepthMap& depth, const DepthCode& code) {
  return EncodeDepthPng(EncodeDepth(depth, code));
}

Result<Grid<std::uint16_t>> DecodeDepthPng(std::string_view bytes) {
  DEPTHFARM_ASSIGN_OR_RETURN(GreyPicture grey, DecodeGrey(bytes));
  if (grey.bits != 16) return InvalidArgument("has 8 bits per sample, expected a 16-bit depth map");
  return std::move(grey.values);
}

Result<Grid<std::uint16_t>> ReadCodesFile(const std::string& path, int width, int height) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, ReadFileBytes(path, kMaxFileBytes));
  auto codes = DecodeDepthPng(bytes);
  if (!codes.ok()) return codes.status().WithContext(path);
  if (codes->width() != width || codes->height() != height) {
    return InvalidArgument(path + ": has " + std::to_string(codes->width()) + "x" + std::to_string(codes->height()) +
                           " pixels, expected " + std::to_string(width) + "x" + std::to_string(height));
  }
  return codes;
}

Result<DepthMap> ReadDepthFile(const std::string& path, int width, int height, const DepthCode& code) {
  DEPTHFARM_ASSIGN_OR_RETURN(const Grid<std::uint16_t> codes, ReadCodesFile(path, width, height));
  return DecodeDepth(codes, code);
}

Result<DepthMap> ReadDepthOf(const std::string& directory, const DepthManifestCamera& camera, std::size_t position) {
  if (position >= camera.files.size()) {
    return InvalidArgument(directory + ": camera '" + camera.camera.name + "' has " +
                           std::to_string(camera.files.size()) + " depth maps, there is none at position " +
                           std::to_string(position));
  }
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthCode code, DepthCode::Create(camera.z_near, camera.z_far));
  return ReadDepthFile((std::filesystem::path(directory) / camera.files[position].path).string(), camera.camera.width,
                       camera.camera.height, code);
}

}  // namespace depthfarm
