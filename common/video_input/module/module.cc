#include <string>

#include "common/video_input/module/av_video_reader.h"
#include "common/video_input/video_module.h"

extern "C" __attribute__((visibility("default"))) void DepthfarmOpenVideo(
    const char* version, const depthfarm::VideoFile* file,
    depthfarm::Result<std::unique_ptr<depthfarm::VideoReader>>* reader) {
  if (std::string(version) != DEPTHFARM_VERSION) {
    *reader = depthfarm::Unavailable(std::string("the module depthfarm-video.so is of version ") + DEPTHFARM_VERSION +
                                     ", this program of " + version + ": install both of one version");
    return;
  }
  *reader = depthfarm::AvVideoReader::Open(*file);
}
