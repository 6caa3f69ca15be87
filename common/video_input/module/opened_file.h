#ifndef DEPTHFARM_COMMON_VIDEO_INPUT_MODULE_OPENED_FILE_H_
#define DEPTHFARM_COMMON_VIDEO_INPUT_MODULE_OPENED_FILE_H_

#include <cstdint>
#include <memory>
#include <string>

#include "common/base/status.h"
#include "common/files/open_file.h"
#include "common/video/handles.h"

namespace depthfarm {

// A container that libav reads through this one open file: whatever the bytes say, no other file and no address is
// opened, and only formats and decoders of the lists in opened_file.cc see them.
class OpenedFile {
 public:
  // Errors, without the path: kUnavailable: it cannot be read; kInvalidArgument: none of those containers.
  [[nodiscard]] static Result<std::unique_ptr<OpenedFile>> Open(const std::string& path);
  OpenedFile(const OpenedFile&) = delete;
  OpenedFile& operator=(const OpenedFile&) = delete;
  ~OpenedFile();

  [[nodiscard]] AVFormatContext* container() const { return container_; }
  // Of the decoders that may be used, for avcodec_open2: libav's names, separated by commas.
  [[nodiscard]] static const char* Decoders();

 private:
  explicit OpenedFile(const std::string& path) : path_(path), file_(OpenToRead(path)) {}
  [[nodiscard]] Status OpenContainer();
  static int Read(void* self, std::uint8_t* buffer, int size);
  static std::int64_t Seek(void* self, std::int64_t offset, int whence);

  const std::string path_;
  const OpenFile file_;
  std::int64_t size_ = 0;
  std::int64_t place_ = 0;
  AVIOContext* input_ = nullptr;
  AVFormatContext* container_ = nullptr;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_VIDEO_INPUT_MODULE_OPENED_FILE_H_
