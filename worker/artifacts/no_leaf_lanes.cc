#include "worker/artifacts/leaf_lanes.h"

namespace depthfarm {

bool AppendInLanes(std::string_view, std::string&) { return false; }

}  // namespace depthfarm
