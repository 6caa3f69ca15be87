#include "common/transport/context.h"

#include <utility>

#include "common/transport/context_state.h"

namespace depthfarm {

TransportContext::TransportContext() : state_(std::make_unique<State>()) {}
TransportContext::~TransportContext() = default;

Status TransportContext::Authenticate(AllowedKeys allowed) {
  if (state_->authenticator) return Internal("the transport context authenticates already");
  state_->admitted = std::make_unique<AdmittedKeys>(std::move(allowed));
  DEPTHFARM_ASSIGN_OR_RETURN(state_->authenticator, Authenticator::Start(state_->zmq, *state_->admitted));
  return {};
}

Status TransportContext::Readmit(AllowedKeys allowed) {
  if (!state_->authenticator) return Internal("the transport context does not authenticate");
  state_->admitted->Replace(std::move(allowed));
  return {};
}

}  // namespace depthfarm
