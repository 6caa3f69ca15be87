#ifndef DEPTHFARM_COMMON_VIDEO_INPUT_VIDEO_READER_H_
#define DEPTHFARM_COMMON_VIDEO_INPUT_VIDEO_READER_H_

#include <string>

#include "common/base/status.h"
#include "common/sequence/picture_format.h"
#include "common/sequence/sequence.h"

namespace depthfarm {

// A coded video (PictureFormat::Kind::kVideo) of one camera.
struct VideoFile {
  std::string path;
  PictureFormat format;
  int width = 0;  // of its pictures, the camera's
  int height = 0;
  int frames = 0;  // that it must have; 0: not known. Checked against what the container tells, so that a job does not
                   // find out at its last frame
};

// Pictures of a video by their number, at the bits that are coded. The same bytes in whatever order they are asked for;
// one after the other is fastest. Frame f is the picture f / rate after the first one, so that a gap is not closed up.
class VideoReader {
 public:
  VideoReader() = default;
  VideoReader(const VideoReader&) = delete;
  VideoReader& operator=(const VideoReader&) = delete;
  virtual ~VideoReader() = default;

  // One picture as planes (raw kinds), range and matrix as the stream has them or, where PictureFormat::colour_said,
  // the sequence; of a stream that does not tell, limited range and BT.601.
  // Errors (kInvalidArgument, without the path): there is no such frame, it or one that it needs is damaged, as far as
  // its decoder notices; the time of pictures is uneven; interlaced, of another size or of samples or a matrix that
  // cannot be used. kUnavailable: the file cannot be read.
  [[nodiscard]] virtual Result<PictureBytes> Read(int frame) = 0;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_VIDEO_INPUT_VIDEO_READER_H_
