#include "common/video_input/module/av_video_reader.h"

extern "C" {
#include <libavutil/log.h>
#include <libavutil/mathematics.h>
#include <libavutil/mem.h>
}

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "common/video_input/module/picture_planes.h"

namespace depthfarm {
namespace {

constexpr int kGoOn = 48;  // frames that are rather decoded in between than jumped over
constexpr int kEnoughTries = 3;
// Of a piece of memory that libav takes: tables are as long as the file says. A plane of 8192x8192 has half of it.
constexpr std::size_t kMostBytesAtOnce = (std::size_t{256} << 20) - 1;  // the fuzzer's bound
constexpr int kMostErrors = 1000;                                       // of a decoder that does not come to an end
constexpr int kMostFrames = 10'000'000;
constexpr double kUneven = 0.25;  // of the time between pictures
constexpr int kMostTries = 6;     // ever farther back, before all is decoded from the beginning
constexpr double kFirstSecondsBack = 1;

// Bounds within which no product or sum of times overflows.
constexpr std::int64_t kLatestTime = std::int64_t{1} << 53;
bool IsWithin(AVRational value, double least, double most) {
  return value.num > 0 && value.den > 0 && av_q2d(value) >= least && av_q2d(value) <= most;
}
bool IsRate(AVRational rate) { return IsWithin(rate, 0.01, 10000); }
bool IsUnitOfTime(AVRational seconds) { return IsWithin(seconds, 1e-9, 1); }

// Pictures a second. libav finds a rate that fits all times; of some streams it is that of fields.
AVRational RateOf(const AVStream& stream) {
  const AVRational fits = stream.r_frame_rate;
  const AVRational mean = stream.avg_frame_rate;
  if (!IsRate(fits)) return mean;
  return IsRate(mean) && av_q2d(fits) > 1.5 * av_q2d(mean) ? mean : fits;
}

Status NoFrame(int frame, const std::string& why) {
  return InvalidArgument("has no picture for frame " + std::to_string(frame) + ": " + why);
}

Status Damaged(int frame) {
  return InvalidArgument("is damaged at frame " + std::to_string(frame) +
                         " or before (ffmpeg -v error -i FILE -f null - tells more): replace it, or encode it anew");
}

}  // namespace

Result<std::unique_ptr<VideoReader>> AvVideoReader::Open(const VideoFile& file) {
  av_log_set_level(AV_LOG_QUIET);  // what is wrong is in the errors
  av_max_alloc(kMostBytesAtOnce);
  std::unique_ptr<AvVideoReader> reader(new AvVideoReader(file));
  DEPTHFARM_RETURN_IF_ERROR(reader->Begin());
  return std::unique_ptr<VideoReader>(std::move(reader));
}

Status AvVideoReader::Begin() {
  DEPTHFARM_ASSIGN_OR_RETURN(file_, OpenedFile::Open(expected_.path));
  DEPTHFARM_RETURN_IF_ERROR(OpenDecoder());
  DEPTHFARM_ASSIGN_OR_RETURN(const bool any, DecodeNext());
  if (!any) return InvalidArgument("has no picture that can be decoded");
  first_time_ = frame_->best_effort_timestamp;
  if (first_time_ == AV_NOPTS_VALUE || std::abs(first_time_) > kLatestTime || !IsRate(rate_) ||
      !IsUnitOfTime(stream_->time_base)) {
    return InvalidArgument("does not tell the times of its pictures: put it into mp4 or mkv");
  }
  held_ = last_ = 0;
  return CheckLength();
}

std::optional<double> AvVideoReader::ToldFrames() const {
  const AVFormatContext& container = *file_->container();
  double seconds = 0;
  if (stream_->duration != AV_NOPTS_VALUE) {
    seconds = static_cast<double>(stream_->duration) * av_q2d(stream_->time_base);
  } else if (container.duration != AV_NOPTS_VALUE &&
             container.duration_estimation_method == AVFMT_DURATION_FROM_STREAM) {  // mkv's header
    seconds = static_cast<double>(container.duration) / AV_TIME_BASE;
  } else {
    return std::nullopt;
  }
  return std::max(std::round(seconds * av_q2d(rate_)), static_cast<double>(stream_->nb_frames));
}

Status AvVideoReader::CheckLength() const {
  const std::optional<double> told = ToldFrames();
  const double doubt = stream_->nb_frames > 0 ? 0 : 1;  // mov and mp4 are exact
  if (!told || *told + doubt >= expected_.frames) return {};
  return InvalidArgument("has " + std::to_string(std::llround(*told)) + " of " + std::to_string(expected_.frames) +
                         " expected frames");
}

Status AvVideoReader::OpenDecoder() {
  AVFormatContext* container = file_->container();
  const AVCodec* codec = nullptr;
  const int index = av_find_best_stream(container, AVMEDIA_TYPE_VIDEO, -1, -1, &codec, 0);
  if (index < 0 || codec == nullptr)
    return InvalidArgument(AvFailure("has no video that can be decoded", index).message());
  for (unsigned i = 0; i < container->nb_streams; ++i)
    container->streams[i]->discard = static_cast<int>(i) == index ? AVDISCARD_DEFAULT : AVDISCARD_ALL;
  stream_ = container->streams[index];
  rate_ = RateOf(*stream_);
  decoder_.reset(avcodec_alloc_context3(codec));
  frame_.reset(av_frame_alloc());
  packet_.reset(av_packet_alloc());
  if (decoder_ == nullptr || frame_ == nullptr || packet_ == nullptr) return Unavailable("no memory for a video");
  int error = avcodec_parameters_to_context(decoder_.get(), stream_->codecpar);
  decoder_->pkt_timebase = stream_->time_base;
  decoder_->thread_count = 1;  // tasks are what runs beside each other
  decoder_->flags |= AV_CODEC_FLAG_BITEXACT;
  decoder_->err_recognition = AV_EF_CRCCHECK | AV_EF_EXPLODE;  // else what is damaged is made up from around it
  // Coded sides are whole blocks, some decoders add edges. What is far larger than the camera is refused before memory
  // is taken for it.
  decoder_->max_pixels = std::int64_t{4} * (expected_.width + 128) * (expected_.height + 128);
  decoder_->codec_whitelist = av_strdup(OpenedFile::Decoders());
  if (error >= 0) error = avcodec_open2(decoder_.get(), codec, nullptr);
  wait_for_key_ = true;
  key_time_.reset();
  damaged_ = false;
  held_.reset();
  last_.reset();
  if (error >= 0) return {};
  return InvalidArgument(AvFailure(std::string("cannot be decoded (") + codec->name + ")", error).message());
}

std::int64_t AvVideoReader::TimeOf(int frame) const { return av_rescale_q(frame, av_inv_q(rate_), stream_->time_base); }

Status AvVideoReader::GoTo(int frame, std::int64_t back) {
  const std::int64_t time = first_time_ + TimeOf(frame) - back;
  if (time <= first_time_) return Begin();
  if (av_seek_frame(file_->container(), stream_->index, time, AVSEEK_FLAG_BACKWARD) < 0) return Begin();
  avcodec_flush_buffers(decoder_.get());
  wait_for_key_ = true;
  key_time_.reset();
  damaged_ = false;
  held_.reset();
  last_.reset();
  return {};
}

Result<bool> AvVideoReader::SendNext() {
  for (;;) {
    av_packet_unref(packet_.get());
    const int read = av_read_frame(file_->container(), packet_.get());
    if (read == AVERROR(EIO)) return Unavailable("cannot be read: an error of the disk or the network");
    if (read < 0) {  // the end, or damaged from here on: the decoder gives what it still has
      if (read != AVERROR_EOF) damaged_ = true;
      return avcodec_send_packet(decoder_.get(), nullptr) >= 0;
    }
    if (packet_->stream_index != stream_->index) continue;
    const bool key = (packet_->flags & AV_PKT_FLAG_KEY) != 0;
    if (wait_for_key_ && !key) continue;
    const std::int64_t time = packet_->pts != AV_NOPTS_VALUE ? packet_->pts : packet_->dts;
    if (wait_for_key_ && time != AV_NOPTS_VALUE) key_time_ = time;
    wait_for_key_ = false;
    const int sent = avcodec_send_packet(decoder_.get(), packet_.get());
    // What is shown before the key picture may refer to what was not decoded.
    if (sent < 0 && (!key_time_ || time >= *key_time_)) damaged_ = true;
    return true;
  }
}

Result<bool> AvVideoReader::DecodeNext() {
  held_.reset();
  int errors = 0;
  for (;;) {
    const int received = avcodec_receive_frame(decoder_.get(), frame_.get());
    if (received == AVERROR_EOF) return false;
    if (received == AVERROR(EAGAIN)) {
      DEPTHFARM_ASSIGN_OR_RETURN(const bool sent, SendNext());
      if (!sent) return false;
      continue;
    }
    if (received < 0) {
      damaged_ = true;
      if (++errors > kMostErrors) return false;
      continue;
    }
    const std::int64_t time = frame_->best_effort_timestamp;
    if (key_time_ && time != AV_NOPTS_VALUE && time < *key_time_) continue;
    if (frame_->key_frame != 0) damaged_ = false;
    if ((frame_->flags & AV_FRAME_FLAG_CORRUPT) != 0 || frame_->decode_error_flags != 0) damaged_ = true;
    return true;
  }
}

Result<int> AvVideoReader::NumberOf(const AVFrame& frame) const {
  if (frame.best_effort_timestamp == AV_NOPTS_VALUE) {  // as the last one of MPEG-4 in avi
    if (last_) return *last_ + 1;
    return InvalidArgument("has a picture without a time");
  }
  const double time = static_cast<double>(frame.best_effort_timestamp) - static_cast<double>(first_time_);
  const double place = time * av_q2d(stream_->time_base) * av_q2d(rate_);
  const double number = std::round(place);
  if (!(number >= 0 && number < 1e9) || std::abs(place - number) > kUneven) {
    return InvalidArgument("the time between its pictures varies (" + std::to_string(av_q2d(rate_)) +
                           " a second are told): make it even, e.g. with ffmpeg -vf fps");
  }
  return static_cast<int>(number);
}

Result<PictureBytes> AvVideoReader::Read(int frame) {
  if (frame < 0 || frame > kMostFrames) return NoFrame(frame, "that is beyond any video");
  if (const std::optional<double> told = ToldFrames(); told && frame > *told) return NoFrame(frame, "it ends before");
  bool from_the_beginning = false;
  int tries = 0;
  const auto go_back = [&]() -> Status {
    // The container's index may be of decoding times, or coarse: ever farther back, at last all of it.
    const auto back = tries == 0 ? 0.0 : kFirstSecondsBack * (1 << (tries - 1)) / av_q2d(stream_->time_base);
    from_the_beginning = tries++ == kMostTries || TimeOf(frame) <= static_cast<std::int64_t>(back);
    return from_the_beginning ? Begin() : GoTo(frame, static_cast<std::int64_t>(back));
  };
  if (!held_ || frame < *held_ || frame > *held_ + kGoOn) DEPTHFARM_RETURN_IF_ERROR(go_back());
  // H.264's decoder gives the last pictures only where it began farther back, when pictures before the key one refer to
  // what is missing: once is not enough to say that there is none.
  int passed = 0;  // how often it was missing after a picture before it
  bool before = false;
  for (;;) {
    if (held_ && *held_ == frame) {
      // Where no picture is coded alone but each a part of it, it is whole only some time after it can be decoded.
      if (!damaged_) return PlanesOf(*frame_, expected_);
      if (from_the_beginning) return Damaged(frame);
      DEPTHFARM_RETURN_IF_ERROR(go_back());
      before = false;
      continue;
    }
    if (!held_ || *held_ < frame) {
      before = before || held_.has_value();
      DEPTHFARM_ASSIGN_OR_RETURN(const bool any, DecodeNext());
      if (any) {
        DEPTHFARM_ASSIGN_OR_RETURN(held_, NumberOf(*frame_));
        last_ = held_;
        continue;
      }
    }
    passed += before ? 1 : 0;
    if (from_the_beginning || passed == kEnoughTries) {
      if (held_) return NoFrame(frame, "there is a gap at that time");
      return NoFrame(frame, damaged_ ? "it is damaged or cut short" : "it ends before");
    }
    DEPTHFARM_RETURN_IF_ERROR(go_back());
    before = false;
  }
}

}  // namespace depthfarm
