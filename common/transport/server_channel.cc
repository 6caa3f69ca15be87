#include "common/transport/server_channel.h"

#include <utility>

#include "common/transport/context_state.h"
#include "common/transport/endpoint.h"
#include "common/transport/handshake_monitor.h"
#include "common/transport/keys.h"
#include "common/transport/socket.h"

namespace depthfarm {
namespace {

// In a row, before the caller gets its turn: a flood of what is skipped must not keep it from its other work.
constexpr int kMostSkipped = 1000;

// A frame of the bytes where they are, which the library lets go when it has left.
zmq::message_t FrameOf(SharedBytes bytes) {
  auto owned = std::make_unique<SharedBytes>(std::move(bytes));
  // The library changes no frame that it sends.
  zmq::message_t frame(
      const_cast<char*>(owned->view().data()), owned->size(),
      [](void*, void* hint) { delete static_cast<SharedBytes*>(hint); }, owned.get());
  (void)owned.release();
  return frame;
}

constexpr auto kMoreAtOnce = zmq::send_flags::sndmore | zmq::send_flags::dontwait;

// False when the peer's queue is full.
bool BeginMessage(zmq::socket_t& socket, std::string_view peer) {
  if (socket.send(zmq::buffer(peer), kMoreAtOnce)) return true;
  // Of what a peer has read the library takes note once in some milliseconds, or when it is asked for events: more
  // messages than the queue holds may have been sent and read since.
  (void)socket.get(zmq::sockopt::events);
  return socket.send(zmq::buffer(peer), kMoreAtOnce).has_value();
}

}  // namespace

struct ServerChannel::State {
  zmq::socket_t socket;
  std::string endpoint;
  const AdmittedKeys* admitted = nullptr;        // null: no CURVE
  std::unique_ptr<HandshakeMonitor> handshakes;  // same; ends before the socket
  std::uint64_t removed_key = 0;                 // messages that were skipped
  std::uint64_t wrong_frames = 0;                // same
};

ServerChannel::ServerChannel() : state_(std::make_unique<State>()) {}
ServerChannel::~ServerChannel() = default;

Result<std::unique_ptr<ServerChannel>> ServerChannel::Bind(TransportContext& context, const std::string& endpoint,
                                                           const ServerOptions& options) {
  DEPTHFARM_RETURN_IF_ERROR(ParseEndpoint(endpoint).status());
  const bool curve = !options.curve_secret_key.empty();
  if (curve && !IsCurveKey(options.curve_secret_key)) return InvalidArgument("the server's secret key is no CURVE key");
  if (curve && !context.state().authenticator)
    return Internal("a CURVE server needs Authenticate first");  // else libzmq admits all
  try {
    std::unique_ptr<ServerChannel> channel(new ServerChannel);
    zmq::socket_t& socket = channel->state_->socket;
    socket = zmq::socket_t(context.state().zmq, zmq::socket_type::router);
    SetCommonOptions(socket, options.max_message_bytes, options.linger);
    socket.set(zmq::sockopt::sndhwm, options.max_queued_messages);
    socket.set(zmq::sockopt::router_mandatory, 1);
    if (curve) {
      channel->state_->admitted = context.state().admitted.get();
      channel->state_->handshakes = std::make_unique<HandshakeMonitor>(context.state().zmq, socket);
      socket.set(zmq::sockopt::curve_server, 1);
      socket.set(zmq::sockopt::curve_secretkey, options.curve_secret_key);
      socket.set(zmq::sockopt::zap_domain, "depthfarm");
    }
    socket.bind(endpoint);
    channel->state_->endpoint = socket.get(zmq::sockopt::last_endpoint);
    return channel;
  } catch (const zmq::error_t& error) {
    return SocketFailure("listen on", endpoint, error);
  }
}

const std::string& ServerChannel::endpoint() const { return state_->endpoint; }

Result<std::optional<PeerMessage>> ServerChannel::Receive() {
  zmq::socket_t& socket = state_->socket;
  try {
    for (int skipped = 0; skipped < kMostSkipped; ++skipped) {
      zmq::message_t peer;
      if (!socket.recv(peer, zmq::recv_flags::dontwait)) return std::optional<PeerMessage>();
      zmq::message_t payload;
      int frames = 0;
      for (bool more = peer.more(); more; ++frames) {
        zmq::message_t frame;
        if (!socket.recv(frame)) return Internal("a message ended before its last frame");
        more = frame.more();
        if (frames == 0) payload = std::move(frame);
      }
      if (frames != 1) {
        ++state_->wrong_frames;
        continue;
      }
      PeerMessage message{peer.to_string(), "", payload.to_string()};
      if (state_->admitted != nullptr) {
        // As the authenticator gave it: what a peer says of itself does not replace it.
        if (const char* key = zmq_msg_gets(payload.handle(), "User-Id")) message.key = key;
        std::optional<std::string> user = state_->admitted->UserOf(message.key);
        if (!user) {
          ++state_->removed_key;
          continue;
        }
        message.user_id = *std::move(user);
      }
      return std::optional<PeerMessage>(std::move(message));
    }
    return std::optional<PeerMessage>();
  } catch (const zmq::error_t& error) {
    return SocketFailure("receive on", state_->endpoint, error);
  }
}

Status ServerChannel::Send(std::string_view peer, std::string_view payload) {
  zmq::socket_t& socket = state_->socket;
  try {
    if (!BeginMessage(socket, peer)) return Unavailable("the peer's queue is full");
    // After the first frame was taken the rest of the message is: ROUTER has chosen and checked the pipe.
    socket.send(zmq::buffer(payload), zmq::send_flags::dontwait);
    return {};
  } catch (const zmq::error_t& error) {
    return SocketFailure("send on", state_->endpoint, error);
  }
}

Status ServerChannel::Send(std::string_view peer, std::string_view payload, SharedBytes attachment) {
  zmq::socket_t& socket = state_->socket;
  try {
    zmq::message_t frame = FrameOf(std::move(attachment));
    if (!BeginMessage(socket, peer)) return Unavailable("the peer's queue is full");
    socket.send(zmq::buffer(payload), kMoreAtOnce);
    socket.send(frame, zmq::send_flags::dontwait);
    return {};
  } catch (const zmq::error_t& error) {
    return SocketFailure("send on", state_->endpoint, error);
  }
}

ServerRefusals ServerChannel::refusals() const {
  ServerRefusals refusals{.messages_removed_key = state_->removed_key, .messages_frames = state_->wrong_frames};
  if (const HandshakeMonitor* handshakes = state_->handshakes.get()) {
    refusals.handshakes_wrong_key = handshakes->wrong_key();
    refusals.handshakes_malformed = handshakes->malformed();
    refusals.handshakes_unfinished = handshakes->unfinished();
  }
  return refusals;
}

void* ServerChannel::native_socket() const { return state_->socket.handle(); }

}  // namespace depthfarm
