#ifndef DEPTHFARM_COMMON_TRANSPORT_CONTEXT_STATE_H_
#define DEPTHFARM_COMMON_TRANSPORT_CONTEXT_STATE_H_

#include <memory>
#include <zmq.hpp>

#include "common/transport/admitted_keys.h"
#include "common/transport/authenticator.h"
#include "common/transport/context.h"

namespace depthfarm {

// Internal to transport. The authenticator's thread ends before the context and the list do.
struct TransportContext::State {
  zmq::context_t zmq{1};
  std::unique_ptr<AdmittedKeys> admitted;  // null: no CURVE servers
  std::unique_ptr<Authenticator> authenticator;
};

}  // namespace depthfarm

#endif  // DEPTHFARM_COMMON_TRANSPORT_CONTEXT_STATE_H_
