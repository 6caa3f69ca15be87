#include "common/transport/context.h"

#include <utility>

#include "common/transport/context_state.h"

namespace depthfarm {

TransportContext::TransportContext() : state_(std::make_unique<State>()) {}
TransportContext::~TransportContext() = default;

Status TransportContext::Authenticate(AllowedKeys allowed) {
  if (state_->authenticator) return Internal("the transport context authenticates already");
  DEPTHFARM_ASSIGN_OR_RETURN(state_->authenticator, Authenticator::Start(state_->zmq, std::move(allowed)));
  return {};
}

}  // namespace depthfarm
