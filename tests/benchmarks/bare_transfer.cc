#include "tests/benchmarks/bare_transfer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <string_view>
#include <zmq.hpp>

namespace depthfarm::benchmarks {
namespace {

constexpr std::size_t kCredit = 4;

// A request is the index of a message.
std::size_t IndexOf(const zmq::message_t& request) {
  std::size_t index = 0;
  std::memcpy(&index, request.data(), std::min(request.size(), sizeof(index)));
  return index;
}

void AnswerBare(zmq::socket_t& socket, std::string_view bytes) {
  zmq::message_t peer;
  zmq::message_t request;
  while (socket.recv(peer, zmq::recv_flags::dontwait)) {
    (void)socket.recv(request);
    const std::string_view message = bytes.substr(IndexOf(request) * kBareMessageBytes, kBareMessageBytes);
    socket.send(peer, zmq::send_flags::sndmore);
    socket.send(zmq::buffer(message), zmq::send_flags::none);
  }
}

}  // namespace

ServerProcess::Served ServeBare(const std::string& bytes, const CurveKeys& keys) {
  const auto context = std::make_shared<zmq::context_t>(1);
  const auto socket = std::make_shared<zmq::socket_t>(*context, zmq::socket_type::router);
  socket->set(zmq::sockopt::linger, 0);
  if (!keys.public_key.empty()) {
    socket->set(zmq::sockopt::curve_server, 1);
    socket->set(zmq::sockopt::curve_secretkey, keys.secret_key);
  }
  socket->bind("tcp://127.0.0.1:*");
  return {
      socket->get(zmq::sockopt::last_endpoint), [context, socket, &bytes](int stop) {
        while (true) {
          std::array<zmq::pollitem_t, 2> items{{{socket->handle(), 0, ZMQ_POLLIN, 0}, {nullptr, stop, ZMQ_POLLIN, 0}}};
          zmq::poll(items, std::chrono::milliseconds(-1));
          if (items[1].revents != 0) return;
          AnswerBare(*socket, bytes);
        }
      }};
}

struct BareReceiver::State {
  zmq::context_t context{1};
  zmq::socket_t socket{context, zmq::socket_type::dealer};
};

BareReceiver::BareReceiver(const std::string& endpoint, const CurveKeys& keys) : state_(std::make_unique<State>()) {
  zmq::socket_t& socket = state_->socket;
  socket.set(zmq::sockopt::linger, 0);
  if (!keys.public_key.empty()) {
    socket.set(zmq::sockopt::curve_serverkey, keys.public_key);
    socket.set(zmq::sockopt::curve_publickey, keys.public_key);
    socket.set(zmq::sockopt::curve_secretkey, keys.secret_key);
  }
  socket.connect(endpoint);
}

BareReceiver::~BareReceiver() = default;

bool BareReceiver::Receive(std::size_t total_bytes) {
  const std::size_t messages = (total_bytes + kBareMessageBytes - 1) / kBareMessageBytes;
  std::size_t asked = 0;
  std::size_t received_bytes = 0;
  for (std::size_t received = 0; received < messages; ++received) {
    for (; asked < std::min(messages, received + kCredit); ++asked) {
      state_->socket.send(zmq::buffer(&asked, sizeof(asked)), zmq::send_flags::none);
    }
    zmq::message_t message;
    if (!state_->socket.recv(message)) return false;
    received_bytes += message.size();
  }
  return received_bytes == total_bytes;
}

}  // namespace depthfarm::benchmarks
