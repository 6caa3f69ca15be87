#include "worker/service/addresses.h"

#include <filesystem>

namespace depthfarm {

std::string DefaultArtifactEndpoint(const Endpoint& coordinator, const std::string& unique) {
  if (coordinator.kind == Endpoint::Kind::kIpc) {
    const std::filesystem::path folder = std::filesystem::path(coordinator.path).parent_path();
    return "ipc://" + (folder / ("artifacts-" + unique)).string();
  }
  return coordinator.IsLoopback() ? "tcp://127.0.0.1:*" : "tcp://*:*";
}

Result<std::string> AdvertisedEndpoint(const std::string& bound, const std::string& advertised_host, bool always) {
  DEPTHFARM_ASSIGN_OR_RETURN(Endpoint endpoint, ParseEndpoint(bound));
  if (endpoint.kind == Endpoint::Kind::kIpc) return bound;
  const bool everywhere = endpoint.host == "0.0.0.0" || endpoint.host == "*" || endpoint.host == "[::]";
  if (everywhere || always) endpoint.host = advertised_host;
  return endpoint.ToString();
}

}  // namespace depthfarm
