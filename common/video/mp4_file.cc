#include "common/video/mp4_file.h"

#include <utility>

#include "common/files/pending_file.h"
#include "common/video/encoder.h"
#include "common/video/handles.h"

namespace depthfarm {
namespace {

Status WriteFailure(const std::string& path, int error) {
  return Unavailable(path + ": cannot be written: " + AvFailure("mp4", error).message());
}

}  // namespace

struct Mp4File::Stream {
  Stream(const std::string& path, Encoder opened) : file(path), encoder(std::move(opened)) {}
  ~Stream() {
    if (container == nullptr) return;
    avio_closep(&container->pb);
    avformat_free_context(container);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  Status Open() {
    int error = avformat_alloc_output_context2(&container, nullptr, "mp4", file.temporary().c_str());
    if (error < 0) return WriteFailure(file.path(), error);
    AVStream* video = avformat_new_stream(container, nullptr);
    if (video == nullptr) return WriteFailure(file.path(), AVERROR(ENOMEM));
    video->time_base = encoder.context().time_base;
    error = avcodec_parameters_from_context(video->codecpar, &encoder.context());
    if (error >= 0) error = avio_open(&container->pb, file.temporary().c_str(), AVIO_FLAG_WRITE);
    // Players can begin before they have read all of it.
    AVDictionary* options = nullptr;
    if (error >= 0) error = av_dict_set(&options, "movflags", "faststart", 0);
    if (error >= 0) error = avformat_write_header(container, &options);
    av_dict_free(&options);
    return error < 0 ? WriteFailure(file.path(), error) : Status();
  }

  Status Write(AVPacket* packet) {
    AVStream* video = container->streams[0];
    packet->stream_index = 0;
    packet->duration = 1;
    av_packet_rescale_ts(packet, encoder.context().time_base, video->time_base);
    const int error = av_write_frame(container, packet);
    return error < 0 ? WriteFailure(file.path(), error) : Status();
  }

  PendingFile file;
  Encoder encoder;
  AVFormatContext* container = nullptr;
};

Mp4File::Mp4File(std::unique_ptr<Stream> stream) : stream_(std::move(stream)) {}
Mp4File::Mp4File(Mp4File&&) noexcept = default;
Mp4File& Mp4File::operator=(Mp4File&&) noexcept = default;
Mp4File::~Mp4File() = default;

Result<Mp4File> Mp4File::Create(const std::string& path, int width, int height, int frames_per_second) {
  Encoder::Options options;
  options.name = "libx264";
  options.parameters_name = "x264-params";
  // x264 3095 with mbtree gives other bytes from run to run: its look-ahead reads memory that nobody wrote.
  options.parameters = "crf=16:mbtree=0";
  options.global_header = true;
  DEPTHFARM_ASSIGN_OR_RETURN(Encoder encoder, Encoder::Create({width, height, 8, frames_per_second}, options));
  auto stream = std::make_unique<Stream>(path, std::move(encoder));
  DEPTHFARM_RETURN_IF_ERROR(stream->Open());
  return Mp4File(std::move(stream));
}

Status Mp4File::Put(std::string_view picture) {
  return stream_->encoder.Put(picture, [this](AVPacket* packet) { return stream_->Write(packet); });
}

Status Mp4File::Finish() {
  DEPTHFARM_RETURN_IF_ERROR(stream_->encoder.Finish([this](AVPacket* packet) { return stream_->Write(packet); }));
  int error = av_write_trailer(stream_->container);
  if (error >= 0) error = avio_closep(&stream_->container->pb);
  if (error < 0) return WriteFailure(stream_->file.path(), error);
  return stream_->file.Commit();
}

}  // namespace depthfarm
