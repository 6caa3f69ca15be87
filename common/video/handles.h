#ifndef DEPTHFARM_COMMON_VIDEO_HANDLES_H_
#define DEPTHFARM_COMMON_VIDEO_HANDLES_H_

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <memory>
#include <string>

#include "common/base/status.h"

namespace depthfarm {

// libav's objects, freed by their own functions.
struct AvDeleter {
  void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
using CodecContext = std::unique_ptr<AVCodecContext, AvDeleter>;
using Frame = std::unique_ptr<AVFrame, AvDeleter>;
using Packet = std::unique_ptr<AVPacket, AvDeleter>;

// kInternal: "<what>: <libav's text of the error>".
[[nodiscard]] Status AvFailure(const std::string& what, int error);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_VIDEO_HANDLES_H_
