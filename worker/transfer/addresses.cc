#include "worker/transfer/addresses.h"

#include <filesystem>

namespace depthfarm {

std::string DefaultArtifactEndpoint(const Endpoint& coordinator, const std::string& unique) {
  if (coordinator.kind == Endpoint::Kind::kIpc) {
    const std::filesystem::path folder = std::filesystem::path(coordinator.path).parent_path();
    return "ipc://" + (folder / ("artifacts-" + unique)).string();
  }
  return coordinator.IsLoopback() ? "tcp://127.0.0.1:*" : "tcp://*:*";
}

Result<std::string> AdvertisedEndpoint(const Endpoint& listen, const std::string& bound, const std::string& host,
                                       bool host_was_named) {
  DEPTHFARM_ASSIGN_OR_RETURN(Endpoint endpoint, ParseEndpoint(bound));
  if (endpoint.kind == Endpoint::Kind::kIpc) return bound;
  const bool everywhere = listen.host == "*" || listen.host == "0.0.0.0" || listen.host == "[::]";
  endpoint.host = everywhere || host_was_named ? host : listen.host;
  return endpoint.ToString();
}

}  // namespace depthfarm
