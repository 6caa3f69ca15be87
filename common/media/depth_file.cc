#include "common/media/depth_file.h"

#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "common/files/atomic_file.h"
#include "common/media/exr.h"
#include "common/media/grey_picture.h"
#include "common/media/pfm.h"
#include "common/media/raw_picture.h"

namespace depthfarm {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{5} << 30;  // 32768 x 32768 floats and a header

bool IsMetric(DepthFormat format) { return format == DepthFormat::kPfm || format == DepthFormat::kExr; }

Result<DepthFormat> FormatOf(const std::string& path) {
  if (const std::optional<DepthFormat> format = DepthFormatOfFile(path)) return *format;
  return InvalidArgument(path + ": expected a depth map, .png, .pfm, .exr or .yuv");
}

template <typename T>
Result<Grid<T>> OfSize(Result<Grid<T>> map, const std::string& path, int width, int height) {
  if (!map.ok()) return map.status().WithContext(path);
  if (map->width() == width && map->height() == height) return map;
  return InvalidArgument(path + ": has " + std::to_string(map->width()) + "x" + std::to_string(map->height()) +
                         " pixels, expected " + std::to_string(width) + "x" + std::to_string(height));
}

// Of a format of codes.
Result<Grid<std::uint16_t>> ReadCodes(const std::string& path, DepthFormat format, int width, int height) {
  if (format == DepthFormat::kPng16) return ReadCodesFile(path, width, height);
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, ReadFileBytes(path, kMaxFileBytes));
  return OfSize(DecodeRawLuma(bytes, kRawCodes, width, height), path, width, height);
}

Result<DepthMap> ReadMetric(const std::string& path, DepthFormat format, int width, int height) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, ReadFileBytes(path, kMaxFileBytes));
  DEPTHFARM_ASSIGN_OR_RETURN(
      DepthMap depth, OfSize(format == DepthFormat::kPfm ? DecodePfm(bytes) : DecodeExr(bytes), path, width, height));
  for (float& z : depth.values()) {
    if (!(z > 0) || std::isinf(z)) z = 0;
  }
  return depth;
}

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

Result<std::string> EncodeDepthFile(const Grid<std::uint16_t>& codes, const DepthCode& code, DepthFormat format) {
  switch (format) {
    case DepthFormat::kPng16:
      break;
    case DepthFormat::kPfm:
      return EncodePfm(DecodeDepth(codes, code));
    case DepthFormat::kExr:
      return EncodeExr(DecodeDepth(codes, code));
    case DepthFormat::kYuv420p16:
      return EncodeRawLuma16(codes);
  }
  return EncodeDepthPng(codes);
}

Result<Grid<std::uint16_t>> ReadCodesFile(const std::string& path, int width, int height) {
  DEPTHFARM_ASSIGN_OR_RETURN(const std::string bytes, ReadFileBytes(path, kMaxFileBytes));
  return OfSize(DecodeDepthPng(bytes), path, width, height);
}

Result<DepthMap> ReadDepthFile(const std::string& path, int width, int height, const DepthCode& code) {
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthFormat format, FormatOf(path));
  if (IsMetric(format)) return ReadMetric(path, format, width, height);
  DEPTHFARM_ASSIGN_OR_RETURN(const Grid<std::uint16_t> codes, ReadCodes(path, format, width, height));
  return DecodeDepth(codes, code);
}

Result<Grid<std::uint16_t>> ReadDepthCodes(const std::string& path, int width, int height, const DepthCode& code) {
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthFormat format, FormatOf(path));
  if (!IsMetric(format)) return ReadCodes(path, format, width, height);
  DEPTHFARM_ASSIGN_OR_RETURN(const DepthMap depth, ReadMetric(path, format, width, height));
  return EncodeDepth(depth, code);
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
