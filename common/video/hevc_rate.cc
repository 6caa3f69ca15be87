#include "common/video/hevc_rate.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <string>
#include <utility>

#include "common/video/encoder.h"
#include "common/video/handles.h"

namespace depthfarm {
namespace {

// A picture that decodes to itself has no finite PSNR, and a mean with it would say nothing: HM's value for it.
constexpr double kPsnrOfEqualPictures = 99.99;

Result<CodecContext> OpenDecoder() {
  const AVCodec* codec = avcodec_find_decoder(AV_CODEC_ID_HEVC);
  if (codec == nullptr) return Unavailable("this machine's libav has no HEVC decoder");
  CodecContext context(avcodec_alloc_context3(codec));
  context->thread_count = 1;
  const int error = avcodec_open2(context.get(), codec, nullptr);
  if (error < 0) return AvFailure("HEVC decoder cannot be opened", error);
  return context;
}

template <typename Sample>
double SquaredError(const std::string& picture, const AVFrame& decoded) {
  double sum = 0;
  const char* row = picture.data();
  for (int y = 0; y < decoded.height; ++y) {
    const std::uint8_t* decoded_row = decoded.data[0] + static_cast<std::ptrdiff_t>(y) * decoded.linesize[0];
    std::int64_t row_sum = 0;
    for (int x = 0; x < decoded.width; ++x) {
      Sample a = 0;
      Sample b = 0;
      std::memcpy(&a, row + static_cast<std::size_t>(x) * sizeof(Sample), sizeof(Sample));
      std::memcpy(&b, decoded_row + static_cast<std::size_t>(x) * sizeof(Sample), sizeof(Sample));
      const std::int64_t difference = static_cast<std::int64_t>(a) - static_cast<std::int64_t>(b);
      row_sum += difference * difference;
    }
    sum += static_cast<double>(row_sum);
    row += static_cast<std::size_t>(decoded.width) * sizeof(Sample);
  }
  return sum;
}

}  // namespace

struct HevcRateMeter::Codec {
  Codec(const VideoFormat& video_format, Encoder opened_encoder, CodecContext opened_decoder)
      : format(video_format),
        encoder(std::move(opened_encoder)),
        decoder(std::move(opened_decoder)),
        decoded(av_frame_alloc()) {}

  Status OnPacket(const AVPacket* packet) {
    bits += 8.0 * packet->size;
    return Decode(packet);
  }

  // A null packet: what is still inside.
  Status Decode(const AVPacket* packet) {
    int error = avcodec_send_packet(decoder.get(), packet);
    if (error < 0) return AvFailure("decoding a picture", error);
    for (;;) {
      error = avcodec_receive_frame(decoder.get(), decoded.get());
      if (error == AVERROR(EAGAIN) || error == AVERROR_EOF) return {};
      if (error < 0) return AvFailure("decoding a picture", error);
      const Status status = Compare();
      av_frame_unref(decoded.get());
      DEPTHFARM_RETURN_IF_ERROR(status);
    }
  }

  Status Compare() {
    if (waiting.empty() || decoded->width != format.width || decoded->height != format.height) {
      return Internal("the HEVC decoder gave a picture that was not asked for");
    }
    const double error = format.bits == 8 ? SquaredError<std::uint8_t>(waiting.front(), *decoded)
                                          : SquaredError<std::uint16_t>(waiting.front(), *decoded);
    waiting.pop_front();
    const double peak = (1 << format.bits) - 1;
    const double pixels = static_cast<double>(format.width) * format.height;
    psnr_sum += error > 0 ? std::min(10 * std::log10(peak * peak * pixels / error), kPsnrOfEqualPictures)
                          : kPsnrOfEqualPictures;
    ++compared;
    return {};
  }

  VideoFormat format;
  int qp = 0;
  Encoder encoder;
  CodecContext decoder;
  Frame decoded;
  std::deque<std::string> waiting;  // encoded, not yet decoded
  double bits = 0;
  double psnr_sum = 0;
  int pictures = 0;
  int compared = 0;
};

HevcRateMeter::HevcRateMeter(std::unique_ptr<Codec> codec) : codec_(std::move(codec)) {}
HevcRateMeter::HevcRateMeter(HevcRateMeter&&) noexcept = default;
HevcRateMeter& HevcRateMeter::operator=(HevcRateMeter&&) noexcept = default;
HevcRateMeter::~HevcRateMeter() = default;

Result<HevcRateMeter> HevcRateMeter::Create(int width, int height, int bits, int qp) {
  if (bits != 8 && bits != 10) {
    return InvalidArgument("HEVC of " + std::to_string(bits) + " bits a sample is asked for, expected 8 or 10");
  }
  if (qp < 0 || qp > 51) {
    return InvalidArgument("a quantiser of " + std::to_string(qp) + " is asked for, expected 0 to 51");
  }
  const VideoFormat format = {width, height, bits};
  Encoder::Options options;
  options.name = "libx265";
  options.parameters_name = "x265-params";
  options.parameters = "qp=" + std::to_string(qp) +
                       ":keyint=-1:bframes=0:scenecut=0:rc-lookahead=0:open-gop=0:pools=none:frame-threads=1:wpp=0:"
                       "info=0:log-level=error";
  DEPTHFARM_ASSIGN_OR_RETURN(Encoder encoder, Encoder::Create(format, options));
  DEPTHFARM_ASSIGN_OR_RETURN(CodecContext decoder, OpenDecoder());
  auto codec = std::make_unique<Codec>(format, std::move(encoder), std::move(decoder));
  codec->qp = qp;
  return HevcRateMeter(std::move(codec));
}

Status HevcRateMeter::Put(std::string_view picture) {
  codec_->waiting.emplace_back(picture);
  ++codec_->pictures;
  return codec_->encoder.Put(picture, [this](AVPacket* packet) { return codec_->OnPacket(packet); });
}

Result<HevcRate> HevcRateMeter::Finish() {
  if (codec_->pictures == 0) return InvalidArgument("a video without pictures has no bit rate");
  DEPTHFARM_RETURN_IF_ERROR(codec_->encoder.Finish([this](AVPacket* packet) { return codec_->OnPacket(packet); }));
  DEPTHFARM_RETURN_IF_ERROR(codec_->Decode(nullptr));
  if (codec_->compared != codec_->pictures) {
    return Internal("of " + std::to_string(codec_->pictures) + " pictures " + std::to_string(codec_->compared) +
                    " came out of the HEVC decoder");
  }
  return HevcRate{codec_->qp, codec_->pictures, codec_->bits / codec_->pictures, codec_->psnr_sum / codec_->pictures};
}

}  // namespace depthfarm
