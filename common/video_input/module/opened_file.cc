#include "common/video_input/module/opened_file.h"

extern "C" {
#include <libavutil/opt.h>
}

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <span>
#include <system_error>
#include <utility>

namespace depthfarm {
namespace {

constexpr int kBufferBytes = 1 << 20;

// What cameras and studios write. None of these containers names further files (mov does not follow references to them
// unless it is told to).
constexpr const char* kContainers = "mov,matroska,mxf,mpegts,avi,yuv4mpegpipe";
constexpr const char* kDecoders =
    "h264,hevc,libdav1d,vp9,mpeg2video,mpeg4,prores,dnxhd,cfhd,jpeg2000,mjpeg,ffv1,ffvhuff,huffyuv,utvideo,v210,"
    "rawvideo";
constexpr const char* kContainerNames = "mp4, mov, mkv, webm, mxf, ts, avi or y4m";

}  // namespace

const char* OpenedFile::Decoders() { return kDecoders; }

Result<std::unique_ptr<OpenedFile>> OpenedFile::Open(const std::string& path) {
  std::unique_ptr<OpenedFile> opened(new OpenedFile(path));
  if (!opened->file_.ok()) return Unavailable("cannot be opened: " + std::generic_category().message(errno));
  const Result<std::uint64_t> size = SizeOfRegular(path, opened->file_);
  if (!size.ok()) return InvalidArgument("is not a regular file");
  opened->size_ = static_cast<std::int64_t>(*size);
  DEPTHFARM_RETURN_IF_ERROR(opened->OpenContainer());
  return opened;
}

Status OpenedFile::OpenContainer() {
  auto* buffer = static_cast<unsigned char*>(av_malloc(kBufferBytes));
  input_ = avio_alloc_context(buffer, kBufferBytes, 0, this, &OpenedFile::Read, nullptr, &OpenedFile::Seek);
  container_ = avformat_alloc_context();
  if (buffer == nullptr || input_ == nullptr || container_ == nullptr) return Unavailable("no memory for a video");
  container_->pb = input_;
  AVDictionary* options = nullptr;
  for (const auto& [name, value] : std::array<std::pair<const char*, const char*>, 3>{
           {{"format_whitelist", kContainers}, {"codec_whitelist", kDecoders}, {"protocol_whitelist", ""}}})
    av_dict_set(&options, name, value, 0);
  int error = avformat_open_input(&container_, nullptr, nullptr, &options);  // frees the container where it fails
  av_dict_free(&options);
  if (error >= 0) error = avformat_find_stream_info(container_, nullptr);
  if (error >= 0) return {};
  return InvalidArgument(
      AvFailure(std::string("is no video of a kind that can be read (") + kContainerNames + ")", error).message());
}

OpenedFile::~OpenedFile() {
  avformat_close_input(&container_);
  if (input_ != nullptr) av_freep(static_cast<void*>(&input_->buffer));
  avio_context_free(&input_);
}

int OpenedFile::Read(void* self, std::uint8_t* buffer, int size) {
  OpenedFile& file = *static_cast<OpenedFile*>(self);
  const std::span<char> room(reinterpret_cast<char*>(buffer), static_cast<std::size_t>(size));
  const Result<std::size_t> read = ReadUpTo(file.path_, file.file_, static_cast<std::uint64_t>(file.place_), room);
  if (!read.ok()) return AVERROR(EIO);
  if (*read == 0) return AVERROR_EOF;
  file.place_ += static_cast<std::int64_t>(*read);
  return static_cast<int>(*read);
}

std::int64_t OpenedFile::Seek(void* self, std::int64_t offset, int whence) {
  OpenedFile& file = *static_cast<OpenedFile*>(self);
  switch (whence & ~AVSEEK_FORCE) {
    case AVSEEK_SIZE:
      return file.size_;
    case SEEK_SET:
      break;
    case SEEK_CUR:
      offset += file.place_;
      break;
    case SEEK_END:
      offset += file.size_;
      break;
    default:
      return AVERROR(EINVAL);
  }
  if (offset < 0) return AVERROR(EINVAL);
  file.place_ = offset;
  return offset;
}

}  // namespace depthfarm
