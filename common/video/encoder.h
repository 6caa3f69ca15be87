#ifndef DEPTHFARM_COMMON_VIDEO_ENCODER_H_
#define DEPTHFARM_COMMON_VIDEO_ENCODER_H_

#include <functional>
#include <string>
#include <string_view>

#include "common/base/status.h"
#include "common/video/handles.h"

namespace depthfarm {

struct VideoFormat {
  int width = 0;   // pixels, even
  int height = 0;  // pixels, even
  int bits = 8;    // of a sample: 8, or 10 (two bytes, little-endian)
  int frames_per_second = 25;
};

// Bytes of one planar 4:2:0 picture.
[[nodiscard]] std::size_t PictureBytes(const VideoFormat& format);

// One of libav's video encoders, fed with planar 4:2:0 pictures of BT.601 in 16-235. For use inside this folder.
class Encoder {
 public:
  struct Options {
    const char* name = "";          // libav's name of the encoder
    const char* preset = "medium";  // its speed
    std::string parameters_name;    // the encoder's own parameters: the name of that option ...
    std::string parameters;         // ... and its value, key=value:key=value
    bool global_header = false;     // parameter sets beside the packets, as mp4 wants them
  };
  using PacketFunction = std::function<Status(AVPacket*)>;

  // Errors  kInvalidArgument: sides that are odd or below 16 pixels; kUnavailable: this libav has no such encoder.
  [[nodiscard]] static Result<Encoder> Create(const VideoFormat& format, const Options& options);

  // Encodes one picture (PictureBytes() long) and hands over the packets that are ready.
  [[nodiscard]] Status Put(std::string_view picture, const PacketFunction& on_packet);
  // Hands over the rest.
  [[nodiscard]] Status Finish(const PacketFunction& on_packet);

  [[nodiscard]] const AVCodecContext& context() const { return *context_; }

 private:
  Encoder(const VideoFormat& format, CodecContext context);
  [[nodiscard]] Status Send(const AVFrame* frame, const PacketFunction& on_packet);

  VideoFormat format_;
  CodecContext context_;
  Frame frame_;
  Packet packet_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_VIDEO_ENCODER_H_
