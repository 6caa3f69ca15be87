#ifndef DEPTHFARM_COMMON_WIRE_DIGEST_WIRE_H_
#define DEPTHFARM_COMMON_WIRE_DIGEST_WIRE_H_

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/job/task_spec.h"
#include "depthfarm/v1/job.pb.h"

namespace depthfarm {

// 32 bytes: ArtifactKey, ContentDigest.
[[nodiscard]] std::string DigestBytes(const std::array<std::uint8_t, 32>& digest);
[[nodiscard]] Result<std::array<std::uint8_t, 32>> DigestFromBytes(std::string_view field, std::string_view bytes);

// Sizes are 1 to 4 GiB.
[[nodiscard]] v1::FileDigest ToProto(const FileDigest& file);
[[nodiscard]] Result<FileDigest> FromProto(const v1::FileDigest& file);
[[nodiscard]] v1::UploadedFile ToProto(const UploadedFile& upload);
[[nodiscard]] Result<UploadedFile> FromProto(const v1::UploadedFile& upload);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_WIRE_DIGEST_WIRE_H_
