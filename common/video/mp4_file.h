#ifndef DEPTHFARM_COMMON_VIDEO_MP4_FILE_H_
#define DEPTHFARM_COMMON_VIDEO_MP4_FILE_H_

#include <memory>
#include <string>
#include <string_view>

#include "common/base/status.h"

namespace depthfarm {

// A video to look at: H.264 (libx264, visually lossless) in mp4. Written under another name, renamed when complete.
class Mp4File {
 public:
  // Pictures of `width` x `height` (even, at least 16), planar 4:2:0 of 8 bits, BT.601, 16-235.
  // Errors  kInvalidArgument: sizes; kUnavailable: the file cannot be written, or there is no encoder in this libav.
  [[nodiscard]] static Result<Mp4File> Create(const std::string& path, int width, int height, int frames_per_second);

  Mp4File(Mp4File&&) noexcept;
  Mp4File& operator=(Mp4File&&) noexcept;
  ~Mp4File();  // without Finish(): nothing is left behind

  [[nodiscard]] Status Put(std::string_view picture);
  [[nodiscard]] Status Finish();

 private:
  struct Stream;
  explicit Mp4File(std::unique_ptr<Stream> stream);
  std::unique_ptr<Stream> stream_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_VIDEO_MP4_FILE_H_
