#include "common/job/virtual_picture.h"

#include "common/sequence/frame_name.h"
#include "common/sequence/output_layout.h"

namespace depthfarm {

std::string ViewFileName(int number) { return std::string(kViewsFolder) + "/" + FrameName(number) + ".png"; }

}  // namespace depthfarm
