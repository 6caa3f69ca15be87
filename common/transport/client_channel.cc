#include "common/transport/client_channel.h"

#include <array>
#include <cerrno>
#include <utility>

#include "common/transport/context_state.h"
#include "common/transport/endpoint.h"
#include "common/transport/socket.h"

namespace depthfarm {
namespace {

// True when a message waits; false after `timeout` or a signal.
bool WaitReadable(zmq::socket_t& socket, std::chrono::milliseconds timeout) {
  std::array<zmq::pollitem_t, 1> items{{{socket.handle(), 0, ZMQ_POLLIN, 0}}};
  try {
    return zmq::poll(items, timeout) > 0;
  } catch (const zmq::error_t& error) {
    if (error.num() == EINTR) return false;
    throw;
  }
}

}  // namespace

struct ReceivedMessage::State {
  zmq::message_t payload;
  zmq::message_t attachment;
  int frames = 0;
};

ReceivedMessage::ReceivedMessage() : state_(std::make_unique<State>()) {}
ReceivedMessage::ReceivedMessage(ReceivedMessage&& other) noexcept = default;
ReceivedMessage& ReceivedMessage::operator=(ReceivedMessage&& other) noexcept = default;
ReceivedMessage::~ReceivedMessage() = default;

std::string_view ReceivedMessage::payload() const { return state_->payload.to_string_view(); }
std::string_view ReceivedMessage::attachment() const { return state_->attachment.to_string_view(); }

struct ClientChannel::State {
  zmq::socket_t socket;
  std::string endpoint;
};

ClientChannel::ClientChannel() : state_(std::make_unique<State>()) {}
ClientChannel::~ClientChannel() = default;

Result<std::unique_ptr<ClientChannel>> ClientChannel::Connect(TransportContext& context, const std::string& endpoint,
                                                              const ClientOptions& options) {
  DEPTHFARM_RETURN_IF_ERROR(ParseEndpoint(endpoint).status());
  const bool curve = !options.curve_server_public_key.empty();
  if (curve && !(IsCurveKey(options.curve_server_public_key) && IsCurveKey(options.curve_own.public_key) &&
                 IsCurveKey(options.curve_own.secret_key))) {
    return InvalidArgument("the keys for " + endpoint + " are no CURVE keys");
  }
  try {
    std::unique_ptr<ClientChannel> channel(new ClientChannel);
    channel->state_->endpoint = endpoint;
    zmq::socket_t& socket = channel->state_->socket;
    socket = zmq::socket_t(context.state().zmq, zmq::socket_type::dealer);
    SetCommonOptions(socket, options.max_message_bytes, options.linger);
    if (curve) {
      socket.set(zmq::sockopt::curve_serverkey, options.curve_server_public_key);
      socket.set(zmq::sockopt::curve_publickey, options.curve_own.public_key);
      socket.set(zmq::sockopt::curve_secretkey, options.curve_own.secret_key);
    }
    socket.connect(endpoint);
    return channel;
  } catch (const zmq::error_t& error) {
    return SocketFailure("connect to", endpoint, error);
  }
}

const std::string& ClientChannel::endpoint() const { return state_->endpoint; }

Status ClientChannel::Send(std::string_view payload) {
  try {
    if (!state_->socket.send(zmq::buffer(payload), zmq::send_flags::dontwait)) {
      return Unavailable("the queue to " + state_->endpoint + " is full");
    }
    return {};
  } catch (const zmq::error_t& error) {
    return SocketFailure("send to", state_->endpoint, error);
  }
}

Result<std::optional<std::string>> ClientChannel::Receive(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
    DEPTHFARM_ASSIGN_OR_RETURN(const std::optional<ReceivedMessage> message, ReceiveAttached(left));
    if (!message.has_value()) return std::optional<std::string>();
    if (message->state_->frames == 1) return std::optional<std::string>(message->payload());
  }
}

Result<std::optional<ReceivedMessage>> ClientChannel::ReceiveAttached(std::chrono::milliseconds timeout) {
  zmq::socket_t& socket = state_->socket;
  try {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    for (;;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - std::chrono::steady_clock::now());
      if (left.count() > 0) WaitReadable(socket, left);
      ReceivedMessage message;
      ReceivedMessage::State& state = *message.state_;
      if (!socket.recv(state.payload, zmq::recv_flags::dontwait)) {
        if (left.count() > 0) continue;
        return std::optional<ReceivedMessage>();
      }
      state.frames = 1;
      for (bool more = state.payload.more(); more; ++state.frames) {
        zmq::message_t frame;
        if (!socket.recv(frame)) return Internal("a message ended before its last frame");
        more = frame.more();
        if (state.frames == 1) state.attachment = std::move(frame);
      }
      if (state.frames <= 2) return std::optional<ReceivedMessage>(std::move(message));
    }
  } catch (const zmq::error_t& error) {
    return SocketFailure("receive from", state_->endpoint, error);
  }
}

void* ClientChannel::native_socket() const { return state_->socket.handle(); }

}  // namespace depthfarm
