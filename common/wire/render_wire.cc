#include "common/wire/render_wire.h"

#include <set>
#include <string>
#include <utility>

#include "common/wire/bounds.h"
#include "common/wire/digest_wire.h"
#include "common/wire/sequence_wire.h"

namespace depthfarm {
namespace {

constexpr int kMaxSources = 8;

Result<VirtualPicture> ViewFromProto(const v1::VirtualPicture& proto) {
  VirtualPicture view;
  DEPTHFARM_ASSIGN_OR_RETURN(view.camera, FromProto(proto.camera()));
  DEPTHFARM_ASSIGN_OR_RETURN(view.frame, BoundedInt("frame", proto.frame(), kMaxFrames));
  DEPTHFARM_ASSIGN_OR_RETURN(view.number, BoundedInt("number", proto.number(), kMaxFrames));
  if (proto.sources().empty()) return InvalidArgument("sources: expected at least one camera");
  DEPTHFARM_RETURN_IF_ERROR(CheckCount("sources", proto.sources_size(), kMaxSources));
  for (const std::string& source : proto.sources()) {
    DEPTHFARM_RETURN_IF_ERROR(CheckFileName("sources: camera", source));
    view.sources.push_back(source);
  }
  return view;
}

}  // namespace

v1::VirtualPicture ToProto(const VirtualPicture& view) {
  v1::VirtualPicture proto;
  *proto.mutable_camera() = ToProto(view.camera);
  proto.set_frame(static_cast<std::uint32_t>(view.frame));
  for (const std::string& source : view.sources) proto.add_sources(source);
  proto.set_number(static_cast<std::uint32_t>(view.number));
  return proto;
}

v1::RenderSource ToProto(const RenderSource& source) {
  v1::RenderSource proto;
  proto.set_depth_dir(source.depth_dir);
  proto.set_manifest_sha256(DigestBytes(source.manifest_sha256));
  return proto;
}

Result<std::vector<VirtualPicture>> ViewsFromProto(
    const google::protobuf::RepeatedPtrField<v1::VirtualPicture>& views) {
  DEPTHFARM_RETURN_IF_ERROR(CheckCount("views", views.size(), kMaxVirtualPictures));
  std::vector<VirtualPicture> result;
  std::set<int> numbers;
  for (int i = 0; i < views.size(); ++i) {
    Result<VirtualPicture> view = ViewFromProto(views[i]);
    if (!view.ok()) return view.status().WithContext("view " + std::to_string(i));
    if (!numbers.insert(view->number).second) {
      return InvalidArgument("view " + std::to_string(i) + ": number " + std::to_string(view->number) +
                             " is another view's");
    }
    result.push_back(std::move(*view));
  }
  return result;
}

Result<RenderSource> FromProto(const v1::RenderSource& proto) {
  RenderSource source;
  DEPTHFARM_RETURN_IF_ERROR(CheckAbsolutePath("depth folder", proto.depth_dir()));
  source.depth_dir = proto.depth_dir();
  DEPTHFARM_ASSIGN_OR_RETURN(source.manifest_sha256, DigestFromBytes("digest of depth.json", proto.manifest_sha256()));
  return source;
}

}  // namespace depthfarm
