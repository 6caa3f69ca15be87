#ifndef DEPTHFARM_COMMON_VIDEO_INPUT_MODULE_AV_VIDEO_READER_H_
#define DEPTHFARM_COMMON_VIDEO_INPUT_MODULE_AV_VIDEO_READER_H_

#include <cstdint>
#include <memory>
#include <optional>

#include "common/video_input/module/opened_file.h"
#include "common/video_input/video_reader.h"

namespace depthfarm {

// A video read with libav. A picture is found by its time: the decoder starts at a key picture before it and what comes
// until then is dropped, also what a key picture lets be shown before itself, of which some may refer to what was not
// decoded. So what is decoded does not depend on where decoding began.
class AvVideoReader final : public VideoReader {
 public:
  // Errors, without the path: see OpenVideo; kInvalidArgument also: its first picture cannot be decoded.
  [[nodiscard]] static Result<std::unique_ptr<VideoReader>> Open(const VideoFile& file);

  [[nodiscard]] Result<PictureBytes> Read(int frame) override;

 private:
  explicit AvVideoReader(VideoFile file) : expected_(std::move(file)) {}

  // From the beginning: the container, the decoder, and the first picture.
  [[nodiscard]] Status Begin();
  [[nodiscard]] Status OpenDecoder();
  // Frames by what the container tells, counted or by the time, whichever is more: there may be gaps. nullopt: it does
  // not tell.
  [[nodiscard]] std::optional<double> ToldFrames() const;
  // kInvalidArgument where the container tells that there are fewer frames than expected.
  [[nodiscard]] Status CheckLength() const;
  // Goes to a key picture `back` units of time before frame `frame`, or to the beginning.
  [[nodiscard]] Status GoTo(int frame, std::int64_t back);
  // The next picture into frame_; false at the end.
  [[nodiscard]] Result<bool> DecodeNext();
  // Gives the decoder what comes next; false when there is nothing more.
  [[nodiscard]] Result<bool> SendNext();
  // The number of the picture in frame_, by its time.
  [[nodiscard]] Result<int> NumberOf(const AVFrame& frame) const;
  // Units of time from the first picture to frame `frame`.
  [[nodiscard]] std::int64_t TimeOf(int frame) const;

  const VideoFile expected_;
  std::unique_ptr<OpenedFile> file_;
  AVStream* stream_ = nullptr;
  AVRational rate_ = {0, 1};  // pictures a second
  CodecContext decoder_;
  Frame frame_;
  Packet packet_;
  std::int64_t first_time_ = 0;
  bool wait_for_key_ = true;
  std::optional<std::int64_t> key_time_;  // of the key picture where decoding began: what is before it does not count
  bool damaged_ = false;                  // something since the last key picture was
  std::optional<int> held_;               // the number of the picture in frame_
  std::optional<int> last_;               // of the one that was decoded last, since the decoder began
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_VIDEO_INPUT_MODULE_AV_VIDEO_READER_H_
