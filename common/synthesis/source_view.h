#ifndef DEPTHFARM_COMMON_SYNTHESIS_SOURCE_VIEW_H_
#define DEPTHFARM_COMMON_SYNTHESIS_SOURCE_VIEW_H_

#include "common/geometry/camera.h"
#include "common/image/picture.h"

namespace depthfarm {

// One real view that a virtual view is made from. The picture and the depth are borrowed and have the camera's size.
struct SourceView {
  const YcbcrImage* picture = nullptr;
  const DepthMap* depth = nullptr;  // own z, 0 = no depth
  Camera camera;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_SYNTHESIS_SOURCE_VIEW_H_
