#include "common/wire/digest_wire.h"

#include <algorithm>

namespace depthfarm {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 32;

}  // namespace

std::string DigestBytes(const std::array<std::uint8_t, 32>& digest) { return {digest.begin(), digest.end()}; }

Result<std::array<std::uint8_t, 32>> DigestFromBytes(std::string_view field, std::string_view bytes) {
  std::array<std::uint8_t, 32> digest{};
  if (bytes.size() != digest.size()) {
    return InvalidArgument(std::string(field) + " has " + std::to_string(bytes.size()) + " bytes, expected 32");
  }
  std::transform(bytes.begin(), bytes.end(), digest.begin(), [](char c) { return static_cast<std::uint8_t>(c); });
  return digest;
}

v1::FileDigest ToProto(const FileDigest& file) {
  v1::FileDigest proto;
  proto.set_sha256(DigestBytes(file.sha256));
  proto.set_bytes(file.bytes);
  return proto;
}

Result<FileDigest> FromProto(const v1::FileDigest& proto) {
  FileDigest file;
  DEPTHFARM_ASSIGN_OR_RETURN(file.sha256, DigestFromBytes("digest of a file", proto.sha256()));
  if (proto.bytes() == 0 || proto.bytes() > kMaxFileBytes) {
    return InvalidArgument("file is " + std::to_string(proto.bytes()) + " bytes, expected 1 to " +
                           std::to_string(kMaxFileBytes));
  }
  file.bytes = proto.bytes();
  return file;
}

v1::UploadedFile ToProto(const UploadedFile& upload) {
  v1::UploadedFile proto;
  *proto.mutable_file() = ToProto(upload.file);
  proto.set_artifact_digest(DigestBytes(upload.artifact_digest));
  return proto;
}

Result<UploadedFile> FromProto(const v1::UploadedFile& proto) {
  UploadedFile upload;
  DEPTHFARM_ASSIGN_OR_RETURN(upload.file, FromProto(proto.file()));
  DEPTHFARM_ASSIGN_OR_RETURN(upload.artifact_digest, DigestFromBytes("artifact digest", proto.artifact_digest()));
  return upload;
}

}  // namespace depthfarm
