#include "tests/common/video_input/written_video.h"

extern "C" {
#include <libavformat/avformat.h>
#include <libavutil/log.h>
#include <libavutil/pixdesc.h>
}

#include <stdexcept>

#include "common/video/handles.h"

namespace depthfarm::test {
namespace {

int Check(int result, const std::string& what) {
  if (result < 0) throw std::runtime_error(AvFailure(what, result).message());
  return result;
}

int Shifted(int size, int shift) { return (size + (1 << shift) - 1) >> shift; }

void Fill(const VideoRecipe& recipe, int number, AVFrame& frame) {
  const AVPixFmtDescriptor* samples = av_pix_fmt_desc_get(recipe.samples);
  const int bits = samples->comp[0].depth;
  for (int p = 0; p < samples->nb_components; ++p) {
    const int shift_x = p == 0 ? 0 : samples->log2_chroma_w;
    const int shift_y = p == 0 ? 0 : samples->log2_chroma_h;
    for (int y = 0; y < Shifted(recipe.height, shift_y); ++y) {
      for (int x = 0; x < Shifted(recipe.width, shift_x); ++x) {
        const int sample = SampleAt(p, x, y, number, bits);
        std::uint8_t* row = frame.data[p] + static_cast<std::ptrdiff_t>(y) * frame.linesize[p];
        if (bits > 8) {
          reinterpret_cast<std::uint16_t*>(row)[x] = static_cast<std::uint16_t>(sample);
        } else {
          row[x] = static_cast<std::uint8_t>(sample);
        }
      }
    }
  }
}

class Writer {
 public:
  Writer(const VideoRecipe& recipe, const std::string& path) : recipe_(recipe) {
    av_log_set_level(AV_LOG_ERROR);
    Check(avformat_alloc_output_context2(&container_, nullptr, nullptr, path.c_str()), path);
    const AVCodec* codec = avcodec_find_encoder_by_name(recipe.encoder.c_str());
    if (codec == nullptr) throw std::runtime_error("no encoder " + recipe.encoder);
    encoder_.reset(avcodec_alloc_context3(codec));
    encoder_->width = recipe.width;
    encoder_->height = recipe.height;
    encoder_->pix_fmt = recipe.samples;
    encoder_->time_base = av_inv_q(recipe.rate);
    encoder_->framerate = recipe.rate;
    encoder_->gop_size = recipe.key_interval;
    encoder_->max_b_frames = recipe.b_frames;
    encoder_->color_range = recipe.range;
    encoder_->colorspace = recipe.matrix;
    encoder_->thread_count = 1;
    encoder_->strict_std_compliance = FF_COMPLIANCE_UNOFFICIAL;
    if (recipe.interlaced) encoder_->flags |= AV_CODEC_FLAG_INTERLACED_DCT | AV_CODEC_FLAG_INTERLACED_ME;
    if ((container_->oformat->flags & AVFMT_GLOBALHEADER) != 0) encoder_->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    AVDictionary* options = nullptr;
    for (const auto& [name, value] : recipe.options) av_dict_set(&options, name.c_str(), value.c_str(), 0);
    Check(avcodec_open2(encoder_.get(), codec, &options), recipe.encoder);
    const int unknown = av_dict_count(options);
    av_dict_free(&options);
    if (unknown > 0) throw std::runtime_error("an option that " + recipe.encoder + " does not have");
    stream_ = avformat_new_stream(container_, nullptr);
    Check(avcodec_parameters_from_context(stream_->codecpar, encoder_.get()), "parameters");
    stream_->time_base = encoder_->time_base;
    stream_->avg_frame_rate = recipe.rate;
    Check(avio_open(&container_->pb, path.c_str(), AVIO_FLAG_WRITE), path);
    Check(avformat_write_header(container_, nullptr), "header");
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() {
    avio_closep(&container_->pb);
    avformat_free_context(container_);
  }

  void Put(int number) {
    const Frame frame(av_frame_alloc());
    frame->format = recipe_.samples;
    frame->width = recipe_.width;
    frame->height = recipe_.height;
    Check(av_frame_get_buffer(frame.get(), 0), "frame");
    Fill(recipe_, number, *frame);
    frame->pts = recipe_.place(number);
    frame->color_range = recipe_.range;
    frame->colorspace = recipe_.matrix;
    frame->interlaced_frame = recipe_.interlaced ? 1 : 0;
    frame->top_field_first = frame->interlaced_frame;
    Send(frame.get());
  }
  void Finish() {
    Send(nullptr);
    Check(av_write_trailer(container_), "trailer");
  }

 private:
  void Send(const AVFrame* frame) {
    Check(avcodec_send_frame(encoder_.get(), frame), "encode");
    for (;;) {
      const Packet packet(av_packet_alloc());
      const int received = avcodec_receive_packet(encoder_.get(), packet.get());
      if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return;
      Check(received, "encode");
      packet->duration = 1;
      av_packet_rescale_ts(packet.get(), encoder_->time_base, stream_->time_base);
      packet->stream_index = stream_->index;
      Check(av_interleaved_write_frame(container_, packet.get()), "write");
    }
  }

  const VideoRecipe& recipe_;
  AVFormatContext* container_ = nullptr;
  CodecContext encoder_;
  AVStream* stream_ = nullptr;
};

}  // namespace

int SampleAt(int plane, int x, int y, int frame, int bits) {
  // Hills that move, with noise on them, well within any range.
  const unsigned noise = (static_cast<unsigned>(x) * 2654435761U) ^ (static_cast<unsigned>(y) * 40503U) ^
                         (static_cast<unsigned>(frame) * 97U) ^ (static_cast<unsigned>(plane) << 7U);
  const int level = 64 + (3 * x + 2 * y + 5 * frame + 40 * plane) % 96 + static_cast<int>((noise >> 5U) % 8);
  return (level << (bits - 8)) + (bits > 8 ? static_cast<int>(noise % 4) : 0);
}

std::string PlanesOfFrame(const VideoRecipe& recipe, int frame) {
  const AVPixFmtDescriptor* samples = av_pix_fmt_desc_get(recipe.samples);
  const int bits = samples->comp[0].depth;
  std::string bytes;
  for (int p = 0; p < samples->nb_components; ++p) {
    const int shift_x = p == 0 ? 0 : samples->log2_chroma_w;
    const int shift_y = p == 0 ? 0 : samples->log2_chroma_h;
    for (int y = 0; y < Shifted(recipe.height, shift_y); ++y) {
      for (int x = 0; x < Shifted(recipe.width, shift_x); ++x) {
        const int sample = SampleAt(p, x, y, frame, bits);
        bytes.push_back(static_cast<char>(sample & 0xff));
        if (bits > 8) bytes.push_back(static_cast<char>(sample >> 8));
      }
    }
  }
  return bytes;
}

void WriteVideo(const VideoRecipe& recipe, const std::string& path) {
  Writer writer(recipe, path);
  for (int frame = 0; frame < recipe.frames; ++frame)
    if (recipe.place(frame) >= 0) writer.Put(frame);
  writer.Finish();
}

}  // namespace depthfarm::test
