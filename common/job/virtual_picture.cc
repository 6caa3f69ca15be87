#include "common/job/virtual_picture.h"

#include "common/sequence/frame_name.h"

namespace depthfarm {

std::string ViewFileName(int number) { return "views/" + FrameName(number) + ".png"; }

}  // namespace depthfarm
