#ifndef DEPTHFARM_WORKER_TRANSFER_ADDRESSES_H_
#define DEPTHFARM_WORKER_TRANSFER_ADDRESSES_H_

#include <string>

#include "common/base/status.h"
#include "common/transport/endpoint.h"

namespace depthfarm {

// Where the artifact server listens when nothing else is asked for: beside the coordinator's ipc socket, on the
// loopback address when the coordinator is there, else on all addresses; always a free name or port. `unique` tells the
// workers of a machine apart in file names.
[[nodiscard]] std::string DefaultArtifactEndpoint(const Endpoint& coordinator, const std::string& unique);

// What peers are told to connect to: the port that `bound` has in fact, at the host that was asked for in `listen`;
// when that means every address, or when the user named a host to advertise, at `host`.
[[nodiscard]] Result<std::string> AdvertisedEndpoint(const Endpoint& listen, const std::string& bound,
                                                     const std::string& host, bool host_was_named);

}  // namespace depthfarm

#endif  // DEPTHFARM_WORKER_TRANSFER_ADDRESSES_H_
