#ifndef DEPTHFARM_COMMON_TRANSPORT_DESCRIPTOR_LIMIT_H_
#define DEPTHFARM_COMMON_TRANSPORT_DESCRIPTOR_LIMIT_H_

#include <cstdint>

namespace depthfarm {

// Lets this process have as many descriptors as the system allows it (RLIMIT_NOFILE to its hard limit), one a
// connection: the usual 1,024 are soon taken by strangers who connect and say nothing. The limit that holds now.
std::uint64_t RaiseDescriptorLimit();

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_DESCRIPTOR_LIMIT_H_
