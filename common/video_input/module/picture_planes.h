#ifndef DEPTHFARM_COMMON_VIDEO_INPUT_MODULE_PICTURE_PLANES_H_
#define DEPTHFARM_COMMON_VIDEO_INPUT_MODULE_PICTURE_PLANES_H_

#include "common/base/status.h"
#include "common/video/handles.h"
#include "common/video_input/video_reader.h"

namespace depthfarm {

// The planes of a decoded picture without what lies between their rows, and what they are. `file`: what is expected.
// Alpha is left out. Errors: those of VideoReader::Read that are of one picture.
[[nodiscard]] Result<PictureBytes> PlanesOf(const AVFrame& frame, const VideoFile& file);

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_VIDEO_INPUT_MODULE_PICTURE_PLANES_H_
