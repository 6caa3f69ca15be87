#include "common/video_input/module/picture_planes.h"

extern "C" {
#include <libavutil/pixdesc.h>
}

#include <cstddef>
#include <cstdint>
#include <string>

namespace depthfarm {
namespace {

using Kind = PictureFormat::Kind;

std::string NameOf(const AVFrame& frame) {
  const char* name = av_get_pix_fmt_name(static_cast<AVPixelFormat>(frame.format));
  return name == nullptr ? "unknown" : name;
}

// Kind and bits of the samples.
Result<PictureFormat> SamplesOf(const AVFrame& frame) {
  constexpr std::uint64_t kOthers = AV_PIX_FMT_FLAG_BE | AV_PIX_FMT_FLAG_PAL | AV_PIX_FMT_FLAG_BITSTREAM |
                                    AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_RGB | AV_PIX_FMT_FLAG_BAYER |
                                    AV_PIX_FMT_FLAG_FLOAT;
  const AVPixFmtDescriptor* samples = av_pix_fmt_desc_get(static_cast<AVPixelFormat>(frame.format));
  const auto fits = [&] {
    if (samples == nullptr || (samples->flags & kOthers) != 0 || samples->nb_components == 2) return false;
    const int depth = samples->comp[0].depth;
    if (depth < 8 || depth > 16) return false;
    for (int c = 0; c < samples->nb_components; ++c) {
      const AVComponentDescriptor& component = samples->comp[c];
      if (component.plane != c || component.depth != depth || component.shift != 0 || component.offset != 0 ||
          component.step != (depth > 8 ? 2 : 1))
        return false;
    }
    return true;
  };
  PictureFormat format;
  if (fits()) {
    format.bits = samples->comp[0].depth;
    const std::pair shift(samples->log2_chroma_w, samples->log2_chroma_h);
    if (samples->nb_components == 1) {
      format.kind = Kind::kYuv400;
    } else if (shift == std::pair<std::uint8_t, std::uint8_t>(1, 1)) {
      format.kind = Kind::kYuv420;
    } else if (shift == std::pair<std::uint8_t, std::uint8_t>(1, 0)) {
      format.kind = Kind::kYuv422;
    } else if (shift == std::pair<std::uint8_t, std::uint8_t>(0, 0)) {
      format.kind = Kind::kYuv444;
    }
  }
  if (format.kind != Kind::kImage) return format;
  return InvalidArgument("its samples are " + NameOf(frame) +
                         ", expected grey or Y'CbCr 4:2:0, 4:2:2 or 4:4:4 of 8 to 16 bits in planes: convert it, e.g. "
                         "with ffmpeg -pix_fmt yuv444p10le");
}

// Range and matrix as the stream has them.
Status ReadColour(const AVFrame& frame, PictureFormat& format) {
  format.full_range = frame.color_range == AVCOL_RANGE_JPEG || NameOf(frame).starts_with("yuvj");
  switch (frame.colorspace) {
    case AVCOL_SPC_UNSPECIFIED:
    case AVCOL_SPC_BT470BG:
    case AVCOL_SPC_SMPTE170M:
      format.bt709 = false;
      return {};
    case AVCOL_SPC_BT709:
      format.bt709 = true;
      return {};
    default:
      break;
  }
  if (format.kind == Kind::kYuv400) return {};
  const char* name = av_color_space_name(frame.colorspace);
  return InvalidArgument(
      std::string("its matrix is ") + (name == nullptr ? "unknown" : name) +
      ", expected BT.601 or BT.709: convert it, or say 'range' and 'matrix' of the camera to take it "
      "for one of these");
}

void AppendPlane(const std::uint8_t* rows, std::ptrdiff_t stride, std::size_t row_bytes, int height,
                 std::string& bytes) {
  for (int y = 0; y < height; ++y) bytes.append(reinterpret_cast<const char*>(rows + y * stride), row_bytes);
}

}  // namespace

Result<PictureBytes> PlanesOf(const AVFrame& frame, const VideoFile& file) {
  if (frame.width != file.width || frame.height != file.height) {
    return InvalidArgument("has " + std::to_string(frame.width) + "x" + std::to_string(frame.height) +
                           " pixels, expected " + std::to_string(file.width) + "x" + std::to_string(file.height) +
                           ", the camera's size");
  }
  if (frame.interlaced_frame != 0)
    return InvalidArgument("is interlaced: two moments in one picture; deinterlace it first");
  PictureBytes picture;
  DEPTHFARM_ASSIGN_OR_RETURN(picture.format, SamplesOf(frame));
  if (file.format.colour_said) {
    picture.format.full_range = file.format.full_range;
    picture.format.bt709 = file.format.bt709;
  } else {
    DEPTHFARM_RETURN_IF_ERROR(ReadColour(frame, picture.format));
  }
  picture.bytes.reserve(RawPictureBytes(picture.format, frame.width, frame.height));
  const int planes = picture.format.kind == Kind::kYuv400 ? 1 : 3;
  const ChromaShift chroma = ChromaShiftOf(picture.format.kind);
  for (int p = 0; p < planes; ++p) {
    const ChromaShift shift = p == 0 ? ChromaShift() : chroma;
    const auto samples = static_cast<std::size_t>((frame.width + shift.x) >> shift.x);
    AppendPlane(frame.data[p], frame.linesize[p], samples * (picture.format.bits > 8 ? 2 : 1),
                (frame.height + shift.y) >> shift.y, picture.bytes);
  }
  return picture;
}

}  // namespace depthfarm
