#ifndef DEPTHFARM_COMMON_BASE_HOST_NAME_H_
#define DEPTHFARM_COMMON_BASE_HOST_NAME_H_

#include <string>

namespace depthfarm {

// This host's own name, as other hosts are expected to know it; "localhost" when it has none.
[[nodiscard]] std::string HostName();

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_BASE_HOST_NAME_H_
