#ifndef DEPTHFARM_COMMON_TRANSPORT_AUTHENTICATOR_H_
#define DEPTHFARM_COMMON_TRANSPORT_AUTHENTICATOR_H_

#include <memory>
#include <string>
#include <thread>
#include <vector>
#include <zmq.hpp>

#include "common/base/status.h"
#include "common/transport/admitted_keys.h"

namespace depthfarm {

// Internal to transport. Answers ZAP requests (ZeroMQ RFC 27) of one context in a thread of its own: CURVE keys of the
// list get 200, everybody else 400. The user id that the library keeps with a connection is its key: whose key that is,
// and whether it still may come, is looked up for each message.
class Authenticator {
 public:
  // `admitted` must outlive it.
  [[nodiscard]] static Result<std::unique_ptr<Authenticator>> Start(zmq::context_t& context,
                                                                    const AdmittedKeys& admitted);
  ~Authenticator();
  Authenticator(const Authenticator&) = delete;
  Authenticator& operator=(const Authenticator&) = delete;

  // The frames of the answer to the frames of a request; empty for a request that breaks RFC 27.
  [[nodiscard]] static std::vector<std::string> Answer(const std::vector<std::string>& request,
                                                       const AdmittedKeys& admitted);

 private:
  Authenticator() = default;
  static void Serve(zmq::socket_t requests, int stop_fd, const AdmittedKeys& admitted);

  int stop_fd_ = -1;
  std::thread thread_;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_AUTHENTICATOR_H_
