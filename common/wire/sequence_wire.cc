#include "common/wire/sequence_wire.h"

#include <set>
#include <string>
#include <utility>

#include "common/wire/bounds.h"

namespace depthfarm {
namespace {

constexpr int kMaxSide = 32768;

Status ReadMatrix(const std::string& field, const google::protobuf::RepeatedField<double>& values,
                  Eigen::Matrix3d& matrix) {
  if (values.size() != 9) {
    return InvalidArgument(field + " has " + std::to_string(values.size()) + " numbers, expected 9");
  }
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) matrix(row, col) = values[3 * row + col];
  }
  return {};
}

Result<std::optional<double>> OptionalDistance(const std::string& field, bool present, double value) {
  if (!present) return std::optional<double>();
  DEPTHFARM_RETURN_IF_ERROR(CheckFinite(field, value));
  if (value <= 0) return InvalidArgument(field + " is " + std::to_string(value) + ", expected > 0");
  return std::optional<double>(value);
}

using Paths = google::protobuf::RepeatedPtrField<std::string>;

// None, or one for each of `count` frames, some of them empty.
Status ReadGuides(const std::string& field, const Paths& proto, std::size_t count, std::vector<std::string>& paths) {
  if (proto.empty()) return {};
  if (static_cast<std::size_t>(proto.size()) != count)
    return InvalidArgument(field + " are " + std::to_string(proto.size()) + ", expected one a frame, " +
                           std::to_string(count));
  for (const std::string& path : proto) {
    if (!path.empty()) DEPTHFARM_RETURN_IF_ERROR(CheckAbsolutePath(field, path));
    paths.push_back(path);
  }
  return {};
}

Result<SequenceCamera> CameraFromProto(const v1::SequenceCamera& proto) {
  SequenceCamera camera;
  DEPTHFARM_ASSIGN_OR_RETURN(camera.camera, FromProto(proto.camera()));
  const std::string name = "camera '" + camera.camera.name + "': ";
  DEPTHFARM_ASSIGN_OR_RETURN(camera.format, FromProto(proto.format()));
  DEPTHFARM_RETURN_IF_ERROR(CheckCount(name + "images", proto.images_size(), kMaxFrames));
  for (const std::string& image : proto.images()) {
    DEPTHFARM_RETURN_IF_ERROR(CheckAbsolutePath(name + "image", image));
    if (camera.format.of_all_frames() && !camera.images.empty() && image != camera.images.front())
      return InvalidArgument(name + "the frames of a video are in two files");
    camera.images.push_back(image);
  }
  DEPTHFARM_RETURN_IF_ERROR(ReadGuides(name + "masks", proto.masks(), camera.images.size(), camera.masks));
  DEPTHFARM_RETURN_IF_ERROR(ReadGuides(name + "priors", proto.prior(), camera.images.size(), camera.prior));
  DEPTHFARM_RETURN_IF_ERROR(ReadGuides(name + "confidences of the prior", proto.prior_confidence(),
                                       camera.images.size(), camera.prior_confidence));
  DEPTHFARM_ASSIGN_OR_RETURN(camera.prior_format, FromProto(proto.prior_format()));
  if (AnyFile(camera.prior) && camera.prior_format.holds == PriorFormat::Holds::kNothing)
    return InvalidArgument(name + "priors have no format: what they hold is not said");
  DEPTHFARM_ASSIGN_OR_RETURN(camera.z_near, OptionalDistance(name + "zNear", proto.has_z_near(), proto.z_near()));
  DEPTHFARM_ASSIGN_OR_RETURN(camera.z_far, OptionalDistance(name + "zFar", proto.has_z_far(), proto.z_far()));
  return camera;
}

v1::SequenceCamera CameraToProto(const SequenceCamera& camera) {
  v1::SequenceCamera proto;
  *proto.mutable_camera() = ToProto(camera.camera);
  *proto.mutable_format() = ToProto(camera.format);
  for (const std::string& image : camera.images) proto.add_images(image);
  for (const std::string& mask : camera.masks) proto.add_masks(mask);
  for (const std::string& prior : camera.prior) proto.add_prior(prior);
  for (const std::string& confidence : camera.prior_confidence) proto.add_prior_confidence(confidence);
  *proto.mutable_prior_format() = ToProto(camera.prior_format);
  if (camera.z_near) proto.set_z_near(*camera.z_near);
  if (camera.z_far) proto.set_z_far(*camera.z_far);
  return proto;
}

}  // namespace

v1::Camera ToProto(const Camera& camera) {
  v1::Camera proto;
  proto.set_name(camera.name);
  proto.set_width(static_cast<std::uint32_t>(camera.width));
  proto.set_height(static_cast<std::uint32_t>(camera.height));
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) {
      proto.add_k(camera.intrinsics(row, col));
      proto.add_r(camera.cam_from_world_rotation(row, col));
    }
    proto.add_t(camera.cam_from_world_translation[row]);
  }
  return proto;
}

Result<Camera> FromProto(const v1::Camera& proto) {
  Camera camera;
  DEPTHFARM_RETURN_IF_ERROR(CheckFileName("camera name", proto.name()));
  camera.name = proto.name();
  const std::string name = "camera '" + camera.name + "': ";
  DEPTHFARM_ASSIGN_OR_RETURN(camera.width, BoundedInt(name + "width", proto.width(), kMaxSide));
  DEPTHFARM_ASSIGN_OR_RETURN(camera.height, BoundedInt(name + "height", proto.height(), kMaxSide));
  DEPTHFARM_RETURN_IF_ERROR(ReadMatrix(name + "K", proto.k(), camera.intrinsics));
  DEPTHFARM_RETURN_IF_ERROR(ReadMatrix(name + "R", proto.r(), camera.cam_from_world_rotation));
  if (proto.t_size() != 3) {
    return InvalidArgument(name + "t has " + std::to_string(proto.t_size()) + " numbers, expected 3");
  }
  for (int i = 0; i < 3; ++i) camera.cam_from_world_translation[i] = proto.t(i);
  DEPTHFARM_RETURN_IF_ERROR(ValidateCamera(camera));
  return camera;
}

v1::PictureFormat ToProto(const PictureFormat& format) {
  v1::PictureFormat proto;
  switch (format.kind) {
    case PictureFormat::Kind::kImage:
      proto.set_kind(v1::PICTURE_KIND_IMAGE);
      break;
    case PictureFormat::Kind::kYuv420:
      proto.set_kind(v1::PICTURE_KIND_YUV420);
      break;
    case PictureFormat::Kind::kYuv400:
      proto.set_kind(v1::PICTURE_KIND_YUV400);
      break;
    case PictureFormat::Kind::kYuv422:
      proto.set_kind(v1::PICTURE_KIND_YUV422);
      break;
    case PictureFormat::Kind::kYuv444:
      proto.set_kind(v1::PICTURE_KIND_YUV444);
      break;
    case PictureFormat::Kind::kVideo:
      proto.set_kind(v1::PICTURE_KIND_VIDEO);
      break;
  }
  proto.set_bits(static_cast<std::uint32_t>(format.bits));
  proto.set_full_range(format.full_range);
  proto.set_bt709(format.bt709);
  proto.set_all_frames(format.all_frames);
  proto.set_colour_said(format.colour_said);
  return proto;
}

Result<PictureFormat> FromProto(const v1::PictureFormat& proto) {
  PictureFormat format;
  switch (proto.kind()) {
    case v1::PICTURE_KIND_IMAGE:
      format.kind = PictureFormat::Kind::kImage;
      break;
    case v1::PICTURE_KIND_YUV420:
      format.kind = PictureFormat::Kind::kYuv420;
      break;
    case v1::PICTURE_KIND_YUV400:
      format.kind = PictureFormat::Kind::kYuv400;
      break;
    case v1::PICTURE_KIND_YUV422:
      format.kind = PictureFormat::Kind::kYuv422;
      break;
    case v1::PICTURE_KIND_YUV444:
      format.kind = PictureFormat::Kind::kYuv444;
      break;
    case v1::PICTURE_KIND_VIDEO:
      format.kind = PictureFormat::Kind::kVideo;
      break;
    default:
      return InvalidArgument("picture format is " + std::to_string(proto.kind()) +
                             ", expected image, yuv420, yuv400, yuv422, yuv444 or video");
  }
  DEPTHFARM_ASSIGN_OR_RETURN(format.bits, BoundedInt("picture bits", proto.bits(), 16));
  if (format.bits < 8) return InvalidArgument("picture bits is " + std::to_string(format.bits) + ", expected 8 to 16");
  format.full_range = proto.full_range();
  format.bt709 = proto.bt709();
  format.all_frames = proto.all_frames();
  format.colour_said = proto.colour_said();
  if (format.all_frames && !format.raw()) return InvalidArgument("pictures of all frames in one file are no raw ones");
  if (format.colour_said && format.kind != PictureFormat::Kind::kVideo)
    return InvalidArgument("range and matrix are said of pictures that are no video");
  return format;
}

v1::PriorFormat ToProto(const PriorFormat& format) {
  v1::PriorFormat proto;
  proto.set_content(static_cast<v1::PriorContent>(format.holds));
  proto.set_unit(format.unit);
  proto.set_z_near(format.z_near);
  proto.set_z_far(format.z_far);
  return proto;
}

Result<PriorFormat> FromProto(const v1::PriorFormat& proto) {
  PriorFormat format;
  if (proto.content() == v1::PRIOR_CONTENT_NOTHING) return format;
  if (!v1::PriorContent_IsValid(proto.content()))
    return InvalidArgument("content of the prior is " + std::to_string(proto.content()) + ", expected 0 to 4");
  format.holds = static_cast<PriorFormat::Holds>(proto.content());
  format.unit = proto.unit();
  format.z_near = proto.z_near();
  format.z_far = proto.z_far();
  DEPTHFARM_RETURN_IF_ERROR(CheckFinite("unit of the prior", format.unit));
  if (format.unit <= 0)
    return InvalidArgument("unit of the prior is " + std::to_string(format.unit) + ", expected > 0");
  DEPTHFARM_RETURN_IF_ERROR(CheckFinite("zNear of the prior", format.z_near));
  DEPTHFARM_RETURN_IF_ERROR(CheckFinite("zFar of the prior", format.z_far));
  if (format.holds == PriorFormat::Holds::kCodes && !(format.z_near > 0 && format.z_near < format.z_far))
    return InvalidArgument("range of the prior is " + std::to_string(format.z_near) + " to " +
                           std::to_string(format.z_far) + ", expected 0 < near < far");
  return format;
}

v1::Sequence ToProto(const Sequence& sequence) {
  v1::Sequence proto;
  proto.set_name(sequence.name);
  proto.set_file(sequence.file);
  if (sequence.z_near) proto.set_z_near(*sequence.z_near);
  if (sequence.z_far) proto.set_z_far(*sequence.z_far);
  proto.set_frame_rate(sequence.frame_rate);
  proto.set_reference(sequence.reference);
  for (const SequenceCamera& camera : sequence.cameras) *proto.add_cameras() = CameraToProto(camera);
  return proto;
}

Result<Sequence> FromProto(const v1::Sequence& proto) {
  Sequence sequence;
  DEPTHFARM_RETURN_IF_ERROR(CheckText("sequence name", proto.name(), kMaxNameBytes));
  sequence.name = proto.name();
  DEPTHFARM_RETURN_IF_ERROR(CheckText("sequence file", proto.file(), kMaxPathBytes));
  sequence.file = proto.file();
  DEPTHFARM_ASSIGN_OR_RETURN(sequence.z_near, OptionalDistance("sequence zNear", proto.has_z_near(), proto.z_near()));
  DEPTHFARM_ASSIGN_OR_RETURN(sequence.z_far, OptionalDistance("sequence zFar", proto.has_z_far(), proto.z_far()));
  DEPTHFARM_RETURN_IF_ERROR(CheckFinite("sequence frameRate", proto.frame_rate()));
  if (proto.frame_rate() < 0) return InvalidArgument("sequence frameRate is negative, expected >= 0 (0: unknown)");
  sequence.frame_rate = proto.frame_rate();
  DEPTHFARM_RETURN_IF_ERROR(CheckText("sequence reference", proto.reference(), kMaxNameBytes));
  sequence.reference = proto.reference();
  DEPTHFARM_RETURN_IF_ERROR(CheckCount("sequence cameras", proto.cameras_size(), kMaxViews));
  std::set<std::string> names;
  for (const v1::SequenceCamera& camera : proto.cameras()) {
    DEPTHFARM_ASSIGN_OR_RETURN(SequenceCamera parsed, CameraFromProto(camera));
    if (!names.insert(parsed.camera.name).second) {
      return InvalidArgument("camera '" + parsed.camera.name + "' is listed twice");
    }
    sequence.cameras.push_back(std::move(parsed));
  }
  return sequence;
}

}  // namespace depthfarm
