#ifndef DEPTHFARM_WORKER_MEDIA_CLI_PICTURE_SINK_H_
#define DEPTHFARM_WORKER_MEDIA_CLI_PICTURE_SINK_H_

#include <memory>
#include <string>

#include "common/base/status.h"
#include "common/image/picture.h"

namespace depthfarm {

// Where rendered pictures go. Encode may be called from several threads at once, Write and Finish in order from one.
class PictureSink {
 public:
  virtual ~PictureSink() = default;
  PictureSink() = default;
  PictureSink(const PictureSink&) = delete;
  PictureSink& operator=(const PictureSink&) = delete;

  // The bytes that Write takes.
  [[nodiscard]] virtual Result<std::string> Encode(const YcbcrImage& picture) const = 0;
  // kUnavailable: they cannot be written.
  [[nodiscard]] virtual Status Write(int number, const std::string& bytes) = 0;
  // Makes what was written appear under its name; without it, nothing half-written is left.
  [[nodiscard]] virtual Status Finish() = 0;
};

struct PictureSinkFormat {
  int width = 0;   // pixels
  int height = 0;  // pixels
  int frames_per_second = 25;
};

// FILE.mp4: a video (Mp4File; of odd sides the last column or row is left out); FILE.yuv: one file of planar 4:2:0
// pictures; anything else: a folder of PNG pictures named by number, each appearing when it is written.
// kInvalidArgument: another ending that names a file of video; kUnavailable: it cannot be made.
[[nodiscard]] Result<std::unique_ptr<PictureSink>> OpenPictureSink(const std::string& output,
                                                                   const PictureSinkFormat& format);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_MEDIA_CLI_PICTURE_SINK_H_
