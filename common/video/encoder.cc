#include "common/video/encoder.h"

extern "C" {
#include <libavutil/opt.h>
}

#include <cstring>
#include <utility>

namespace depthfarm {
namespace {

constexpr int kSmallestSide = 16;

AVPixelFormat PixelFormat(int bits) { return bits == 8 ? AV_PIX_FMT_YUV420P : AV_PIX_FMT_YUV420P10LE; }

}  // namespace

std::size_t PictureBytes(const VideoFormat& format) {
  const std::size_t luma = static_cast<std::size_t>(format.width) * static_cast<std::size_t>(format.height);
  return luma * 3 / 2 * (format.bits == 8 ? 1 : 2);
}

Encoder::Encoder(const VideoFormat& format, CodecContext context)
    : format_(format), context_(std::move(context)), frame_(av_frame_alloc()), packet_(av_packet_alloc()) {}

Result<Encoder> Encoder::Create(const VideoFormat& format, const Options& options) {
  if (format.width < kSmallestSide || format.height < kSmallestSide || format.width % 2 != 0 ||
      format.height % 2 != 0) {
    return InvalidArgument("a video of " + std::to_string(format.width) + "x" + std::to_string(format.height) +
                           " pixels cannot be encoded, expected even sides of at least 16");
  }
  av_log_set_level(AV_LOG_ERROR);  // of the process: encoders would write a dozen lines a video to stderr
  const AVCodec* codec = avcodec_find_encoder_by_name(options.name);
  if (codec == nullptr) {
    return Unavailable(std::string("this machine's libav has no encoder '") + options.name +
                       "': install libavcodec with it (on Debian libavcodec59)");
  }
  CodecContext context(avcodec_alloc_context3(codec));
  context->width = format.width;
  context->height = format.height;
  context->pix_fmt = PixelFormat(format.bits);
  context->time_base = {1, format.frames_per_second};
  context->framerate = {format.frames_per_second, 1};
  context->color_range = AVCOL_RANGE_MPEG;
  context->colorspace = AVCOL_SPC_SMPTE170M;
  context->thread_count = 1;  // more would be faster, and the bytes depend on the number
  if (options.global_header) context->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  int error = av_opt_set(context->priv_data, "preset", options.preset, 0);
  if (error >= 0 && !options.parameters_name.empty()) {
    error = av_opt_set(context->priv_data, options.parameters_name.c_str(), options.parameters.c_str(), 0);
  }
  if (error >= 0) error = avcodec_open2(context.get(), codec, nullptr);
  if (error < 0) return AvFailure(std::string("encoder ") + options.name + " cannot be opened", error);
  Encoder encoder(format, std::move(context));
  AVFrame& frame = *encoder.frame_;
  frame.width = format.width;
  frame.height = format.height;
  frame.format = encoder.context_->pix_fmt;
  frame.pts = -1;
  error = av_frame_get_buffer(&frame, 0);
  if (error < 0) return AvFailure("memory of a picture", error);
  return encoder;
}

Status Encoder::Put(std::string_view picture, const PacketFunction& on_packet) {
  if (picture.size() != PictureBytes(format_)) {
    return InvalidArgument("a picture of " + std::to_string(picture.size()) + " bytes, expected " +
                           std::to_string(PictureBytes(format_)));
  }
  AVFrame& frame = *frame_;
  const int error = av_frame_make_writable(&frame);  // the encoder may still look at the one before
  if (error < 0) return AvFailure("memory of a picture", error);
  const char* from = picture.data();
  for (int plane = 0; plane < 3; ++plane) {
    const int shift = plane == 0 ? 0 : 1;
    const std::size_t row = static_cast<std::size_t>(format_.width >> shift) * (format_.bits == 8 ? 1 : 2);
    for (int y = 0; y < format_.height >> shift; ++y) {
      std::memcpy(frame.data[plane] + static_cast<std::ptrdiff_t>(y) * frame.linesize[plane], from, row);
      from += row;
    }
  }
  ++frame.pts;
  return Send(&frame, on_packet);
}

Status Encoder::Finish(const PacketFunction& on_packet) { return Send(nullptr, on_packet); }

Status Encoder::Send(const AVFrame* frame, const PacketFunction& on_packet) {
  int error = avcodec_send_frame(context_.get(), frame);
  if (error < 0) return AvFailure("encoding a picture", error);
  for (;;) {
    error = avcodec_receive_packet(context_.get(), packet_.get());
    if (error == AVERROR(EAGAIN) || error == AVERROR_EOF) return {};
    if (error < 0) return AvFailure("encoding a picture", error);
    const Status status = on_packet(packet_.get());
    av_packet_unref(packet_.get());
    DEPTHFARM_RETURN_IF_ERROR(status);
  }
}

}  // namespace depthfarm
