#include "common/wire/results_wire.h"

#include <utility>

#include "common/wire/bounds.h"
#include "common/wire/task_wire.h"

namespace depthfarm {

v1::FrameResult ToProto(const FrameResult& result) {
  v1::FrameResult proto;
  proto.set_frame(static_cast<std::uint32_t>(result.frame));
  *proto.mutable_bundle() = ToProto(result.bundle);
  for (const ArtifactLocation& location : result.locations) *proto.add_locations() = ToProto(location);
  for (const FileDigest& file : result.files) *proto.add_files() = ToProto(file);
  for (const ContentDigest& digest : result.picture_digests) proto.add_picture_digests(DigestBytes(digest));
  return proto;
}

Result<FrameResult> FromProto(const v1::FrameResult& proto) {
  FrameResult result;
  DEPTHFARM_ASSIGN_OR_RETURN(result.frame, BoundedInt("frame of a result", proto.frame(), kMaxFrames - 1));
  DEPTHFARM_ASSIGN_OR_RETURN(result.bundle, FromProto(proto.bundle()));
  DEPTHFARM_RETURN_IF_ERROR(CheckCount("locations of a result", proto.locations_size(), kMaxLocations));
  for (const v1::ArtifactLocation& location : proto.locations()) {
    DEPTHFARM_ASSIGN_OR_RETURN(ArtifactLocation parsed, FromProto(location));
    result.locations.push_back(std::move(parsed));
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckCount("files of a result", proto.files_size(), 2 * kMaxViews));
  for (const v1::FileDigest& file : proto.files()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const FileDigest parsed, FromProto(file));
    result.files.push_back(parsed);
  }
  DEPTHFARM_RETURN_IF_ERROR(CheckCount("pictures of a result", proto.picture_digests_size(), kMaxViews));
  for (const std::string& bytes : proto.picture_digests()) {
    DEPTHFARM_ASSIGN_OR_RETURN(const ContentDigest digest, DigestFromBytes("picture digest", bytes));
    result.picture_digests.push_back(digest);
  }
  return result;
}

}  // namespace depthfarm
