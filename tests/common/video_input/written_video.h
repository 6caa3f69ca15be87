#ifndef DEPTHFARM_TESTS_COMMON_VIDEO_INPUT_WRITTEN_VIDEO_H_
#define DEPTHFARM_TESTS_COMMON_VIDEO_INPUT_WRITTEN_VIDEO_H_

#include <cstdint>
#include <functional>
#include <map>
#include <string>

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavutil/frame.h>
}

namespace depthfarm::test {

// A video for tests: noise that moves, a different picture each frame.
struct VideoRecipe {
  std::string encoder = "libx264";  // libav's name
  AVPixelFormat samples = AV_PIX_FMT_YUV420P;
  int width = 64;
  int height = 48;
  int frames = 40;
  AVRational rate = {25, 1};
  int key_interval = 12;
  int b_frames = 0;
  std::map<std::string, std::string> options = {};  // of the encoder
  AVColorRange range = AVCOL_RANGE_UNSPECIFIED;
  AVColorSpace matrix = AVCOL_SPC_UNSPECIFIED;
  // Where frame f is shown, in frames; -1: it is left out.
  std::function<int(int)> place = [](int frame) { return frame; };
  bool interlaced = false;
};

// Sample (x, y) of plane `plane` in frame `frame`, of as many bits.
[[nodiscard]] int SampleAt(int plane, int x, int y, int frame, int bits);

// The planes of a frame as files of raw pictures have them.
[[nodiscard]] std::string PlanesOfFrame(const VideoRecipe& recipe, int frame);

// Writes the file; its ending chooses the container.
void WriteVideo(const VideoRecipe& recipe, const std::string& path);

}  // namespace depthfarm::test

#endif  // DEPTHFARM_TESTS_COMMON_VIDEO_INPUT_WRITTEN_VIDEO_H_
