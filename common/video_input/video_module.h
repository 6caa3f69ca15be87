#ifndef DEPTHFARM_COMMON_VIDEO_INPUT_VIDEO_MODULE_H_
#define DEPTHFARM_COMMON_VIDEO_INPUT_VIDEO_MODULE_H_

#include <memory>

#include "common/base/status.h"
#include "common/video_input/video_reader.h"

namespace depthfarm {

// libav and what it brings (70 libraries, 50 ms of CPU) are in a module of their own, which is loaded when the first
// video is opened: programs that meet none do not pay for it.

// Loads the module unless it is. For programs that give up the right to open files (ConfineFiles) before they meet a
// video. Errors: kUnavailable: it is not installed beside this program, or of another version.
[[nodiscard]] Status LoadVideoModule();

// Opens a video. Errors, without the path: as LoadVideoModule; kUnavailable: the file is missing or cannot be read;
// kInvalidArgument: it is not of a container or codec that is read here, or has no video.
[[nodiscard]] Result<std::unique_ptr<VideoReader>> OpenVideo(const VideoFile& file);

// What the module has, by this name. `version` is the program's: the module answers kUnavailable to another one.
using OpenVideoFunction = void (*)(const char* version, const VideoFile* file,
                                   Result<std::unique_ptr<VideoReader>>* reader);
inline constexpr const char* kOpenVideoName = "DepthfarmOpenVideo";

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_VIDEO_INPUT_VIDEO_MODULE_H_
