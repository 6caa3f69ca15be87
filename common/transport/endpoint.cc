#include "common/transport/endpoint.h"

#include <arpa/inet.h>

#include <algorithm>
#include <charconv>

namespace depthfarm {
namespace {

constexpr std::string_view kTcp = "tcp://";
constexpr std::string_view kIpc = "ipc://";
constexpr std::size_t kMaxIpcPath = 107;  // sun_path of sockaddr_un, less its end

bool IsPort(std::string_view text) {
  int port = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  return text == "*" || (error == std::errc() && end == text.data() + text.size() && port >= 1 && port <= 65535);
}

bool HasControlOrSpace(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) <= 0x20 || c == 0x7f; });
}

}  // namespace

bool Endpoint::IsLoopback() const {
  if (kind == Kind::kIpc || host == "localhost") return true;
  in_addr address{};
  if (inet_pton(AF_INET, host.c_str(), &address) == 1) return (ntohl(address.s_addr) >> 24U) == 127;
  in6_addr address6{};
  if (!host.starts_with('[') || !host.ends_with(']')) return false;
  if (inet_pton(AF_INET6, host.substr(1, host.size() - 2).c_str(), &address6) != 1) return false;
  // A socket that takes both families reports 127.0.0.1 as ::ffff:127.0.0.1.
  return IN6_IS_ADDR_LOOPBACK(&address6) || (IN6_IS_ADDR_V4MAPPED(&address6) && address6.s6_addr[12] == 127);
}

std::string Endpoint::ToString() const {
  if (kind == Kind::kIpc) return std::string(kIpc) + path;
  return std::string(kTcp) + host + ":" + port;
}

Result<Endpoint> ParseEndpoint(std::string_view text) {
  Endpoint endpoint;
  const std::string quoted = "endpoint is '" + std::string(text) + "'";
  if (text.starts_with(kIpc)) {
    endpoint.kind = Endpoint::Kind::kIpc;
    endpoint.path = text.substr(kIpc.size());
    if (endpoint.path.empty() || endpoint.path.find('\0') != std::string::npos) {
      return InvalidArgument(quoted + ", expected a path after ipc://");
    }
    if (endpoint.path.size() > kMaxIpcPath) {
      return InvalidArgument(quoted + ": the path has " + std::to_string(endpoint.path.size()) +
                             " bytes, a socket takes at most " + std::to_string(kMaxIpcPath));
    }
    return endpoint;
  }
  const std::size_t colon = text.rfind(':');
  if (!text.starts_with(kTcp) || colon < kTcp.size()) {
    return InvalidArgument(quoted + ", expected tcp://HOST:PORT or ipc://PATH");
  }
  endpoint.host = text.substr(kTcp.size(), colon - kTcp.size());
  endpoint.port = text.substr(colon + 1);
  const bool bare_ipv6 = endpoint.host.find(':') != std::string::npos && !endpoint.host.starts_with('[');
  if (endpoint.host.empty() || bare_ipv6 || HasControlOrSpace(endpoint.host)) {
    return InvalidArgument(quoted + ", expected a host name, an address, [IPv6] or * before the port");
  }
  if (!IsPort(endpoint.port)) return InvalidArgument(quoted + ", expected a port from 1 to 65535, or *");
  return endpoint;
}

Status CheckSecurity(const Endpoint& endpoint, bool has_keys, bool insecure) {
  if (endpoint.kind == Endpoint::Kind::kIpc || has_keys) return {};
  if (!insecure) {
    return InvalidArgument(endpoint.ToString() +
                           " needs keys: give --keys DIR (made by 'depthfarm keygen'), or --insecure " +
                           "on a loopback address");
  }
  if (!endpoint.IsLoopback()) {
    return InvalidArgument(endpoint.ToString() +
                           " is not a loopback address: --insecure is refused there, use --keys DIR");
  }
  return {};
}

}  // namespace depthfarm
