#ifndef DEPTHFARM_COMMON_VIDEO_INPUT_VIDEO_READERS_H_
#define DEPTHFARM_COMMON_VIDEO_INPUT_VIDEO_READERS_H_

#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "common/base/status.h"
#include "common/video_input/video_reader.h"

namespace depthfarm {

// Videos that stay open from one frame to the next: a picture that is not coded alone needs those before it. Bounded by
// the pictures that idle readers hold (kIdleBytes, seven a reader); the ones unused for longest are closed.
// Thread-safe; two threads that read one video have a reader each.
class VideoReaders {
 public:
  static constexpr std::uint64_t kIdleBytes = 512ULL << 20U;

  // One picture. Errors: those of OpenVideo and VideoReader::Read, beginning with the path. A file that was replaced is
  // opened anew.
  [[nodiscard]] Result<PictureBytes> Read(const VideoFile& file, int frame);

  [[nodiscard]] int num_idle() const;

 private:
  struct Idle {
    VideoFile file;
    std::string state;  // of the file: which one it is, and when it was changed
    std::unique_ptr<VideoReader> reader;
    std::uint64_t bytes = 0;
  };
  [[nodiscard]] std::unique_ptr<VideoReader> Take(const VideoFile& file, const std::string& state);
  void Keep(Idle idle);

  mutable std::mutex mutex_;
  std::list<Idle> idle_;  // the one used last in front
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_VIDEO_INPUT_VIDEO_READERS_H_
